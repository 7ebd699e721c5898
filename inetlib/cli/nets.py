"""Commands that make, change and judge nets."""

import math
import re
from pathlib import Path

from . import options

NOT_FOUND = 1


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
    _planar_option(command)
    if keep:
        text, least = "the angles count as met within so many degrees (%(default)s)", "6e-10"
        add("--tolerance", type=options.tolerance, default=least, metavar="DEG", help=text)
        add("--keep", action="store_true", help="write the best net even if it is off its angles")
    options.say(command)


def _planar_option(command):
    text = "name the panels that are more than this length out of plane, the 20 worst at most"
    command.add_argument("--planar-report", type=options.positive, metavar="LENGTH", help=text)


def _measure_options(command):
    command.add_argument("net", help="a quad mesh: .obj, .ply, .off, .vtp or .3dm")
    options.angles(command, "; deviations are from it, or from the mean without it")
    _planar_option(command)
    options.say(command)


def _measure(given):
    V, Q, polygons, notes = _read_net(given, must_label=False)
    from .. import mesh

    more = {"labelled": mesh.is_labelled(Q), **_out_of_plane(given, V, Q, polygons)}
    _say(given, _report(given, V, Q, polygons), given.net, notes, **more)


def _cover_options(command):
    from ..examples import SURFACES

    text = f"""a disk, with any number of holes: a file .obj, .ply, .off, .stl, .vtp, .glb, .gltf
        or .3dm, or one of the examples {", ".join(SURFACES)}"""
    command.add_argument("surface", help=text)
    options.angles(command, "", required=True)
    size = command.add_mutually_exclusive_group()
    text = "about so many quads (%(default)s)"
    size.add_argument("--quads", type=options.whole, default=1500, metavar="N", help=text)
    text = "or: the mean edge, in the unit of the surface's file"
    size.add_argument("--size", type=options.positive, help=text)
    text = "duplicate vertices stay: what was cut open on purpose stays open"
    command.add_argument("--no-merge", action="store_true", help=text)
    part = command.add_mutually_exclusive_group()
    text = "of a surface of several pieces the N-th by area (1: the largest)"
    part.add_argument("--piece", type=options.whole, metavar="N", help=text)
    text = "the largest piece, as --piece 1"
    part.add_argument("--largest", dest="piece", action="store_const", const=1, help=text)
    text = """one hole: an opening, which the curves run on across, or a ring's (ring); two
        holes or more are openings"""
    command.add_argument("--openings", choices=("fill", "ring"), help=text)
    text = "fill the strip at the boundary with cut panels, 3 to 6 corners each"
    command.add_argument("--trim", action="store_true", help=text)
    text = """of the u-lines, against the longest direction of the flattened surface, or
        against the direction around its hole (0)"""
    command.add_argument("--direction", type=options.turn, default=0.0, metavar="DEG", help=text)
    way = command.add_mutually_exclusive_group()
    text = "u-lines follow its longest stretch without corners; --direction adds to this"
    way.add_argument("--along", choices=("boundary",), help=text)
    text = "u-lines go that way in space, --through a point or in the middle (--align=-1,0,0)"
    way.add_argument("--align", type=options.point, metavar="X,Y,Z", help=text)
    text = "the point of the surface nearest to this one is a vertex of the net"
    command.add_argument("--through", type=options.point, metavar="X,Y,Z", help=text)
    _write_options(command, keep=True)


def _cover(given):
    from .. import io

    io.check_output(given.output, given.curves, given.force, *_style(given))
    V, F, repaired = options.surface(given, merge=not given.no_merge)
    from .. import design

    asked = given.theta, given.theta0, given.quads, given.size, given.direction
    names = "tolerance", "openings", "trim", "along", "align", "through"
    ways = {name: getattr(given, name) for name in names}
    ways["progress"] = options.progress(given)
    with io.named(given.surface, V, counted=False):
        if given.piece is not None:
            from .. import repair

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
    from ..surfaces import PROFILES

    add = command.add_argument
    text = f"""the meridian: {", ".join(PROFILES)}, or a .csv file with a radius and a
        height in each row"""
    add("--profile", required=True, metavar="PROFILE", help=text)
    options.angles(command, "", required=True)
    add("-m", type=options.whole, required=True, help="quads around the axis")
    add("-n", type=options.whole, metavar="ROWS", help="rows (as many as fit)")
    text = """exact: straight-edged quads with these angles; smooth: points of the smooth web;
        paper: the published algorithm (%(default)s)"""
    add("--method", choices=("exact", "smooth", "paper"), default="exact", help=text)
    _write_options(command, keep=False)


