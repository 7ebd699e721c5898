"""Make .venv beside this folder and install the project with its tests, at pinned versions.

    python tools/setup.py             make or update .venv
    python tools/setup.py --remove    remove it

Needs Python >= 3.11 and the network; nothing outside .venv changes.
"""

import argparse
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / ".venv"


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
    """Exit code 0 when .venv is ready; a sentence and 1 when not."""
    if sys.version_info < (3, 11):
        return f"Python {sys.version.split()[0]} is too old: 3.11 or newer is needed (PYTHON=...)"
    parser = argparse.ArgumentParser(description="Make .venv and install the project into it.")
    parser.add_argument("--remove", action="store_true", help="remove .venv instead")
    if parser.parse_args().remove:
        shutil.rmtree(VENV, ignore_errors=True)
        return 0
    python = VENV / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    whole = list(VENV.glob("*/pip*"))  # pip comes last
    if not whole and run([sys.executable, "-m", "venv", VENV]):
        shutil.rmtree(VENV, ignore_errors=True)
        return (
            "no virtual environment could be made (on Debian and Ubuntu: apt install python3-venv)"
        )
    print("installing the packages of constraints.txt into .venv ...", flush=True)
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    project = ["-c", "constraints.txt", "-e", ".[view,cad,test]"]
    if run([*pip, *project]):
        return "the packages could not be installed: see pip's message above"
    (VENV / "ready").touch()
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        print("\nsetup: stopped, run it again to go on", file=sys.stderr)
        sys.exit(130)
