"""What the commands share: values of options, groups of options, stages, JSON."""

import argparse
import contextlib
import difflib
import json
import math
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

DEGREE = "\u00b0"
LEAST = 0.01  # degrees: angles closer to 0 or to 180 make needles that no computation can tell
LOCAL = "127.0.0.1", "localhost"


def _number(wanted, allowed, made=float, plain=str):
    """An argparse type: what `made` makes of a finite number that is allowed."""

    def read(text: str) -> Any:
        """The value that a text is, or argparse's error."""
        with contextlib.suppress(ValueError):
            value = float(plain(text))
            if math.isfinite(value) and allowed(value):
                return made(value)
        raise argparse.ArgumentTypeError(f"{text} is given, {wanted} is wanted")

    return read


def _degrees(text):
    """60.5 as people write it: 60,5 or with a degree sign."""
    return text.strip().removesuffix(DEGREE).replace(",", ".")


angle = _number(
    f"an angle above 0 and below 180 degrees (from {LEAST} to {180 - LEAST})",
    lambda x: LEAST <= x <= 180 - LEAST,
    math.radians,
    _degrees,
)
turn = _number("a finite number of degrees", lambda x: True, math.radians, _degrees)
tolerance = _number("a positive number", lambda x: x > 0, math.radians)
positive = _number("a positive number", lambda x: x > 0)
whole = _number("a whole number from 1 upwards", lambda x: x >= 1 and x == int(x), int)
port = _number("a whole number from 0 to 65535", lambda x: x in range(65536), int)


def _numbers(count, wanted):
    """An argparse type: so many finite numbers, with commas between them."""

    def read(text: str) -> tuple:
        """The numbers that a text is, or argparse's error."""
        with contextlib.suppress(ValueError):
            found = tuple(map(float, text.split(",")))
            if len(found) == count and all(map(math.isfinite, found)):
                return found
        raise argparse.ArgumentTypeError(f"{text} is given, {wanted} are wanted")

    return read


point = _numbers(3, "three finite numbers x,y,z")
direction = _numbers(2, "two angles in degrees, AZIMUTH,ELEVATION,")


def host(text: str) -> str:
    """An argparse type: a name of this machine for itself."""
    if text not in LOCAL:
        words = "the page is always local, only this machine can open it"
        raise argparse.ArgumentTypeError(f"{text} is given, {words}: leave --host out")
    return text


def angles(command: argparse.ArgumentParser, words: str, required: bool = False) -> None:
    """The options --theta and --theta0."""
    for name, what in (("--theta", "the diagonals"), ("--theta0", "the medial lines")):
        text = f"angle between {what}, degrees{words}"
        command.add_argument(name, type=angle, metavar="DEG", required=required, help=text)


def say(command: argparse.ArgumentParser) -> None:
    """The options --json and --quiet."""
    command.add_argument("--json", action="store_true", help="one JSON object on stdout")
    command.add_argument("--quiet", action="store_true", help="no progress bar and no table")


def progress(given: argparse.Namespace) -> bool:
    """Whether somebody looks at stderr and wants to know how far it is."""
    return sys.stderr.isatty() and not getattr(given, "quiet", False)


@contextlib.contextmanager
def stage(given: argparse.Namespace, name: str) -> Iterator[None]:
    """A stage of the way, named on stderr while it lasts."""
    if not progress(given):
        yield
        return
    from tqdm import tqdm

    with tqdm(desc=name, bar_format="{desc} ... {elapsed}", leave=False):
        yield


def surface(given: argparse.Namespace, merge: bool = True) -> Any:
    """(V, F, sentences on what was repaired) of the surface that is named: an example or a file."""
    from .. import examples, io

    if given.surface in examples.SURFACES:
        with stage(given, f"making {given.surface}"):
            return io.Surface(*examples.SURFACES[given.surface](), [])
    name = given.surface
    if not (Path(name).suffix or Path(name).exists()):
        raise ValueError(f"{name} is no file, and no example: {nearest(name, examples.SURFACES)}")
    with stage(given, f"reading {name}"):
        return io.surface(name, merge)


def put(given: argparse.Namespace, known: dict, text: Callable[[], str]) -> None:
    """What is known, as JSON or as a text, on stdout."""
    if given.json:
        print(json.dumps(known, indent=2, allow_nan=False))
    elif not given.quiet:
        print(text())


def nearest(name: str, names: Iterable[str]) -> str:
    """The name that may be meant, or all there are."""
    found = difflib.get_close_matches(name, [*names], 1, 0.5)
    return f"did you mean {found[0]}?" if found else f"there are {', '.join(names)}"


def tell(words: object, code: int) -> int:
    """A sentence on stderr, and the exit code."""
    if isinstance(words, OSError) and words.strerror and words.filename is not None:
        words = f"{words.filename}: {words.strerror}"
    print("inet:", " ".join((str(words) or type(words).__name__).split()), file=sys.stderr)
    return code