def _web(given):
    from .. import io, loxodrome

    io.check_output(given.output, given.curves, given.force, *_style(given))
    profile = _profile(given.profile)
    with options.stage(given, "laying"):
        net = loxodrome.web(profile, given.theta, given.theta0, given.m, given.n, given.method)
    about = _report(given, net.V, net.Q)
    more = {"rows": net.rows, "quads_around": given.m, "message": net.message}
    return _finish(given, net.V, net.Q, (), about, [], more)


def _profile(name):
    """The profile of this name, or through the rows of a file, each a radius and a height."""
    from .. import io, surfaces

    if name in surfaces.PROFILES:
        return surfaces.PROFILES[name]()
    if not Path(name).is_file():
        known = options.nearest(name, surfaces.PROFILES)
        raise ValueError(f"--profile {name} is no file, and no profile: {known}")
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
    options.angles(command, "; of --theta, --theta0, --lam, --mu at most two")
    add("--lam", type=options.positive, help="ratio of the diagonals, |d2| / |d1|")
    add("--mu", type=options.positive, help="ratio of the medial lines, |m13| / |m24|")
    add("--reference", metavar="FILE", help="a surface to stay near")
    add("--on-surface", action="store_true", help="keep every vertex on the reference")
    add("--fixed", choices=("boundary",), help="vertices that stay")
    text = """the way to the angles: from the mean ones, through right angles, or at once
        (%(default)s)"""
    ways = "mean", "medials", "diagonals", "squares", "jump"
    add("--via", choices=ways, default="mean", help=text)
    _write_options(command, keep=True)


def _optimize(given):
    from .. import io, mesh

    io.check_output(given.output, given.curves, given.force, *_style(given))
    V, Q, polygons, notes = _read_net(given)
    ways = {name: getattr(given, name) for name in ("on_surface", "fixed", "via", "tolerance")}
    from .. import reference, solver

    near = None
    if given.reference is not None:
        with options.stage(given, f"reading {given.reference}"):
            W, F, repaired = io.surface(given.reference)
        notes += [f"{given.reference}: {sentence}" for sentence in repaired]
        near = ways["reference"] = reference.mesh(W, F)

    rims = {frozenset(loop.tolist()) for loop in mesh.boundary_loops(Q)}
    ways["polygons"] = [p for p in polygons if frozenset(p.tolist()) in rims]
    asked = given.theta, given.theta0, given.lam, given.mu
    found = solver.optimize(V, Q, *asked, progress=options.progress(given), **ways)
    names = "converged", "message", "lam", "mu", "seconds"
    more = {name: getattr(found, name) for name in names} | {"steps": len(found.history) - 1}
    about = _report(given, found.V, Q, polygons)
    if near is not None:
        off = near.distances(found.V)
        about = about._replace(distance_mean=float(off.mean()), distance_max=float(off.max()))
    return _finish(given, found.V, Q, polygons, about, notes, more)


def _schedule_options(command):
    add = command.add_argument
    command.set_defaults(theta=None, theta0=None)
    text = "a quad mesh, with cut panels or without: .obj, .ply, .off, .vtp or .3dm"
    add("net", help=text)
    text = """the panels, NAME.csv; the nodes and the bars are written beside it, as NAME_nodes.csv
        and NAME_bars.csv"""
    add("-o", "--output", required=True, metavar="FILE", help=text)
    text = """panels are of one type when their edges, their diagonals and how far their corners
        are out of plane differ by this length at most from those of its first panel; mirror
        images are of two types (%(default)s)"""
    add("--tolerance", type=options.positive, default="0.001", metavar="LENGTH", help=text)
    add("--force", action="store_true", help="replace the three files if they are there")
    options.say(command)


