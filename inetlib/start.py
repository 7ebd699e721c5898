"""The way in of `inet` as a process of its own: Ctrl-C ends it at any moment, with a sentence.

Nothing is raised, as a KeyboardInterrupt gets lost while packages are loaded and in callbacks."""

import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress

from . import files
from .ending import ENDS, SIGNALS


def main(arguments: list[str] | None = None) -> int:
    """`cli.main` for a process of its own: the exit code, or the end by a signal: 130."""
    words = sys.argv[1:] if arguments is None else arguments
    quiet = words[:1] in (["figures"], ["explore"], ["show"])
    listen(lambda: f"inet: stopped{', nothing was written' * (not quiet and not files.WRITTEN)}")
    from .cli import main as run

    code = run(words)
    finished()
    return code


def listen(sentence: Callable[[], str], fresh: bool = False) -> None:
    """From now on Ctrl-C and SIGTERM end this process: 128 + the signal's number, 130 for Ctrl-C.

    sentence() is said on stderr; fresh: on a new line.  A signal that was ignored stays so."""

    def stop(number, frame):
        for other in SIGNALS:
            signal.signal(other, signal.SIG_IGN)
        try:
            for end in [*ENDS, files.clear]:
                end()
        finally:
            line = "\n" * (fresh or os.isatty(2)) + sentence() + "\n"
            with suppress(OSError):  # nobody may be there to read it
                os.write(2, line.encode())  # sys.stderr may be in the midst of a line
            os._exit(128 + number)

    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, stop)


def finished() -> None:
    """The work is done: Ctrl-C no longer changes how this process ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
