"""Every notebook is run from its first cell to its last by nbmake, on a copy, and compared.

The copy writes its figures beside itself.  Stored text must match exactly, stored pictures
must exist and look the same, the figures' data must have the hashes of figures/manifest.json.
Cells tagged `timing` (seconds) and `view` (OpenGL) run too, but what they show is not compared.
"""

import base64
import io
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import nbformat
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parent.parent
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
MANIFEST = json.loads((ROOT / "figures" / "manifest.json").read_text(encoding="utf-8"))


def code_cells(path):
    return [c for c in nbformat.read(path, as_version=4).cells if c.cell_type == "code"]


def text_of(cell):
    """What a reader sees as text below the cell."""
    parts = []
    for output in cell.outputs:
        if output.output_type == "stream":
            parts.append(output.text)
        elif "image/png" not in output.data:
            kinds = ("text/markdown", "text/latex", "text/plain")
            parts.append(next((output.data[kind] for kind in kinds if kind in output.data), ""))
    return "".join(parts)  # one print may be stored in several pieces


def pictures_of(cell):
    """The pictures below the cell as arrays of grey or RGBA values in [0, 1]."""
    found = [o.data["image/png"] for o in cell.outputs if "image/png" in o.get("data", {})]
    return [matplotlib.image.imread(io.BytesIO(base64.b64decode(png))) for png in found]


@pytest.fixture(scope="module", params=NOTEBOOKS, ids=lambda path: path.stem)
def rerun(request, tmp_path_factory):
    """The stored notebook, its rerun copy, and the folder of the figures that the rerun drew."""
    folder = tmp_path_factory.mktemp("rerun")
    copy = folder / "notebooks" / request.param.name
    copy.parent.mkdir()
    shutil.copy(request.param, copy)
    command = [sys.executable, "-m", "pytest", "--nbmake", "--overwrite", "--nbmake-timeout=300"]
    command += ["-q", "-p", "no:cacheprovider", "--rootdir", str(folder), str(copy)]
    environment = os.environ | {"PYTEST_ADDOPTS": "", "PYDEVD_DISABLE_FILE_VALIDATION": "1"}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, errors="replace"
    )
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    return request.param, copy, folder / "figures"


@pytest.mark.notebook
def test_a_rerun_prints_and_draws_what_is_stored(rerun):
    stored, fresh = (code_cells(path) for path in rerun[:2])
    assert len(stored) == len(fresh) > 0
    for old, new in zip(stored, fresh, strict=True):
        if {"timing", "view"} & set(old.metadata.get("tags", [])):
            continue
        assert text_of(new) == text_of(old), old.source
        assert len(pictures_of(new)) == len(pictures_of(old)), old.source
        for a, b in zip(pictures_of(old), pictures_of(new), strict=True):
            assert a.shape == b.shape and np.abs(a - b).mean() < 0.005, old.source


@pytest.mark.notebook
def test_a_rerun_draws_figures_of_the_recorded_data(rerun):
    stored, _, figures = rerun
    tags = {t for cell in code_cells(stored) for t in cell.metadata.get("tags", [])}
    tagged = {t for t in tags if t.startswith(("fig", "beyond"))}
    drawn = json.loads((figures / "manifest.json").read_text()) if figures.exists() else {}
    assert set(drawn) == tagged
    for name, entry in drawn.items():
        assert entry == MANIFEST[name]
        assert (figures / f"{name}.svg").stat().st_size > 5000
        fresh, old = (
            matplotlib.image.imread(f / f"{name}.png") for f in (figures, ROOT / "figures")
        )
        assert fresh.shape == old.shape and np.abs(fresh - old).mean() < 0.005
    for table in figures.glob("table*"):
        assert table.read_bytes() == (ROOT / "figures" / table.name).read_bytes()


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_stored_notebooks_hold_their_outputs_and_no_errors(path):
    cells = code_cells(path)
    assert [c.execution_count for c in cells] == list(range(1, len(cells) + 1))
    assert all(o.output_type != "error" for c in cells for o in c.outputs)
    assert not any(o.get("name") == "stderr" for c in cells for o in c.outputs)
    assert path.stat().st_size < 1_200_000


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_stored_picture_shows_something(path):
    pictures = [picture for cell in code_cells(path) for picture in pictures_of(cell)]
    assert pictures
    for picture in pictures:
        assert min(picture.shape[:2]) > 100 and picture[..., :3].std() > 0.02


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_open_with_a_guide_and_end_with_exercises(path):
    cells = nbformat.read(path, as_version=4).cells
    texts = [c.source for c in cells if c.cell_type == "markdown"]
    assert texts[0].startswith("# ") and "What you will see" in texts[0] and "ection" in texts[0]
    assert "## Try it" in texts[-1]


def test_the_folder_of_figures_holds_what_the_manifest_names():
    assert len(MANIFEST) >= 6
    for kind in ("svg", "png"):
        assert {p.stem for p in (ROOT / "figures").glob(f"*.{kind}")} == set(MANIFEST)
    for name, entry in MANIFEST.items():
        assert entry["function"] == f"inetlib.drawings.{name}.draw"
        for key in ("max_deviation_theta_deg", "max_deviation_theta0_deg"):
            assert entry[key] is None or entry[key] < 1e-9
