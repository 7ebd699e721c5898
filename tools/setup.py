"""Make .venv beside this folder and install the project with its tests, at pinned versions.

    python tools/setup.py                    make or update .venv
    python tools/setup.py --versions oldest  make .venv-oldest, all declared lowest versions
    python tools/setup.py --versions newest  make .venv-newest, whatever is newest today
    python tools/setup.py --remove           remove all of them

Needs Python >= 3.11 and the network; nothing outside these folders changes."""

import argparse
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = {"pinned": ".venv", "oldest": ".venv-oldest", "newest": ".venv-newest"}


def oldest():
    """Every declared package at its lower bound, for pip: `name==bound`."""
    import tomllib  # only here: main has a sentence for a Python that is too old to have it

    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"].values()
    declared = [*project["dependencies"], *(package for extra in extras for package in extra)]
    return [package.replace(">=", "==") for package in declared]


def run(command):
    """Run a command in the project's folder: its exit code.  Ctrl-C ends it with all it began."""
    process = subprocess.Popen(command, cwd=ROOT, start_new_session=True)  # hears no Ctrl-C
    try:
        return process.wait()
    except KeyboardInterrupt:
        if os.name == "nt":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        raise


def main():
    """Exit code 0 when the environment is ready; a sentence and 1 when not."""
    if sys.version_info < (3, 11):
        return f"Python {sys.version.split()[0]} is too old: 3.11 or newer is needed (PYTHON=...)"
    parser = argparse.ArgumentParser(description="Make .venv and install the project into it.")
    parser.add_argument("--versions", choices=FOLDERS, default="pinned", help="which packages")
    parser.add_argument("--remove", action="store_true", help="remove the environments instead")
    arguments = parser.parse_args()
    if arguments.remove:
        for folder in FOLDERS.values():
            shutil.rmtree(ROOT / folder, ignore_errors=True)
        return 0
    versions = arguments.versions
    venv = ROOT / FOLDERS[versions]
    python = venv / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    if versions != "pinned":  # from nothing: what another day or another Python left is no test
        shutil.rmtree(venv, ignore_errors=True)
    whole = list(venv.glob("*/pip*"))  # pip comes last
    if not whole and run([sys.executable, "-m", "venv", venv]):
        shutil.rmtree(venv, ignore_errors=True)
        return (
            "no virtual environment could be made (on Debian and Ubuntu: apt install python3-venv)"
        )
    print(f"installing the {versions} packages into {venv.name} ...", flush=True)
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    chosen = {"pinned": ["-c", "constraints.txt"], "oldest": oldest(), "newest": []}[versions]
    if run([*pip, *chosen, "-e", ".[view,cad,book,test]"]):
        return "the packages could not be installed: see pip's message above"
    # pip leaves our own modules out, and all where PIP_NO_COMPILE is set; Python does not make up
    # for it where PYTHONDONTWRITEBYTECODE is set, and compiles them at every start instead
    run([python, "-m", "compileall", "-qq", "-j", "0", venv, "inetlib"])
    (venv / "ready").touch()
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        print("\nsetup: stopped, run it again to go on", file=sys.stderr)
        sys.exit(130)
