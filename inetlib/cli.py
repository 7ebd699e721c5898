"""The command line `inet`; angles are degrees on it, and radians from the parser on.

Wrong input becomes one sentence, before the work begins and anything slow is loaded; files are
written after all went well."""

import argparse
import contextlib
import functools
import importlib
import json
import math
import os
import re
import sys
import warnings
import webbrowser
from pathlib import Path

from . import __version__, files

DONE, NOT_FOUND, WRONG, STOPPED = 0, 1, 2, 130
ROOT = Path(__file__).resolve().parent.parent
DESCRIPTION = """\
Isogonal nets: quad meshes whose mid-edge parallelograms are all similar.

theta is the angle between the diagonals of a quad, theta0 the angle between the lines
that join the midpoints of opposite sides; both in degrees, the same in every quad."""
EPILOG = """\
examples:
  inet web --profile vase --theta 75 --theta0 60 -m 24 -o vase.obj
  inet measure vase.obj --theta 75 --theta0 60

exit codes: 0 done; 1 no net with these angles was found; 2 wrong input, nothing was
written; 130 stopped by Ctrl-C.  `inet COMMAND --help` shows the options of a command."""
HELP = {  # what a command does, and examples
    "measure": """How well a quad mesh keeps two angles, and its quality.
        inet web --profile sphere --theta 60 --theta0 45 -m 36 -o web.obj
        inet measure web.obj --theta 60 --theta0 45
        inet measure web.obj --json""",
    "cover": """Cover a surface from a file with a net of two given angles.
        inet cover roof --theta 60 --theta0 60 --quads 1500 -o net.obj
        inet cover saddle --theta 90 --theta0 90 --direction 30 -o 'my net.ply' --json""",
    "web": """An exact net on a surface of revolution.
        inet web --profile sphere --theta 60 --theta0 45 -m 36 -o web.obj
        inet web --profile vase --theta 75 --theta0 60 -m 24 -n 10 -o vase.ply""",
    "optimize": """Change a quad mesh into a net with the angles you want.
        inet web --profile vase --theta 75 --theta0 60 -m 24 -n 12 -o vase.obj
        inet optimize vase.obj --theta 80 --theta0 70 --reference vase.obj -o other.obj""",
    "explore": """Turn the angles of a net in the browser, on this machine only.
        inet explore
        inet explore roof.obj --port 8000 --open""",
    "figures": """Rerun the notebooks and redraw their figures (in a clone).
        inet figures fig05
        inet figures 3_1 4""",
    "course": """Grade the exercises in many notebooks that were handed in.
        inet course grade submissions
        inet course grade submissions -o 'week 2.csv' --seconds 60""",
}
TEXTS = {name: [*map(str.strip, text.splitlines())] for name, text in HELP.items()}


class Parser(argparse.ArgumentParser):
    """argparse, with one sentence on stderr for a mistake, and no usage text around it."""

    def error(self, message):
        self.exit(WRONG, f"inet: {message} (see {self.prog} --help)\n")


def main(arguments: list[str] | None = None) -> int:
    """Run `inet` with these arguments, or those of the process: the exit code, see `EPILOG`."""
    words = sys.argv[1:] if arguments is None else arguments
    try:
        given = parser(words).parse_args(words)
    except SystemExit as end:  # help, the version, or a mistake that was already told
        return end.code
    written = len(files.WRITTEN)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            code = COMMANDS[given.command][0](given)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        quiet = given.command in ("figures", "explore") or len(files.WRITTEN) > written
        return _tell("stopped" + ", nothing was written" * (not quiet), STOPPED)
    except BrokenPipeError:  # the reader of our output went away, for example `head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except (ValueError, OSError, ImportError, RuntimeError, ArithmeticError) as error:
        return _tell(error, WRONG)
    except MemoryError:
        return _tell("there is not enough memory for this: ask for fewer quads", WRONG)


def _tell(words, code):
    if isinstance(words, OSError) and words.strerror and words.filename is not None:
        words = f"{words.filename}: {words.strerror}"
    print("inet:", " ".join((str(words) or type(words).__name__).split()), file=sys.stderr)
    return code


