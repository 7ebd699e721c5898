"""Files that are never half written: made under a temporary name beside their place, then renamed.

A process that is killed leaves its temporary names; the next one that writes into the same
folder removes them.

Paper: Sec. 6 (files; beyond the paper).
"""

import contextlib
import os
import re
import secrets
import shutil
import sys
import time
from pathlib import Path

PREFIX = ".new-"
TEMPORARY = re.compile(re.escape(PREFIX) + r"(\d+)-")
MINUTE = 60  # seconds
_ours = {}  # {temporary name: the place it is renamed to, or None} of this process
_written = []  # places that were renamed to, the last one perhaps not yet


@contextlib.contextmanager
def replacing(path):
    """A temporary name beside `path`, with its suffix; renamed onto it if the block ends well.

    Whoever uses it writes the file; what is at `path` stays until then.

    Paper: Sec. 6 (files; beyond the paper).
    """
    path = Path(path)
    with _temporary(path.parent, path.suffix.lower(), path) as name:
        yield name
        _written.append(path)
        os.replace(name, path)


@contextlib.contextmanager
def scratch(folder):
    """A temporary folder in `folder`, removed at the end.

    Paper: Sec. 6 (files; beyond the paper).
    """
    with _temporary(Path(folder), "", None) as name:
        name.mkdir()
        yield name


@contextlib.contextmanager
def _temporary(folder, suffix, place):
    sweep(folder)
    name = folder / f"{PREFIX}{os.getpid()}-{secrets.token_hex(4)}{suffix}"
    _ours[name] = place
    try:
        yield name
    finally:
        _remove(name)
        del _ours[name]


def sweep(folder):
    """Remove what processes that no longer run have left in a folder.

    Paper: Sec. 6 (files; beyond the paper).
    """
    for path in Path(folder).glob(f"{PREFIX}*"):
        owner = TEMPORARY.match(path.name)
        if owner and path not in _ours and _is_left(path, int(owner[1])):
            _remove(path)


def _is_left(path, owner):
    """Whether the process of number `owner` that made the path has ended."""
    if owner == os.getpid():
        return True  # an earlier process had our number
    if sys.platform == "win32":  # where os.kill(owner, 0) would end it
        with contextlib.suppress(OSError):
            return time.time() - path.stat().st_mtime > MINUTE
        return False
    try:
        os.kill(owner, 0)
    except ProcessLookupError:
        return True
    except OSError:  # it belongs to somebody else
        pass
    return False


def discard():
    """Remove the temporary names of this process, which is about to end; whether it wrote a file.

    Paper: Sec. 6 (files; beyond the paper).
    """
    last = _written[-1] if _written else None
    begun = [name for name, place in _ours.items() if place is not None and place == last]
    done = last is not None and not any(name.exists() for name in begun)
    for name in list(_ours):
        _remove(name)
    return done


def _remove(path):
    with contextlib.suppress(OSError):  # it is gone, or still open on Windows
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink()
