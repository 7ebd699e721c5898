"""What the command line `inet` understands: its commands, options, checks and help texts.

Angles are degrees here, and everywhere on the command line.
"""

import argparse
import math

from . import __version__

PROFILES = "sphere", "torus", "catenoid", "vase", "cone"
SURFACES = "roof", "saddle", "shell"
DESCRIPTION = """\
Isogonal nets: quad meshes whose mid-edge parallelograms are all similar.

theta is the angle between the diagonals of a quad, theta0 the angle between the lines
that join the midpoints of opposite sides; both in degrees, the same in every quad."""
CODES = """\
exit codes: 0 done; 1 no net with these angles was found; 2 wrong input, nothing was
written; 130 stopped by Ctrl-C.  `inet COMMAND --help` shows the options of a command."""
TOLERANCE = 6e-10  # degrees, 1e-11 radians
EXAMPLES = {
    None: [
        "inet web --profile vase --theta 75 --theta0 60 -m 24 -o vase.obj",
        "inet measure vase.obj --theta 75 --theta0 60",
    ],
    "explore": ["inet explore", "inet explore roof.obj --port 8000 --open"],
    "figures": ["inet figures fig05", "inet figures 3_1 4"],
    "measure": [
        "inet web --profile sphere --theta 60 --theta0 45 -m 36 -o web.obj",
        "inet measure web.obj --theta 60 --theta0 45",
        "inet measure web.obj --json",
    ],
    "cover": [
        "inet cover roof --theta 60 --theta0 60 --quads 1500 -o net.obj",
        "inet cover saddle --theta 90 --theta0 90 --direction 30 -o 'my net.ply' --json",
    ],
    "web": [
        "inet web --profile sphere --theta 60 --theta0 45 -m 36 -o web.obj",
        "inet web --profile vase --theta 75 --theta0 60 -m 24 -n 10 -o vase.ply",
    ],
    "optimize": [
        "inet web --profile vase --theta 75 --theta0 60 -m 24 -n 12 -o vase.obj",
        "inet optimize vase.obj --theta 80 --theta0 70 --reference vase.obj -o other.obj",
    ],
}


class Parser(argparse.ArgumentParser):
    """argparse, with one sentence on stderr for a mistake, and no usage text around it."""

    def error(self, message):
        """One sentence and exit code 2."""
        self.exit(2, f"inet: {message} (see {self.prog} --help)\n")


def parser():
    """The parser of the command line: `command` names the command, the rest are its options."""
    top = Parser(prog="inet", description=DESCRIPTION, **_texts(None))
    top.add_argument("--version", action="version", version=f"inet {__version__}")
    commands = top.add_subparsers(dest="command", metavar="COMMAND", required=True)
    builders = {
        "measure": (_measure, "how well a quad mesh keeps two angles, and its quality"),
        "cover": (_cover, "cover a surface from a file with a net of two given angles"),
        "web": (_web, "an exact net on a surface of revolution"),
        "optimize": (_optimize, "change a quad mesh into a net with the angles you want"),
        "explore": (_explore, "turn the angles of a net in the browser, on this machine only"),
        "figures": (_figures, "rerun the notebooks and redraw their figures (in a clone)"),
    }
    for name, (build, words) in builders.items():
        build(
            commands.add_parser(
                name, help=words, description=words[0].upper() + words[1:] + ".", **_texts(name)
            )
        )
    return top


def _texts(name):
    lines = ["examples:", *(f"  {line}" for line in EXAMPLES[name])]
    if name is None:
        lines += ["", CODES]
    style = argparse.RawDescriptionHelpFormatter
    return {"epilog": "\n".join(lines), "formatter_class": style, "allow_abbrev": False}


# --- the commands -------------------------------------------------------------------------


def _measure(command):
    command.add_argument("net", help="a quad mesh: .obj, .ply, .off or .vtp")
    _angles(command, "; deviations are from it, or from the mean without it")
    _say(command)


def _cover(command):
    command.add_argument(
        "surface",
        help="a disk or a ring: a file .obj, .ply, .off, .stl, .vtp or .glb, or one of the "
        f"examples {', '.join(SURFACES)}",
    )
    _angles(command, "", required=True)
    size = command.add_mutually_exclusive_group()
    size.add_argument(
        "--quads", type=whole, default=1500, metavar="N", help="about so many quads (%(default)s)"
    )
    size.add_argument(
        "--size", type=positive, help="or: the mean edge, in the unit of the surface's file"
    )
    command.add_argument(
        "--direction",
        type=number,
        default=0.0,
        metavar="DEG",
        help="of the u-lines, against the longest direction of the flattened surface, or "
        "against the direction around its hole (0)",
    )
    _write(command, keep=True)


