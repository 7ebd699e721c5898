"""Every notebook is run from its first cell to its last by nbmake, on a copy, and compared.

The copy writes its figures beside itself, as INETLIB_FIGURES says.  Stored text, pictures and
figures must be what the rerun shows, within the tolerances of `inetlib.drawings.same`; what may
differ more says so by a tag (see tools/outputs.py).  Pictures of another matplotlib than the
pinned one need only look alike."""

import base64
import html
import io
import re
import shutil
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import outputs  # tools/outputs.py
import pytest
from nbconvert import HTMLExporter

from inetlib import publish
from inetlib.drawings import same
from inetlib.explorer.notebook import Live

ROOT = Path(__file__).resolve().parent.parent
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
MANIFEST = publish.read_manifest(ROOT / "figures")
NOT_PRIVATE = "_replace", "_asdict", "_fields", "_make"  # of a named tuple


def all_cells(path):
    import nbformat  # a second and a half, for those who need it

    return nbformat.read(path, as_version=4).cells


def cells_of(path, kind="code"):
    return [c for c in all_cells(path) if c.cell_type == kind]


@pytest.fixture(scope="module", params=NOTEBOOKS, ids=lambda path: path.stem)
def rerun(request, tmp_path_factory):
    """The stored notebook, its rerun copy, and the folder of the figures that the rerun drew."""
    folder = tmp_path_factory.mktemp("rerun")
    copy = folder / "notebooks" / request.param.name
    copy.parent.mkdir()
    shutil.copy(request.param, copy)
    command = [sys.executable, "-m", "pytest", "--nbmake", "--overwrite", "--nbmake-timeout=300"]
    command += ["-q", "-p", "no:cacheprovider", "--rootdir", str(folder), str(copy)]
    environment = outputs.environment(tmp_path_factory.mktemp("settings"))
    environment |= {"PYTEST_ADDOPTS": "", "PYDEVD_DISABLE_FILE_VALIDATION": "1"}
    environment |= {publish.FOLDER: str(folder / "figures")}
    text = {"capture_output": True, "text": True, "errors": "replace"}
    done = subprocess.run(command, cwd=folder, env=environment, **text)
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    return request.param, copy, folder / "figures"


@pytest.mark.notebook
def test_a_rerun_prints_and_draws_what_is_stored(rerun):
    stored, fresh = (cells_of(path) for path in rerun[:2])
    assert len(stored) == len(fresh) > 0
    for old, new in zip(stored, fresh, strict=True):
        looks = {} if outputs.PINNED else {"looks": outputs.ALIKE}
        assert outputs.kept(old, new, **looks), (old.source, outputs.shown(new))


@pytest.mark.notebook
def test_a_rerun_draws_the_stored_figures(rerun):
    stored, _, figures = rerun
    tags = {t for cell in cells_of(stored) for t in outputs.tags(cell)}
    tagged = {t for t in tags if t.startswith(("fig", "beyond"))}
    drawn = publish.read_manifest(figures)
    assert set(drawn) == tagged
    for name in drawn:
        found = publish.differences(name, figures, ROOT / "figures")
        assert outputs.PINNED or set(found) <= {"svg", "png"}, found
        assert not outputs.PINNED or found == [], (name, found)
    for table in figures.glob("table*"):
        both = (folder.read_text() for folder in (table, ROOT / "figures" / table.name))
        assert same.text(*both)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_no_notebook_writes_into_the_folder_of_figures(path):
    source = "\n".join(cell.source for cell in cells_of(path))
    assert "figures/" not in source and '"../figures' not in source
    assert "publish.save" not in source and "table1.save" not in source
    figures = [c for c in cells_of(path) if any(t in MANIFEST for t in outputs.tags(c))]
    assert all("publish.show(" in cell.source for cell in figures)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_stored_notebooks_have_a_guide_exercises_outputs_and_pictures(path):
    cells = cells_of(path)
    shown = [o for c in cells for o in c.outputs]
    assert [c.execution_count for c in cells] == list(range(1, len(cells) + 1))
    assert not any(o.output_type == "error" or o.get("name") == "stderr" for o in shown)
    assert path.stat().st_size < 1_200_000
    texts = [c.source for c in cells_of(path, "markdown")]
    assert texts[0].startswith("# ") and "What you will see" in texts[0] and "ection" in texts[0]
    assert re.findall(r"^## (.+)", "\n".join(texts), re.MULTILINE)[-1] == "Try it"
    files = [o.data["image/png"] for o in shown if "image/png" in o.get("data", {})]
    pictures = [matplotlib.image.imread(io.BytesIO(base64.b64decode(png))) for png in files]
    assert pictures
    for picture in pictures:  # shows something
        assert min(picture.shape[:2]) > 100 and picture[..., :3].std() > 0.02


