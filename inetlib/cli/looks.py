"""Commands to look with: what there is to try, a picture or a page of a net, the explorer."""

import argparse
import inspect
import json
import re
import webbrowser
from pathlib import Path

from .. import files
from . import options

PICTURES = ".png", ".svg"
FAMILIES = "u", "v", "d1", "d2"
ROUND, TOP = (-52.0, 26.0), (-90.0, 90.0)  # azimuth and elevation of pictures, degrees


def _examples(given):
    from .. import examples, surfaces
    from ..explorer import choices

    makers = {"surfaces": examples.SURFACES, "profiles": surfaces.PROFILES}
    known = {key: {name: _first(f) for name, f in x.items()} for key, x in makers.items()}
    known["explorer"] = {key: choices.OPTIONS[key] for key in ("kind", "map", "surface")}

    def text():
        uses = {
            "surfaces": "of triangles, for inet cover, explore and show",
            "profiles": "meridians of surfaces of revolution, for inet web --profile",
            "explorer": "what inet explore and explorer.show know, as kind=, map= and surface=",
        }
        lines = []
        for key, words in uses.items():
            groups = known[key] if key == "explorer" else {"": known[key]}
            lines.append(f"{key}: {words}")
            for group, names in groups.items():
                lines += [f"  {group}" * bool(group)] * bool(group)
                lines += [f"  {'  ' * bool(group)}{name:16}{x}" for name, x in names.items()]
        return "\n".join(lines)

    options.put(given, known, text)


def _first(function):
    """What an example is: the beginning of its docstring, without its parameters."""
    words = inspect.getdoc(getattr(function, "func", function)).splitlines()[0].rstrip(".")
    return re.split(r",?[:;]|,? (?:about|in|by its|by the|by latitude) ", words)[0]


def _serve_options(command):
    add = command.add_argument
    text = "of the address (8765, or the next that is free)"
    add("--port", type=options.port, metavar="N", help=text)
    text = "127.0.0.1 or localhost, and nothing else: only this machine can open the page"
    add("--host", type=options.host, help=text)
    add("--open", action="store_true", help="open the page in a browser")


def _explore_options(command):
    text = "a surface to cover, a file or an example, as for `inet cover`"
    command.add_argument("surface", nargs="?", help=text)
    _serve_options(command)
    command.add_argument("--json", action="store_true", help="the address as a JSON object")


def _explore(given):
    from .. import examples, io, repair

    if not given.surface:
        return _serve(given, None, None)
    if given.surface in examples.SURFACES:
        return _serve(given, None, None, f"?kind=cover&source={given.surface}")
    surface = options.surface(given)
    with io.named(given.surface, surface.V, counted=False):
        repair.clean(surface.V, surface.F)  # refuses what cannot be covered
    return _serve(given, surface, given.surface)


def _serve(given, surface, path, query="", **more):
    from ..explorer import notebook

    def ready(address):
        address += query
        line = f"Isogonal nets: {address} (Ctrl-C ends it)"
        print(json.dumps({"address": address}) if given.json else line, flush=True)
        if given.open:
            webbrowser.open(address)

    try:
        notebook.server().serve(surface, path, given.port, ready, **more)
    except OSError as error:
        words = "leave --port out, or take another one"
        raise ValueError(f"the port {given.port} cannot be opened, {words}: {error}") from error


def _families(text):
    """An argparse type: names of families of curves."""
    names = [] if text == "none" else text.split(",")
    if set(names) <= {*FAMILIES}:
        return tuple(names)
    known = ", ".join(FAMILIES)
    raise argparse.ArgumentTypeError(f"{text} is given, some of {known}, or none, are wanted")


def _show_options(command):
    from ..examples import SURFACES

    add = command.add_argument
    text = f"a net or a surface: a file, or one of the examples {', '.join(SURFACES)}"
    add("surface", metavar="file", help=text)
    text = "a picture, .png or .svg, drawn without OpenGL; without it a page for the browser"
    add("-o", "--output", metavar="FILE", help=text)
    add("--force", action="store_true", help="replace the picture if it is there")
    text = "curves of a net in the picture: some of u,v,d1,d2, or none (u,v)"
    add("--families", type=_families, default=("u", "v"), metavar="NAMES", help=text)
    text = "the inscribed parallelograms of a net in the picture"
    add("--parallelograms", action="store_true", help=text)
    usual = ",".join(f"{x:g}" for x in ROUND)
    text = f"of the picture: degrees around the z-axis and above the xy-plane ({usual})"
    add("--view", type=options.direction, metavar="AZIMUTH,ELEVATION", help=text)
    _serve_options(command)
    options.say(command)


def _show(given):
    if given.output is not None:
        path = Path(given.output)
        if path.suffix.lower() not in PICTURES:
            raise ValueError(f"{path}: a picture is written, its name ends with .png or .svg")
        files.check_place(path, given.force)
    V, F, polygons, notes = _read(given)
    if given.output is None:
        if F.shape[1] == 4:
            return _serve(given, None, given.surface, net=(V, F, polygons))
        try:
            return _explore(given)
        except ValueError as error:
            words = "with -o FILE.png it is drawn as it is"
            raise ValueError(f"{error} ({words})") from error
    with options.stage(given, "drawing"), files.replacing(path) as new:
        new.write_bytes(_picture(given, V, F, polygons))
    counts = {"vertices": len(V), "faces": len(F) + len(polygons)}
    known = {"file": given.output, **counts, "notes": notes}
    lines = f"{given.output}", f"{counts['vertices']} vertices, {counts['faces']} faces"
    options.put(given, known, lambda: "\n".join([*lines, *(f"note: {x}" for x in notes)]))


def _read(given):
    """(V, quads or triangles, polygons, notes) of a net or a surface."""
    from .. import examples, io, mesh, repair

    if given.surface in examples.SURFACES or not Path(given.surface).suffix:
        return *options.surface(given)[:2], [], []
    with options.stage(given, f"reading {given.surface}"):
        V, F = io.read(given.surface)
    if all(len(face) != 4 for face in F):  # as it is, whether or not it can be covered
        with io.named(given.surface, V):
            return V, repair.triangulate(V, F), [], []
    V, Q, polygons = io.net(given.surface)
    try:
        return V, mesh.label(Q), polygons, []
    except ValueError as reason:
        return V, Q, polygons, [f"{reason}; u and v are as in the file"]


def _picture(given, V, F, polygons):
    """The bytes of a picture of a net (quads), or of a surface with its boundary (triangles)."""
    import numpy as np

    from .. import mesh, plot
    from ..explorer import choices, look

    flat = np.ptp(V, axis=0)[2] < 1e-6 * np.ptp(V, axis=0).max()
    camera = plot.camera(*np.radians(given.view or (TOP if flat else ROUND)))
    form = Path(given.output).suffix[1:].lower()
    if F.shape[1] == 3:
        sides = np.sort(np.stack(mesh.half_edges(F), axis=1), axis=1)
        rims, times = np.unique(sides, axis=0, return_counts=True)
        lines = [(V[rim], look.LIGHT.families["rim"], 1.2) for rim in rims[times != 2]]
        return look.drawn([(V, F, look.LIGHT.face)], lines, camera, form)
    cover = look.with_panels(V, F, polygons)
    choice = choices.Choice(families=given.families, parallelograms=given.parallelograms)
    return look.picture(V, F, choice, None, camera, form, cover)


COMMANDS = {
    "examples": (_examples, options.say),
    "show": (_show, _show_options),
    "explore": (_explore, _explore_options),
}