def parser(words: list[str]) -> Parser:
    """The parser of the command line, with the options of the commands among the words."""
    style = {"formatter_class": argparse.RawDescriptionHelpFormatter, "allow_abbrev": False}
    top = Parser(prog="inet", description=DESCRIPTION, epilog=EPILOG, **style)
    top.add_argument("--version", action="version", version=f"inet {__version__}")
    commands = top.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, (text, *examples) in TEXTS.items():
        short = text[0].lower() + text[1:-1]
        epilog = "\n  ".join(["examples:", *examples])
        command = commands.add_parser(name, help=short, description=text, epilog=epilog, **style)
        if name in words:
            COMMANDS[name][1](command)
    return top


def _number(wanted, allowed, made=float):
    """An argparse type: what `made` makes of a finite number that is allowed."""

    def read(text):
        with contextlib.suppress(ValueError):
            value = float(text)
            if math.isfinite(value) and allowed(value):
                return made(value)
        raise argparse.ArgumentTypeError(f"{text} is given, {wanted} is wanted")

    return read


_angle = _number("an angle above 0 and below 180 degrees", lambda x: 0 < x < 180, math.radians)
_turn = _number("a finite number", lambda x: True, math.radians)
_tolerance = _number("a positive number", lambda x: x > 0, math.radians)
_positive = _number("a positive number", lambda x: x > 0)


def _point(text):
    """An argparse type: x,y,z."""
    with contextlib.suppress(ValueError):
        point = tuple(map(float, text.split(",")))
        if len(point) == 3 and all(map(math.isfinite, point)):
            return point
    raise argparse.ArgumentTypeError(f"{text} is given, three finite numbers x,y,z are wanted")


_whole = _number("a whole number from 1 upwards", lambda x: x >= 1 and x == int(x), int)
_port = _number("a whole number from 0 to 65535", lambda x: x in range(65536), int)


def _angle_options(command, words, required=False):
    for name, what in (("--theta", "the diagonals"), ("--theta0", "the medial lines")):
        text = f"angle between {what}, degrees{words}"
        command.add_argument(name, type=_angle, metavar="DEG", required=required, help=text)


def _write_options(command, keep):
    add = command.add_argument
    text = "the net: .obj, .ply, .off, .stl, .vtp, .glb, .dxf or .3dm"
    add("-o", "--output", required=True, metavar="FILE", help=text)
    text = "the four families of curves too, in .obj (.vtp, .glb, .dxf, .3dm always have them)"
    add("--curves", action="store_true", help=text)
    add("--force", action="store_true", help="replace the file if it is there")
    units = "mm", "cm", "m", "in", "ft"
    add("--unit", choices=units, help="of the coordinates, noted in .dxf and .3dm files")
    add("--up", choices=("z", "y"), default="z", help="the axis upwards in the file (%(default)s)")
    text = "in .dxf files: one mesh, or faces that more programs read (%(default)s)"
    add("--dxf", choices=("mesh", "3dface"), default="mesh", help=text)
    if keep:
        text, least = "the angles count as met within so many degrees (%(default)s)", "6e-10"
        add("--tolerance", type=_tolerance, default=least, metavar="DEG", help=text)
        add("--keep", action="store_true", help="write the best net even if it is off its angles")
    _say_options(command)


def _say_options(command, numbers=True):
    if numbers:
        command.add_argument("--json", action="store_true", help="one JSON object on stdout")
    command.add_argument("--quiet", action="store_true", help="no progress bar and no table")


def _measure_options(command):
    command.add_argument("net", help="a quad mesh: .obj, .ply, .off, .vtp or .3dm")
    _angle_options(command, "; deviations are from it, or from the mean without it")
    _say_options(command)


def _measure(given):
    V, Q, polygons, notes = _read_net(given, must_label=False)
    from . import mesh

    _say(given, _report(given, V, Q, polygons), given.net, notes, labelled=mesh.is_labelled(Q))
    return DONE


