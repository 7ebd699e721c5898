"""Ctrl-C at any moment: one sentence, 130, nothing half written, no process left.

Moments are not waited for but made: the process raises the signal itself, when it loads a
module, opens a file or starts another process (audit events), or in a function put in place."""

import ctypes
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import types
from pathlib import Path

import psutil
import pytest

import inetlib
from inetlib import cli, design, ending, examples, files, io, start
from inetlib.design import report

pytestmark = pytest.mark.program

ROOT = Path(__file__).resolve().parent.parent
ANGLES = "--theta", "60", "--theta0", "60"
COVER = ["cover", "roof", *ANGLES, "--quads", "60", "-o", "net.obj"]
ON = """
import signal, sys
def hook(event, arguments):
    if event == {!r} and {!r} in str(arguments):
        signal.raise_signal(signal.SIGINT)
sys.addaudithook(hook)
"""
PUT = """
import signal, sys
from inetlib import design
from inetlib.cli import nets
{} = lambda *_, **also: signal.raise_signal(signal.SIGINT)
"""
RUN = "from inetlib.start import main; sys.exit(main(sys.argv[1:]))"
REDRAW = "import runpy, sys; sys.path.insert(0, 'tools');"
REDRAW += "sys.modules['rfc3987_syntax'] = None;"  # of jsonschema: a second to load
REDRAW += "runpy.run_path('tools/redraw.py', run_name='__main__')"
posix = pytest.mark.skipif(sys.platform == "win32", reason="Windows sends no SIGINT to a process")