def _web(command):
    command.add_argument(
        "--profile",
        required=True,
        help=f"the meridian: {', '.join(PROFILES)}, or a .csv file with a radius and a "
        "height in each row",
    )
    _angles(command, "", required=True)
    command.add_argument("-m", type=whole, required=True, help="quads around the axis")
    command.add_argument("-n", type=whole, metavar="ROWS", help="rows (as many as fit)")
    command.add_argument(
        "--method",
        choices=("exact", "smooth", "paper"),
        default="exact",
        help="exact: straight-edged quads with these angles; smooth: points of the smooth web; "
        "paper: the published algorithm (%(default)s)",
    )
    _write(command, keep=False)


def _optimize(command):
    command.add_argument("net", help="a quad mesh: .obj, .ply, .off or .vtp")
    _angles(command, "; of --theta, --theta0, --lam, --mu at most two")
    command.add_argument("--lam", type=positive, help="ratio of the diagonals, |d2| / |d1|")
    command.add_argument("--mu", type=positive, help="ratio of the medial lines, |m13| / |m24|")
    command.add_argument("--reference", metavar="FILE", help="a surface to stay near")
    command.add_argument(
        "--on-surface", action="store_true", help="keep every vertex on the reference"
    )
    command.add_argument("--fixed", choices=("boundary",), help="vertices that stay")
    command.add_argument(
        "--via",
        choices=("mean", "medials", "diagonals", "squares", "jump"),
        default="mean",
        help="the way to the angles: from the mean ones, through right angles, or at once "
        "(%(default)s)",
    )
    _write(command, keep=True)


def _explore(command):
    command.add_argument(
        "surface", nargs="?", help="a surface to cover, as for `inet cover` (without: examples)"
    )
    command.add_argument(
        "--port", type=port, metavar="N", help="of the address (8765, or the next that is free)"
    )
    command.add_argument("--open", action="store_true", help="open the page in a browser")


def _figures(command):
    command.add_argument(
        "names", nargs="*", help="beginnings of notebook names, or figures; none: all"
    )
    _quiet(command)


# --- options that several have ------------------------------------------------------------


def _angles(command, words, required=False):
    for name, what in (("theta", "the diagonals"), ("theta0", "the medial lines")):
        command.add_argument(
            f"--{name}",
            type=angle,
            metavar="DEG",
            required=required,
            help=f"angle between {what}, degrees{words}",
        )


def _write(command, keep):
    command.add_argument(
        "-o",
        "--output",
        required=True,
        metavar="FILE",
        help="the net: .obj, .ply, .off, .vtp, .glb, .dxf or .3dm",
    )
    command.add_argument(
        "--curves",
        action="store_true",
        help="the four families of curves too, in .obj (.vtp, .glb, .dxf, .3dm always have them)",
    )
    command.add_argument("--force", action="store_true", help="replace the file if it is there")
    if keep:
        command.add_argument(
            "--tolerance",
            type=positive,
            default=TOLERANCE,
            metavar="DEG",
            help="the angles count as met within so many degrees (%(default)g)",
        )
        command.add_argument(
            "--keep", action="store_true", help="write the best net even if it is off its angles"
        )
    _say(command)


def _say(command):
    command.add_argument("--json", action="store_true", help="one JSON object on stdout")
    _quiet(command)


def _quiet(command):
    command.add_argument("--quiet", action="store_true", help="no progress bar and no table")


# --- numbers ------------------------------------------------------------------------------


def angle(text):
    """An angle in degrees between 0 and 180, both excluded."""
    return _number(text, lambda x: 0 < x < 180, "an angle above 0 and below 180 degrees")


def positive(text):
    """A finite number greater than zero."""
    return _number(text, lambda x: x > 0, "a positive number")


def number(text):
    """Any finite number."""
    return _number(text, lambda x: True, "a finite number")


def whole(text):
    """A whole number from 1 upwards."""
    return int(_number(text, lambda x: x >= 1 and x == int(x), "a whole number from 1 upwards"))


def port(text):
    """A whole number that a port of this machine can have, 0 for any that is free."""
    words = "a whole number from 0 to 65535"
    return int(_number(text, lambda x: 0 <= x <= 65535 and x == int(x), words))


def _number(text, allowed, words):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and allowed(value)):
        raise argparse.ArgumentTypeError(f"{text} is given, {words} is wanted")
    return value