def _cover_options(command):
    from .examples import SURFACES

    text = f"""a disk, with any number of holes: a file .obj, .ply, .off, .stl, .vtp, .glb, .gltf
        or .3dm, or one of the examples {", ".join(SURFACES)}"""
    command.add_argument("surface", help=text)
    _angle_options(command, "", required=True)
    size = command.add_mutually_exclusive_group()
    text = "about so many quads (%(default)s)"
    size.add_argument("--quads", type=_whole, default=1500, metavar="N", help=text)
    text = "or: the mean edge, in the unit of the surface's file"
    size.add_argument("--size", type=_positive, help=text)
    text = "duplicate vertices stay: what was cut open on purpose stays open"
    command.add_argument("--no-merge", action="store_true", help=text)
    part = command.add_mutually_exclusive_group()
    text = "of a surface of several pieces the N-th by area (1: the largest)"
    part.add_argument("--piece", type=_whole, metavar="N", help=text)
    text = "the largest piece, as --piece 1"
    part.add_argument("--largest", dest="piece", action="store_const", const=1, help=text)
    text = """one hole: an opening, which the curves run on across, or a ring's (ring); two
        holes or more are openings"""
    command.add_argument("--openings", choices=("fill", "ring"), help=text)
    text = "fill the strip at the boundary with cut panels, 3 to 6 corners each"
    command.add_argument("--trim", action="store_true", help=text)
    text = """of the u-lines, against the longest direction of the flattened surface, or
        against the direction around its hole (0)"""
    command.add_argument("--direction", type=_turn, default=0.0, metavar="DEG", help=text)
    way = command.add_mutually_exclusive_group()
    text = "u-lines follow its longest stretch without corners; --direction adds to this"
    way.add_argument("--along", choices=("boundary",), help=text)
    text = "u-lines go that way in space, --through a point or in the middle (--align=-1,0,0)"
    way.add_argument("--align", type=_point, metavar="X,Y,Z", help=text)
    text = "the point of the surface nearest to this one is a vertex of the net"
    command.add_argument("--through", type=_point, metavar="X,Y,Z", help=text)
    _write_options(command, keep=True)


def _cover(given):
    from . import examples, io

    io.check_output(given.output, given.curves, given.force, *_style(given))
    if given.surface in examples.SURFACES:
        (V, F), repaired = examples.SURFACES[given.surface](), []
    else:
        V, F, repaired = io.surface(given.surface, merge=not given.no_merge)
    from . import design

    asked = given.theta, given.theta0, given.quads, given.size, given.direction
    ways = {"tolerance": given.tolerance, "progress": _progress(given), "openings": given.openings}
    ways |= {name: getattr(given, name) for name in ("trim", "along", "align", "through")}
    with io.named(given.surface, V, counted=False):
        if given.piece is not None:
            from . import repair

            V, F, said = repair.piece(V, F, given.piece)
            repaired = [*repaired, said] if said else repaired
        found = design.cover(V, F, *asked, **ways)
    about = found.report
    said = [*about.notes, *repaired, *about.repairs]
    notes = [f"{given.surface}: {x}" for x in dict.fromkeys(said)]
    more = {"converged": about.converged, "message": about.message}
    net = found.V, found.Q, found.polygons
    return _finish(given, *net, about, notes, more, found.edges)


def _web_options(command):
    from .surfaces import PROFILES

    add = command.add_argument
    text = f"""the meridian: {", ".join(PROFILES)}, or a .csv file with a radius and a
        height in each row"""
    add("--profile", required=True, help=text)
    _angle_options(command, "", required=True)
    add("-m", type=_whole, required=True, help="quads around the axis")
    add("-n", type=_whole, metavar="ROWS", help="rows (as many as fit)")
    text = """exact: straight-edged quads with these angles; smooth: points of the smooth web;
        paper: the published algorithm (%(default)s)"""
    add("--method", choices=("exact", "smooth", "paper"), default="exact", help=text)
    _write_options(command, keep=False)


def _web(given):
    from . import io, loxodrome

    io.check_output(given.output, given.curves, given.force, *_style(given))
    profile = _profile(given.profile)
    net = loxodrome.web(profile, given.theta, given.theta0, given.m, given.n, given.method)
    about = _report(given, net.V, net.Q)
    more = {"rows": net.rows, "quads_around": given.m, "message": net.message}
    return _finish(given, net.V, net.Q, (), about, [], more)


def _profile(name):
    """The profile of this name, or through the rows of a file, each a radius and a height."""
    from . import io, surfaces

    if name in surfaces.PROFILES:
        return surfaces.PROFILES[name]()
    if not Path(name).is_file():
        known = ", ".join(surfaces.PROFILES)
        raise ValueError(f"--profile {name}: neither {known} nor a file that is there")
    rows = []
    lines = Path(name).read_text(encoding="utf-8-sig", errors="replace").splitlines()
    for k, line in enumerate(map(str.strip, lines), 1):
        try:
            radius, height = map(float, re.split(r"[,;\s]+", line.strip(" \t,;")))
            rows.append((radius, height))
        except ValueError:
            if line and (rows or re.search(r"\d", line)):
                what = f"a radius and a height are wanted, not {line[:40]!r}"
                raise ValueError(f"{name}, line {k}: {what}") from None
    with io.named(name):
        if len(rows) < 2:
            raise ValueError("at least two rows with a radius and a height are wanted")
        return surfaces.spline_profile(rows)


