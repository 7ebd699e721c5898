"""What ends with this process: the processes that it has started, each a group of its own."""

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any

SIGNALS = signal.SIGINT, signal.SIGTERM
ENDS = []  # functions without arguments that end what this process has started


@contextmanager
def held() -> Iterator[None]:
    """Signals wait until the block has ended: it starts what must be known to be ended."""
    waiting = []
    handlers = {n: signal.signal(n, lambda number, _: waiting.append(number)) for n in SIGNALS}
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for number in waiting:
            signal.raise_signal(number)


def kill(process: subprocess.Popen) -> None:
    """Kill a process that leads a group of its own, if it lives, with all in the group."""
    with suppress(OSError):
        if os.name == "nt":
            process.kill()
            process.wait(2)
        else:
            os.killpg(process.pid, signal.SIGKILL)
            os.waitpid(process.pid, 0)  # until then its number counts as alive


@contextmanager
def started(command: list, **ways: Any) -> Iterator[subprocess.Popen]:
    """A process that leads a group of its own and ends with the block, or with this process.

    command, ways: those of `subprocess.Popen`."""
    process = end = None
    try:
        with held():
            process = subprocess.Popen(command, start_new_session=True, **ways)
            end = partial(kill, process)
            ENDS.append(end)
        yield process
    finally:
        if end is not None:
            end()
            process.wait()
            ENDS.remove(end)