@pytest.fixture(autouse=True)
def heard():
    """Children hear Ctrl-C, also when this process was begun in the background of a script."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def python(folder, code, *words, **environment):
    return subprocess.run(
        [sys.executable, "-c", code, *words],
        cwd=folder,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=120,
    )


def left(folder):
    """The temporary files in a folder and below."""
    return [path for path in Path(folder).rglob("*") if path.name.startswith(".new-")]


def test_modules_are_loaded_when_they_are_used():
    code = "import sys, inetlib, inetlib.start, inetlib.explorer; print(*sys.modules)\n"
    code += "print(inetlib.mesh.grid_quads(1, 1).shape, *sys.modules)\n"
    code += "import inetlib.io; print(inetlib.NotConverged, *sys.modules)\n"
    code += "import inetlib.plot, inetlib.publish, inetlib.view; print(*sys.modules)"
    lines = python(ROOT, code).stdout.splitlines()
    light, numpy, more, pictures = (set(line.split()) for line in lines)
    packages = {"ezdxf", "matplotlib", "pyvista", "rhino3dm", "sympy", "vtkmodules"}
    assert "inetlib" in light and not light & {"numpy", "scipy", "importlib.metadata", *packages}
    assert "(1," in numpy and not numpy & {"igl", "scipy.interpolate", *packages}
    assert "'inetlib.solver.NotConverged'>" in more and not more & packages
    assert not pictures & {"pyvista", "vtk", "vtkmodules"}  # they are drawn without OpenGL
    for name in [*inetlib.__all__, "__version__"]:
        assert name in dir(inetlib) and getattr(inetlib, name) is not None
    with pytest.raises(AttributeError, match="nothing"):
        inetlib.nothing  # noqa: B018


def test_a_file_appears_whole_or_not_at_all(tmp_path):
    path = tmp_path / "a.OBJ"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), files.replacing(path) as new:
        new.write_text("half")
        assert new.suffix == ".obj" and left(tmp_path) == [new]
        raise ZeroDivisionError
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["a.OBJ"]
    with files.replacing(path) as new:
        new.write_text("new")
    assert path.read_text() == "new" and os.listdir(tmp_path) == ["a.OBJ"]


def test_a_folder_for_a_while(tmp_path):
    with files.scratch(tmp_path) as folder, files.scratch(tmp_path) as other:
        (folder / "data").mkdir()
        (folder / "data" / "a").write_text("a")
        assert sorted(left(tmp_path)) == sorted([folder, other])
        files.clear()  # as when the process is stopped
        assert left(tmp_path) == []
    assert not {folder, other} & files.LIVE


@posix
def test_what_a_killed_process_left_is_removed_by_the_next(tmp_path):
    code = "import os, signal; from inetlib import files\n"
    code += "with files.replacing('net.obj') as new, files.scratch('.') as folder:\n"
    code += "    for path in (new, folder / 'a'): path.write_text('half')\n"
    code += "    os.kill(os.getpid(), signal.SIGKILL)"
    assert python(tmp_path, code).returncode == -signal.SIGKILL
    assert len(left(tmp_path)) == 2 and len(os.listdir(tmp_path)) == 2
    alive, other = tmp_path / f".new-{os.getppid()}-0a.obj", tmp_path / ".new-year"
    ours = tmp_path / f".new-{os.getpid()}-0a.obj"  # of a process that had our number
    for path in (alive, other, ours):
        path.touch()
    io.write(tmp_path / "net.obj", *examples.wavy_roof(2))
    assert sorted(os.listdir(tmp_path)) == sorted([alive.name, other.name, "net.obj"])


def test_on_windows_processes_are_asked_for_and_not_ended(tmp_path, monkeypatch):
    closed = []
    kernel = types.SimpleNamespace(
        OpenProcess=lambda right, inherit, pid: 1000 + pid if pid == 12 else 0,
        CloseHandle=lambda handle: closed.append(handle) or 1,
    )
    windll = types.SimpleNamespace(kernel32=kernel)
    monkeypatch.setattr(ctypes, "windll", windll, raising=False)
    windows = vars(os) | {"name": "nt", "kill": lambda *_: pytest.fail("os.kill ends processes")}
    monkeypatch.setattr(files, "os", types.SimpleNamespace(**windows))
    for name in (".new-12-0a.obj", ".new-13-0a.obj"):
        (tmp_path / name).touch()
    files.sweep(tmp_path)
    assert os.listdir(tmp_path) == [".new-12-0a.obj"] and closed == [1012]


MOMENTS = {
    "while packages are loaded": ON.format("import", "scipy.sparse"),
    "in the search": PUT.format("design.cover"),
    "while the file is written": ON.format("open", ".new-"),
    "when it is written": PUT.format("nets._say"),
}


@posix
@pytest.mark.parametrize("moment", MOMENTS)
def test_inet_is_stopped_with_one_sentence(tmp_path, moment):
    (tmp_path / "net.obj").write_text("old")
    done = python(tmp_path, MOMENTS[moment] + RUN, *COVER, "--force")
    late = moment == "when it is written"
    claim = "" if late else ", nothing was written"
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == f"inet: stopped{claim}\n"
    assert os.listdir(tmp_path) == ["net.obj"]
    if late:
        assert len(io.net(tmp_path / "net.obj").Q) > 30
    else:
        assert (tmp_path / "net.obj").read_text() == "old"


@posix
def test_a_signal_that_is_ignored_stays_so_and_sigterm_ends_like_ctrl_c(tmp_path):
    code = "import signal, sys; from inetlib import start\n"
    code += "signal.signal(signal.SIGINT, signal.SIG_IGN); start.listen(lambda: 'stopped')\n"
    code += "for number in (signal.SIGINT, signal.SIGTERM): signal.raise_signal(number)"
    done = python(tmp_path, code)
    assert (done.returncode, done.stderr) == (143, "stopped\n")


def test_called_from_a_program_inet_leaves_its_signals_alone(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    before = [signal.getsignal(number) for number in start.SIGNALS]

    def stop(*_):
        assert before == [signal.getsignal(number) for number in start.SIGNALS]
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(report, "survey", stop)  # before the file
        patch.setattr(design, "survey", stop)
        assert cli.main(COVER) == 130
    assert capsys.readouterr() == ("", "inet: stopped, nothing was written\n")
    assert os.listdir(tmp_path) == []
    monkeypatch.setattr(report, "numbers", stop)  # after the file
    assert cli.main(COVER) == 130
    assert capsys.readouterr() == ("", "inet: stopped\n")
    assert os.listdir(tmp_path) == ["net.obj"]


def test_signals_wait_for_what_must_not_be_cut():
    seen = []
    before = [signal.signal(n, lambda number, frame: seen.append(number)) for n in start.SIGNALS]
    try:
        with ending.held():
            signal.raise_signal(signal.SIGINT)
            assert seen == []
        assert seen == [signal.SIGINT]
    finally:
        for number, handler in zip(start.SIGNALS, before, strict=True):
            signal.signal(number, handler)


BUSY = """\
import os, subprocess, sys, time
from pathlib import Path
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(99)"])
Path(f"../figures/.new-{os.getpid()}-0a.svg").write_text("half")
Path("../figures/busy").write_text(f"{os.getpid()} {child.pid}")
time.sleep(99)"""
SETTINGS = """\
import matplotlib
print(matplotlib.rcParams["font.size"])"""


@pytest.fixture
def clone(tmp_path):
    """clone(cell): a folder with redraw.py and one notebook of one cell."""

    def make(cell):
        v4 = {"nbformat": 4, "nbformat_minor": 5, "metadata": {}}
        code = {"cell_type": "code", "id": "a", "metadata": {}, "outputs": []}
        code |= {"execution_count": None, "source": cell}
        for name in ("tools", "notebooks", "figures", "temporary"):
            (tmp_path / name).mkdir()
        for name in ("tools/redraw.py", "tools/outputs.py", "constraints.txt"):
            shutil.copy(ROOT / name, tmp_path / name)
        (tmp_path / "notebooks" / "a.ipynb").write_text(json.dumps(v4 | {"cells": [code]}))
        return tmp_path

    return make


def kernels(folder):
    """The kernels that were begun for this folder: their command lines name it."""
    found = [p.info["cmdline"] or [] for p in psutil.process_iter(["cmdline"])]
    return [line for line in found if any(str(folder / "temporary") in word for word in line)]


def stopped(folder, before, code, errors):
    """Whether redraw has ended as it must."""
    assert code == 130, errors
    lines = [line for line in re.split(r"[\r\n]+", errors) if line and "cell" not in line]
    assert lines == ["redraw: stopped, notebooks that were not finished are as they were"]
    assert (folder / "notebooks" / "a.ipynb").read_bytes() == before
    assert kernels(folder) == [] and left(folder) == []
    return True


@posix
@pytest.mark.notebook
def test_redraw_is_stopped_with_its_kernel_and_what_that_has_begun(clone):
    folder = clone(BUSY)
    before = (folder / "notebooks" / "a.ipynb").read_bytes()
    options = {"env": os.environ | {"TMPDIR": str(folder / "temporary")}, "cwd": folder}
    command = [sys.executable, "tools/redraw.py"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, **options)
    busy = folder / "figures" / "busy"
    while not (busy.exists() and busy.read_text()) and process.poll() is None:
        time.sleep(0.05)
    assert kernels(folder)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    errors = process.communicate(timeout=20)[1]
    assert time.monotonic() - began < 5
    assert stopped(folder, before, process.returncode, errors)
    for pid in map(int, busy.read_text().split()):
        assert not psutil.pid_exists(pid) or psutil.Process(pid).status() == "zombie"


LAUNCHED = """
import os, signal
found = os.getpgid
os.getpgid = lambda pid: (signal.raise_signal(signal.SIGINT), found(pid))[1]  # after the start
"""
CLOSING = """\
import atexit, os, signal, time
atexit.register(lambda: (os.kill(os.getppid(), signal.SIGINT), time.sleep(99)))"""


@posix
@pytest.mark.notebook
@pytest.mark.parametrize(
    ("code", "cell"),
    [(ON.format("import", "nbclient.client"), "1 + 1"), (LAUNCHED, "1 + 1"), ("", CLOSING)],
    ids=["loading", "a kernel comes", "a kernel goes"],
)
def test_redraw_is_stopped_at_other_moments(clone, code, cell):
    folder = clone(cell)
    before = (folder / "notebooks" / "a.ipynb").read_bytes()
    done = python(folder, code + REDRAW, TMPDIR=str(folder / "temporary"))
    assert stopped(folder, before, done.returncode, done.stderr)


@pytest.mark.notebook
def test_redraw_draws_alike_whatever_its_user_has_set(clone, somebody):
    folder = clone(SETTINGS)
    for name in ("notebooks", "figures"):
        (folder / name / ".new-999999999-0a").write_text("left by a killed run")
    done = python(folder, REDRAW, **somebody, TMPDIR=str(folder / "temporary"))
    assert done.returncode == 0, done.stderr
    (cell,) = json.loads((folder / "notebooks" / "a.ipynb").read_text())["cells"]
    assert ["".join(output["text"]) for output in cell["outputs"]] == ["10.0\n"]
    assert cell["execution_count"] == 1
    assert kernels(folder) == [] and left(folder) == []