def _optimize_options(command):
    add = command.add_argument
    add("net", help="a quad mesh: .obj, .ply, .off, .vtp or .3dm")
    _angle_options(command, "; of --theta, --theta0, --lam, --mu at most two")
    add("--lam", type=_positive, help="ratio of the diagonals, |d2| / |d1|")
    add("--mu", type=_positive, help="ratio of the medial lines, |m13| / |m24|")
    add("--reference", metavar="FILE", help="a surface to stay near")
    add("--on-surface", action="store_true", help="keep every vertex on the reference")
    add("--fixed", choices=("boundary",), help="vertices that stay")
    text = """the way to the angles: from the mean ones, through right angles, or at once
        (%(default)s)"""
    ways = "mean", "medials", "diagonals", "squares", "jump"
    add("--via", choices=ways, default="mean", help=text)
    _write_options(command, keep=True)


def _optimize(given):
    from . import io, mesh

    io.check_output(given.output, given.curves, given.force, *_style(given))
    V, Q, polygons, notes = _read_net(given)
    ways = {name: getattr(given, name) for name in ("on_surface", "fixed", "via", "tolerance")}
    if given.reference is not None:
        W, F, repaired = io.surface(given.reference)
        notes += [f"{given.reference}: {sentence}" for sentence in repaired]
        from . import reference

        ways["reference"] = reference.mesh(W, F)
    from . import solver

    rims = {frozenset(loop.tolist()) for loop in mesh.boundary_loops(Q)}
    ways["polygons"] = [p for p in polygons if frozenset(p.tolist()) in rims]
    asked = given.theta, given.theta0, given.lam, given.mu
    found = solver.optimize(V, Q, *asked, progress=_progress(given), **ways)
    names = "converged", "message", "lam", "mu", "seconds"
    more = {name: getattr(found, name) for name in names} | {"steps": len(found.history) - 1}
    about = _report(given, found.V, Q, polygons)
    return _finish(given, found.V, Q, polygons, about, notes, more)


def _explore_options(command):
    add = command.add_argument
    add("surface", nargs="?", help="a surface to cover, as for `inet cover` (without: examples)")
    add("--port", type=_port, metavar="N", help="of the address (8765, or the next that is free)")
    add("--open", action="store_true", help="open the page in a browser")


def _explore(given):
    from . import io

    def ready(address):
        print(f"Isogonal nets: {address} (Ctrl-C ends it)", flush=True)
        if given.open:
            webbrowser.open(address)

    surface = given.surface and io.surface(given.surface)
    if surface:
        from . import repair

        repair.clean(surface.V, surface.F)  # refuses what cannot be covered
    from .explorer import notebook

    notebook.server().serve(surface, given.surface, given.port, ready)
    return DONE


def _figures_options(command):
    text = "beginnings of notebook names, or figures; none: all"
    command.add_argument("names", nargs="*", help=text)
    _say_options(command, numbers=False)


def _figures(given):
    runner, folder = ROOT / "tools" / "redraw.py", ROOT / "notebooks"
    if not (runner.is_file() and folder.is_dir()):
        raise ValueError("figures: the notebooks are not here, run this in a clone of the project")
    names = [stem for name in given.names for stem in notebooks(folder, name)]
    sys.path.insert(0, str(runner.parent))
    redraw = importlib.import_module("redraw")
    if not _progress(given):
        redraw.tqdm = functools.partial(redraw.tqdm, disable=True)
    with contextlib.redirect_stdout(None if given.quiet else sys.stdout):
        return redraw.main(list(dict.fromkeys(names)))


def notebooks(folder: Path, name: str) -> list[str]:
    """The notebooks whose names begin so, or that draw the figure of this name (their tags)."""
    found = []
    for path in sorted(folder.glob("*.ipynb")):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        tags = {tag for cell in cells for tag in cell["metadata"].get("tags", [])}
        if path.stem.startswith(name) or name in tags:
            found.append(path.stem)
    if not found:
        raise ValueError(f"figures: no notebook begins with {name!r}, and none draws it")
    return found


