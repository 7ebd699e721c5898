"""What stands for another machine: other kernels of this processor, and drawn numbers a bit off.

Each setting switches something of the processor off, in fresh processes (see elsewhere.py):
results that hang on ties, Table 1 and all figures must be as they are here and as stored.  The
short form has one run, all switched off and noise in the drawn numbers; `make test-long` has
each alone, and all notebooks, twice."""

import json
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import elsewhere
import numpy as np
import outputs  # tools/outputs.py
import pytest

from inetlib import publish

ROOT = Path(__file__).resolve().parent.parent
HERE = Path(__file__).resolve().parent
FAST = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
PRESCOTT = {"OPENBLAS_CORETYPE": "Prescott"}
SETTINGS = {
    "default": {},
    "BLAS of Prescott": PRESCOTT,
    "BLAS of Nehalem": {"OPENBLAS_CORETYPE": "Nehalem"},
    "BLAS of Sandybridge": {"OPENBLAS_CORETYPE": "Sandybridge"},
    "numpy without " + " ".join(FAST): {"NPY_DISABLE_CPU_FEATURES": " ".join(FAST)},
    "C library without FMA and AVX2": {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-AVX2,-FMA4"},
}
ALL = {k: x for setting in SETTINGS.values() for k, x in setting.items()} | PRESCOTT
SETTINGS["all of them"] = ALL
ALSO = {"Prescott": "Katmai"}  # OpenBLAS's other name for it
SHORT = ["all of them"]
ROUNDING = 1e-13


def lacking(name):
    """Why a setting says nothing here, or ""."""
    wanted, machine, libc = SETTINGS[name], platform.machine(), platform.libc_ver()[0]
    reasons = {
        "": machine not in ("x86_64", "AMD64") and f"only x86 has these switches, not {machine}",
        "NPY_DISABLE_CPU_FEATURES": not FAST and "numpy found no extension to switch off",
        "OPENBLAS_CORETYPE": not elsewhere.kernels() and "numpy does not use OpenBLAS here",
        "GLIBC_TUNABLES": libc != "glibc" and "the C library here is not glibc",
    }
    return next((reasons[k] for k in ("", *wanted) if wanted and reasons[k]), "")


def in_setting(name, command, folder, more):
    """Run a command of this Python in a setting, and more of an environment."""
    if reason := lacking(name):
        pytest.skip(f"{name}: {reason}")
    env = os.environ | SETTINGS[name] | more | {"PYTHONPATH": str(folder)}
    words = [sys.executable, *map(str, command)]
    done = subprocess.run(words, env=env, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]


def drawn(name, tmp_path, more, *noise):
    """(kernels, figures that were rewritten, {name: array}) of a process in a setting."""
    figures = tmp_path / "figures"
    shutil.copytree(ROOT / "figures", figures)
    in_setting(name, [HERE / "elsewhere.py", figures, *noise], ROOT, more)
    found = publish.read_data(figures / "results.npz")
    return *json.loads((figures / "rewritten.json").read_text()), found


@pytest.fixture(scope="module")
def here():
    return elsewhere.results()


def agree(one, two):
    """Whether all numbers agree to 1e-6 of the size, whole numbers exactly."""
    if one.dtype.kind in "iu":
        return np.array_equal(one, two)
    return one.shape == two.shape and np.abs(one - two).max() <= 1e-6 * np.ptp(one)


def marked(name):
    return pytest.param(name, marks=getattr(pytest.mark, "elsewhere" if name in SHORT else "long"))


@pytest.mark.parametrize("name", [marked(name) for name in SETTINGS])
def test_another_processor_gives_the_same(name, here, tmp_path, somebody):
    short = name in SHORT and outputs.PINNED
    noise = [ROUNDING] if short else []  # another matplotlib than the pinned one draws otherwise
    kernels, rewritten, there = drawn(name, tmp_path, somebody if short else {}, *noise)
    wanted = SETTINGS[name].get("OPENBLAS_CORETYPE")
    assert wanted is None or set(kernels) <= {wanted, ALSO.get(wanted)}
    assert set(there) == set(here)
    assert [key for key in here if not agree(here[key], there[key])] == []
    if not outputs.PINNED:
        rewritten = {k: x for k, x in rewritten.items() if not set(x) <= {"svg", "png"}}
    assert rewritten == {}


@pytest.mark.long
@pytest.mark.skipif(
    not outputs.PINNED, reason="another matplotlib than the pinned one draws otherwise"
)
def test_figures_are_kept_when_all_that_is_drawn_is_off_by_rounding_and_rewritten_for_more(
    tmp_path,
):
    assert drawn("default", tmp_path / "rounding", {}, ROUNDING)[1] == {}
    found = drawn("default", tmp_path / "more", {}, 1e-4)[1]
    assert set(found) == set(publish.read_manifest(ROOT / "figures"))
    assert all({"svg", "png"} <= set(words) for words in found.values())


@pytest.mark.long
@pytest.mark.parametrize("name", ["default", "all of them"])
def test_all_notebooks_twice_in_another_folder_change_no_file(name, tmp_path, somebody):
    folder = tmp_path / "another folder"
    for part in ("notebooks", "figures", "inetlib", "tools"):
        skipped = shutil.ignore_patterns("__pycache__", ".ipynb_checkpoints", ".new-*")
        shutil.copytree(ROOT / part, folder / part, ignore=skipped)
    shutil.copy(ROOT / "constraints.txt", folder)
    kept = [p for part in ("notebooks", "figures") for p in (folder / part).rglob("*")]
    before = {path: path.read_bytes() for path in kept if path.is_file()}
    for _ in range(2):
        in_setting(name, ["tools/redraw.py"], folder, somebody if name == "all of them" else {})
        after = {path: path.read_bytes() for path in before}
        assert [path.name for path in before if before[path] != after[path]] == []
    assert not list(folder.rglob(".new-*"))