def headings_of(path):
    """What stands behind # in a link to a heading: its words with a dash for each space."""
    lines = [x for c in cells_of(path, "markdown") for x in c.source.splitlines()]
    heads = [re.sub(r"^#+ ", "", x).replace("`", "") for x in lines if re.match("#+ ", x)]
    return {head.replace(" ", "-") for head in heads}


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_link_leads_to_a_file_and_a_heading(path):
    text = "\n".join(c.source for c in cells_of(path, "markdown"))
    for target in re.findall(r"\]\(((?:[^()\s]|\([^()\s]*\))+)\)", text):
        name, _, heading = target.partition("#")
        if "://" not in name:
            there = path.parent / name if name else path
            assert there.is_file(), target
            assert not heading or heading in headings_of(there), target


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_lesson_begins_with_links_to_its_neighbours(path):
    links = re.findall(r"\]\((.*?)\)", cells_of(path, "markdown")[0].source.split("\n\n")[1])
    here = NOTEBOOKS.index(path)
    around = [p.name for p in NOTEBOOKS[max(here - 1, 0) : here + 2] if p != path]
    assert links == [*around, "../PAPER.md", "../ERRATA.md"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_picture_has_a_caption_and_a_folded_cell_says_what_it_proves(path):
    cells, section = all_cells(path), ""
    for cell, after in zip(cells, [*cells[1:], None], strict=True):
        if cell.cell_type == "markdown":
            section = cell.source if re.search("^#", cell.source, re.MULTILINE) else section
            before = cell.source
            continue
        for output in cell.outputs:
            if "image/png" in output.get("data", {}):
                said = output.metadata["image/png"]["alt"]
                assert len(said) >= 20 and "<" not in said and "$" not in said, cell.source
                assert output.data["text/plain"] == said
                assert len(outputs.caption(after.source)) >= 20, cell.source
        folded = "hide-input" in outputs.tags(cell)
        assert folded == cell.metadata.get("jupyter", {}).get("source_hidden", False)
        if folded:
            heading = re.findall("^#+ (.*)", section, re.MULTILINE)[-1]
            assert "proof" in heading.lower() or "> **Erratum" in before, cell.source
            assert before, cell.source
            before = ""  # a sentence for each


def test_a_picture_without_words_gets_those_of_its_caption():
    import nbformat

    picture = nbformat.v4.new_output("display_data", {"image/png": "", "text/plain": "<Figure>"})
    cell = nbformat.v4.new_code_cell(outputs=[picture])
    outputs.describe(
        cell, "*A net under $z^2$, $\\theta = 60\\degree$, of [3.3](3_3.ipynb).*\n\nMore."
    )
    assert picture.metadata["image/png"]["alt"] == "A net under z^2, theta = 60 degrees, of 3.3."
    assert picture.data["text/plain"] == picture.metadata["image/png"]["alt"]
    picture.metadata["image/png"]["alt"] = "Its own words."
    outputs.describe(cell, "*A caption.*")
    assert picture.data["text/plain"] == "Its own words."
    assert outputs.caption("No caption, *but this.*") == outputs.caption("") == ""


def test_a_page_made_of_a_notebook_reads_out_the_words_of_its_pictures():
    path = ROOT / "notebooks" / "4_isogonal_nets.ipynb"
    page, _ = HTMLExporter(template_name="classic").from_filename(path)
    pictures = [o for c in cells_of(path) for o in c.outputs if "image/png" in o.get("data", {})]
    read = [html.unescape(x) for x in re.findall(r'<img alt="([^"]*)"', page)]
    assert read == [o.metadata["image/png"]["alt"] for o in pictures] != []


def test_the_picture_of_a_live_view_stays_where_a_page_is_made_of_a_notebook():
    import nbformat

    png = b"\x89PNG of a net"
    data = Live("http://127.0.0.1:9/index.html", png, 400)._repr_mimebundle_()
    output = nbformat.v4.new_output("display_data", data)
    cell = nbformat.v4.new_code_cell("explorer.show()", outputs=[output])
    page, _ = HTMLExporter().from_notebook_node(nbformat.v4.new_notebook(cells=[cell]))
    assert f"data:image/png;base64,{base64.b64encode(png).decode()}" in page


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_cells_of_code_are_short_and_the_first_one_most(path):
    lines = [len(cell.source.splitlines()) for cell in cells_of(path)]
    assert lines[0] <= 12 and max(lines) <= 18


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_lessons_use_public_names_and_put_errata_into_boxes(path):
    code = "\n".join(cell.source for cell in cells_of(path))
    assert set(re.findall(r"(?:\.|import )(_[a-z]\w*)", code)) <= set(NOT_PRIVATE)
    known = re.findall(r"^## (E\d+) ", (ROOT / "ERRATA.md").read_text("utf-8"), re.MULTILINE)
    for cell in cells_of(path, "markdown"):
        for paragraph in re.split(r"\n>?\n", cell.source):
            for number in re.findall(r"\bE\d+\b", paragraph):
                assert number in known and paragraph.startswith(f"> **Erratum {number}.** ")
                assert "See [ERRATA](../ERRATA.md)" in paragraph and "\n" not in paragraph


def test_the_folder_of_figures_holds_what_the_manifest_names():
    assert len(MANIFEST) >= 6
    for kind in ("svg", "png"):
        assert {p.stem for p in (ROOT / "figures").glob(f"*.{kind}")} == set(MANIFEST)
    assert {p.stem for p in (ROOT / "figures" / "data").iterdir()} == set(MANIFEST)
    for name, entry in MANIFEST.items():
        assert entry["function"] == f"inetlib.drawings.{name}.draw"
        assert publish.differences(name, ROOT / "figures", ROOT / "figures") == []
        for key in ("max_deviation_theta_deg", "max_deviation_theta0_deg"):
            assert entry[key] is None or entry[key] < 1e-9
