"""Files that appear whole or not at all: written beside their place as `.new-PID-...`, renamed.

What a killed process has left is removed by the next that writes into the folder."""

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

LIVE = set()  # the temporary files and folders of this process
WRITTEN = []  # the files that this process has put in their places


def check_place(path: Path, force: bool = False) -> None:
    """Raise ValueError or OSError if no file can be written there, or one may not be replaced."""
    if path.is_dir():
        raise ValueError(f"{path} is a directory: the name of a file is wanted")
    if not path.parent.is_dir():
        raise ValueError(f"{path}: there is no folder {path.parent}: make it first")
    if path.exists() and not force:
        raise FileExistsError(f"{path} exists already: --force (force=True) replaces it")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise PermissionError(f"{path}: no permission to write there")


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A name like `path` to write to, renamed onto it when the block ends well, else removed."""
    path = Path(path)
    with _temporary(path.parent, path.suffix.lower()) as new:
        yield new
        WRITTEN.append(path)  # before it is true: who is stopped between must not deny it
        os.replace(new, path)


@contextmanager
def scratch(folder: str | Path) -> Iterator[Path]:
    """A new, empty folder in `folder`, removed at the end of the block."""
    with _temporary(Path(folder)) as new:
        new.mkdir()
        yield new


@contextmanager
def _temporary(folder, suffix=""):
    sweep(folder)
    new = folder / f".new-{os.getpid()}-{os.urandom(4).hex()}{suffix}"
    LIVE.add(new)
    try:
        yield new
    finally:
        _remove(new)
        LIVE.discard(new)


def clear() -> None:
    """Remove the temporary files and folders of this process: it is about to end."""
    for path in list(LIVE):
        _remove(path)


def sweep(folder: str | Path) -> None:
    """Remove what processes that are gone have left in a folder, which need not be there."""
    live = {path.name for path in LIVE}
    with suppress(OSError):
        for name in os.listdir(folder):
            found = re.match(r"\.new-(\d{1,9})-", name)
            if found and name not in live and _gone(int(found[1])):
                _remove(Path(folder) / name)


def _remove(path):
    with suppress(OSError):  # on Windows a file that is open stays, for the next sweep
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        path.unlink(missing_ok=True)


def _gone(pid):
    """Whether no other process has this number."""
    if pid == os.getpid():  # what carries it was left by another: it is not in LIVE
        return True
    if os.name == "nt":  # there os.kill would end the process
        import ctypes

        handle = ctypes.windll.kernel32.OpenProcess(0x1000, False, pid)  # to ask, nothing else
        return not (handle and ctypes.windll.kernel32.CloseHandle(handle))
    try:
        os.kill(pid, 0)
    except OSError as error:
        return isinstance(error, ProcessLookupError)  # others: the process is somebody else's
    return False