def _course_options(command):
    add = command.add_argument
    add("task", choices=("grade",), metavar="grade", help="grade what is in a folder")
    text = """of the notebooks, *.ipynb; copies of them are run, with limits and in a temporary
        folder, but with your rights: this is no sandbox against malice"""
    add("folder", help=text)
    text = "the table, a row a notebook: 1 right, 0 wrong, nothing where no answer is (%(default)s)"
    add("-o", "--output", default="grades.csv", metavar="FILE", help=text)
    add("--force", action="store_true", help="replace the file if it is there")
    text = "for each notebook, at most (%(default)g)"
    add("--seconds", type=_positive, default=30.0, metavar="S", help=text)
    _say_options(command, numbers=False)


def _course(given):
    output = Path(given.output)
    if output.suffix.lower() != ".csv":
        raise ValueError(f"{output}: a table is written, its name ends with .csv")
    files.check_place(output, given.force)
    from .exercises import grade, names

    paths, bar = (
        grade.notebooks(given.folder),
        {"unit": "notebook", "disable": not _progress(given)},
    )
    from tqdm import tqdm

    rows = [grade.grade(path, given.seconds) for path in tqdm(paths, **bar)]
    grade.write(output, rows, names())
    if not given.quiet:
        print(f"{output}\n{grade.summary(rows)}")
    return DONE


def _read_net(given, must_label=True):
    """(V, Q, polygons, notes) of a net's file, labelled; if that fails, ValueError or a note."""
    from . import io, measure, mesh, repair

    net = io.net(given.net)
    V, Q, polygons, notes = repair.welded(*net)
    as_read = given.net, V, len(V) == len(net.V)
    labelled = Q
    try:
        with io.named(*as_read):
            labelled = mesh.label(Q)
        if (labelled != Q).any():
            notes += ["the faces did not agree on u and v: all are labelled like the first one now"]
    except ValueError as reason:
        if must_label:
            raise
        notes += [f"{reason}; the numbers are those of the labels in the file"]
    with io.named(*as_read):
        measure.quality(V, labelled)  # refuses collapsed faces
    return V, labelled, polygons, notes + _turned(V, labelled, given.theta, given.theta0)


def _turned(V, Q, theta, theta0):
    """A note, or none, that the angles would fit much better with u and v exchanged."""
    if theta is None or theta0 is None:
        return []
    from . import measure

    means = [float(x.mean()) for x in measure.angles(V, Q)]
    turned = [math.pi - x for x in means]
    off, other = (max(abs(a - theta), abs(b - theta0)) for a, b in (means, turned))
    if off < 2 * other + math.radians(1):
        return []
    words = " and ".join(f"{math.degrees(x):.6g}" for x in turned)
    return [f"u and v may be exchanged in the file: with the other labels its angles are {words}"]


def _report(given, V, Q, polygons=()):
    from .design import report

    wanted = {name: getattr(given, name, None) for name in report.NAMES}
    return report.report(V, Q, polygons, **wanted)


def _style(given):
    """How the file is written: unit, faces, up."""
    return given.unit, given.dxf == "3dface", given.up


def _finish(given, V, Q, polygons, about, notes, more, edges=None):
    """Write the net if it is good or to be kept, and say what there is to say: exit code."""
    from . import io, mesh

    good = more.get("converged", True)
    written = good or given.keep
    if written:
        suffix = Path(given.output).suffix.lower()
        wanted = given.curves or (suffix in io.WITH_CURVES and suffix != ".obj")
        curves = mesh.polylines(Q, edges) if wanted else None
        io.write(given.output, V, Q, curves, polygons, given.force, *_style(given))
    _say(given, about, given.output if written else None, notes, **more)
    if good:
        return DONE
    what = "this net was written" if written else "nothing was written, --keep does it"
    return _tell(f"{more['message']}; {what}", NOT_FOUND)


def _say(given, about, file, notes, **more):
    """The `Report`, the file and what else there is, in words or as JSON."""
    from .design import report

    known = {"file": file, **report.numbers(about), **more, "notes": notes}
    if given.json:
        print(json.dumps(known, indent=2, allow_nan=False))
    elif not given.quiet:
        print(file or "not written")
        if "message" in known and known.get("converged", True):
            print(known["message"])
        for note in notes:
            print("note:", note)
        print(report.text(about))


def _progress(given):
    return sys.stderr.isatty() and not given.quiet


COMMANDS = {
    "measure": (_measure, _measure_options),
    "cover": (_cover, _cover_options),
    "web": (_web, _web_options),
    "optimize": (_optimize, _optimize_options),
    "explore": (_explore, _explore_options),
    "figures": (_figures, _figures_options),
    "course": (_course, _course_options),
}