def _schedule(given):
    from .. import io, schedule

    written = [str(path) for path in schedule.places(given.output, given.force)]
    V, Q, polygons, notes = _read_net(given, False, "no theta, theta0 and families are given")
    with io.named(given.net, V, counted=False):
        found = schedule.schedule(V, Q, polygons, given.tolerance)
    schedule.write(given.output, found, given.force)
    known = {"file": written[0], "files": written, **schedule.numbers(found), "notes": notes}
    lines = [*written, *(f"note: {note}" for note in notes), schedule.text(found)]
    options.put(given, known, lambda: "\n".join(lines))


def _read_net(given, must_label=True, without="the numbers are those of the labels in the file"):
    """(V, Q, polygons, notes) of a net's file, labelled; if that fails, ValueError or a note."""
    from .. import io, measure, mesh, repair

    with options.stage(given, f"reading {given.net}"):
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
        notes += [f"{reason}; {without}"]
    with io.named(*as_read):
        measure.quality(V, labelled)  # refuses collapsed faces
    return V, labelled, polygons, notes + _turned(V, labelled, given.theta, given.theta0)


def _turned(V, Q, theta, theta0):
    """A note, or none, that the angles would fit much better with u and v exchanged."""
    if theta is None or theta0 is None:
        return []
    from .. import measure

    means = [float(x.mean()) for x in measure.angles(V, Q)]
    turned = [math.pi - x for x in means]
    off, other = (max(abs(a - theta), abs(b - theta0)) for a, b in (means, turned))
    if off < 2 * other + math.radians(1):
        return []
    words = " and ".join(f"{math.degrees(x):.6g}" for x in turned)
    return [f"u and v may be exchanged in the file: with the other labels its angles are {words}"]


def _report(given, V, Q, polygons=()):
    from ..design import report

    wanted = {name: getattr(given, name, None) for name in report.NAMES}
    return report.report(V, Q, polygons, **wanted)


def _out_of_plane(given, V, Q, polygons):
    """What --planar-report asks for, by its name in JSON."""
    from ..design import report

    beyond = given.planar_report
    return {"out_of_plane": report.out_of_plane(V, Q, polygons, beyond)} if beyond else {}


def _style(given):
    """How the file is written: unit, faces, up."""
    return given.unit, given.dxf == "3dface", given.up


def _finish(given, V, Q, polygons, about, notes, more, edges=None):
    """Write the net if it is good or to be kept, and say what there is to say: exit code."""
    from .. import io, mesh

    good = more.get("converged", True)
    written = good or given.keep
    if written:
        suffix = Path(given.output).suffix.lower()
        wanted = given.curves or (suffix in io.WITH_CURVES and suffix != ".obj")
        curves = mesh.polylines(Q, edges) if wanted else None
        io.write(given.output, V, Q, curves, polygons, given.force, *_style(given))
    more |= _out_of_plane(given, V, Q, polygons)
    _say(given, about, given.output if written else None, notes, **more)
    if good:
        return None
    what = "this net was written" if written else "nothing was written, --keep does it"
    may = {"cover": "more --quads or another --direction", "optimize": "another --via"}
    words = f"{more['message']}; {what} ({may[given.command]} may do better)"
    return options.tell(words, NOT_FOUND)


def _say(given, about, file, notes, **more):
    """The `Report`, the file and what else there is, in words or as JSON."""
    from ..design import report

    known = {"file": file, **report.numbers(about), **more, "notes": notes}

    def text():
        lines = [file or "not written"]
        if "message" in known and known.get("converged", True):
            lines.append(known["message"])
        lines += [*(f"note: {note}" for note in notes), report.text(about)]
        bent = known.get("out_of_plane")
        return "\n".join([*lines, report.bent_text(bent)] if bent else lines)

    options.put(given, known, text)


COMMANDS = {
    "web": (_web, _web_options),
    "cover": (_cover, _cover_options),
    "optimize": (_optimize, _optimize_options),
    "measure": (_measure, _measure_options),
    "schedule": (_schedule, _schedule_options),
}
