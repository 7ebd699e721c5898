"""Twelve nets worth a poster, of different constructions: figures/gallery/NAME.png.

    python tools/gallery.py              all of them
    python tools/gallery.py vase coil    these

Each is made by the lines of one function below.  gallery.json has what a page needs: titles,
sentences, these lines with their imports, and the numbers that `measure` finds.  What shows the
same as before is kept, as with the figures.  `make figures` calls this script, too."""

import argparse
import inspect
import io
import json
import os
import re
import sys
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import PIL.Image
from matplotlib.colors import to_rgb
from scipy.special import ellipj

import inetlib
from inetlib import (
    conformal,
    design,
    developable,
    examples,
    files,
    loxodrome,
    measure,
    mesh,
    moebius,
    planar,
    plot,
    reference,
    repair,
    solver,
    surfaces,
)
from inetlib.drawings import same
from inetlib.start import finished, listen

FOLDER = Path(__file__).resolve().parent.parent / "figures" / "gallery"
SIZE, DPI, ROOM = 5.4, 200, 0.94  # inches of a square, dots per inch, its part that a net takes
PIXELS = 1300  # of the longer side of a net, before it is put on paper
MOST, SHADES, DARKEST = 130_000, (24, 16, 12, 9), 0.35  # bytes; of each colour; the least bright
ROOMS = {*inetlib.__all__, "plot"}
EXACT = 1e-6  # degrees: below is rounding
BLUE, TEAL, VIOLET = "#7497cf", "#67aaa9", "#958fcb"  # of parallelograms
LIGHT, EDGE = "#f6f7fa", "#1d3557"


def vase():
    """A web of loxodromes and parallels on a vase, exact, found row by row."""
    theta, theta0 = np.radians([75, 60])
    radii = 0.42, 0.8, 0.98, 0.78, 0.4, 0.36, 0.6
    heights = 0, 0.5, 1.05, 1.7, 2.3, 2.75, 3.15
    profile = surfaces.spline_profile(np.transpose([radii, heights]))
    net = loxodrome.web(profile, theta, theta0, 44)
    return net.V, net.Q, (theta, theta0)


def globe():
    """Loxodromes wind around a sphere towards both poles, in an exact web with the parallels."""
    theta, theta0 = np.radians([70, 45])
    net = loxodrome.web(surfaces.sphere_profile(1, -1.52, 1.52), theta, theta0, 36)
    return net.V, net.Q, (theta, theta0)


def cyclide():
    """A closed web of a torus, inverted to a Dupin cyclide, which the solver makes exact."""
    net = loxodrome.torus_web(2, 0.9, 57, 47, 20)
    V = moebius.apply(moebius.inversion((6, 0, 0), 4), net.V)
    found = solver.optimize(V, net.Q, net.theta, net.theta0, via="jump", shape_steps=0)
    return found.V, net.Q, (net.theta, net.theta0)


def galaxy():
    """The hyperbolic cosine of a plane grid: spirals between two ellipses, exact at once."""
    theta, theta0 = np.radians([75, 50])
    z = conformal.sheared_grid(theta, theta0, 60, 21, 2.05, np.pi / 30, 1j, kappa=1)
    V, Q = conformal.quads(np.cosh(z))
    return V, Q, (theta, theta0)


def star():
    """Rings of quads around an octagon in the plane: one linear system makes them exact."""
    theta, theta0 = np.radians([70, 50])
    V, Q = mesh.polygon_rings(8, 12)[:2]
    net = planar.planar_net(Q, theta, theta0, start=V, smooth=0.3)
    return net.V, Q, (theta, theta0)


def scroll():
    """A sheet with a plane grid, rolled up along a spiral; the solver makes it exact."""
    theta, theta0 = np.radians([75, 60])
    rate = 0.16 + 1j  # of the spiral exp(rate t), whose derivatives are multiples of it
    curve = developable.arc_length(lambda t, k=0: plot.plane(rate**k * np.exp(rate * t)), 0, 9)
    z = conformal.sheared_grid(theta, theta0, 90, 24, 0, curve.length / 100)
    V, Q = developable.cylinder(z, curve).reshape(-1, 3), mesh.grid_quads(90, 24)
    found = solver.optimize(V, Q, theta, theta0, via="jump", shape_steps=0)
    return found.V, Q, (theta, theta0)


def band():
    """A Moebius band with a round boundary, from a minimal surface of the 3-sphere, sampled."""
    theta, theta0 = np.radians([75, 90])  # where it closes theta0 becomes its supplement
    z = conformal.sheared_grid(theta, theta0, 64, 32, 0, np.pi / 64)
    x, (sn, cn, *_) = z.real, ellipj(2 * (z.imag - z.imag.mean()), 0.75)
    a, b, c, d = np.cos(2 * x) * cn, np.sin(2 * x) * cn, np.cos(x) * sn, np.sin(x) * sn
    V = np.stack([(a + c) / np.sqrt(2), b, d]) / (1 - (c - a) / np.sqrt(2))  # stereographic
    return V.reshape(3, -1).T, mesh.grid_quads(64, 32), (theta, theta0)


def coil():
    """A tube that climbs around its axis, a helical surface in isothermal parameters, sampled."""
    theta, theta0 = np.radians([75, 60])
    surface, height = surfaces.helical_isothermal(surfaces.torus_profile(1, 0.42), 0.19)
    z = conformal.sheared_grid(theta, theta0, 100, 22)
    z *= height / z.imag.max()
    V = surface.point(z.real, z.imag).reshape(-1, 3)
    return V, mesh.grid_quads(100, 22), (theta, theta0)


def minimal():
    """A minimal surface of Enneper's kind with three lobes, in polar coordinates, sampled."""
    theta, theta0 = np.radians([75, 60])
    z = np.exp(conformal.sheared_grid(theta, theta0, 96, 26, 0.15, np.pi / 48, 1j))
    V = np.stack([(z - z**5 / 5).real, (z + z**5 / 5).imag, (2 * z**3 / 3).real])
    return V.reshape(3, -1).T, mesh.grid_quads(96, 26), (theta, theta0)


def roof():
    """A freeform roof, on which every isogonal net has to be found: by the solver, exact."""
    theta, theta0 = np.radians([70, 55])
    V, Q = surfaces.freeform_patch(42, 30)
    found = solver.optimize(V, Q, theta, theta0, reference=reference.mesh(V, Q))
    return found.V, Q, (theta, theta0)


def saddle():
    """A triangle mesh with a hole, covered by a net that closes around it, exact."""
    theta, theta0 = np.radians([75, 55])
    net = design.cover(*examples.saddle_with_hole(), theta, theta0, 2000, boundary="plain")
    return net.V, net.Q, (theta, theta0)


def dome():
    """Rings of quads around a hexagon, over a dome with six waves; the solver makes them exact."""
    theta, theta0 = np.radians([60, 45])
    V, Q, hexagon = mesh.polygon_rings(6, 14)
    z = (V[:, 0] + 1j * V[:, 1]) / np.hypot(V[:, 0], V[:, 1]).max()
    V = np.stack([z.real, z.imag, 0.5 * (1 - abs(z) ** 2) + 0.12 * (z**6).real], axis=1)
    found = solver.optimize(V, Q, theta, theta0, reference=reference.mesh(V, Q), polygons=[hexagon])
    return found.V, Q, (theta, theta0)


class Look(NamedTuple):
    """How a net is shown."""

    title: str
    azimuth: float  # of the camera, degrees
    elevation: float
    tint: str  # of its parallelograms
    every: int = 0  # how many v-curves to the next that is drawn; 0: none is


NETS = {
    vase: Look("Vase", 40, 17, BLUE, 4),
    star: Look("Star", -90, 90, VIOLET),
    cyclide: Look("Dupin cyclide", 75, 52, TEAL),
    minimal: Look("Three lobes", 90, -20, VIOLET),
    globe: Look("Globe", 20, 38, BLUE, 4),
    scroll: Look("Scroll", -60, 22, TEAL, 10),
    band: Look("Moebius band", -60, 30, BLUE, 8),
    roof: Look("Roof", -110, 40, BLUE, 6),
    galaxy: Look("Galaxy", -90, 58, VIOLET, 5),
    coil: Look("Coil", 30, 24, TEAL),
    saddle: Look("Saddle", -70, 32, VIOLET),
    dome: Look("Dome", -75, 48, TEAL),
}


def main(arguments=None):
    """Draw the nets of these names, or all; exit code 0 when there are such."""
    parser = argparse.ArgumentParser(description="Draw the gallery.")
    parser.add_argument("names", nargs="*", help="of nets; none: all")
    names = parser.parse_args(arguments).names
    nets = {net.__name__: net for net in NETS}
    if unknown := set(names) - set(nets):
        print(f"gallery: no net {sorted(unknown)}: there are {', '.join(nets)}", file=sys.stderr)
        return 2
    FOLDER.mkdir(exist_ok=True)
    for name in names or nets:
        V, Q, angles = nets[name]()
        entry = facts(nets[name], V, Q, angles)
        fate = "written" if save(name, picture(V, Q, NETS[nets[name]]), entry) else "kept"
        print(f"{name:10} {entry['quads']:5} quads {entry['deviation_deg']:12.7f}  {fate}")
    return 0


def facts(net, V, Q, angles) -> dict:
    """What gallery.json says of a net: words, its lines, and numbers by `measure`, rounded."""
    off, quality = np.degrees(measure.deviations(V, Q, *angles).max()), measure.quality(V, Q)
    theta, theta0 = (round(float(np.degrees(angle)), 6) for angle in angles)
    lines = inspect.getsource(net)
    return {
        "title": NETS[net].title,
        "sentence": inspect.getdoc(net),
        "theta_deg": theta,
        "theta0_deg": theta0,
        "quads": len(Q),
        "exact": bool(off < EXACT),
        "deviation_deg": round(float(off), 7),  # the largest of both angles, over all faces
        "flips": quality.flips,
        "darts": quality.darts,
        "imports": imports(lines),
        "lines": lines,
    }


def imports(lines) -> str:
    """What has to be imported before these lines, as lines."""
    found = {word for word in re.findall(r"\b(\w+)\.\w", lines) if word in ROOMS}
    extern = ["import numpy as np"] + ["from scipy.special import ellipj"] * ("ellipj(" in lines)
    return "\n".join([*extern, "", f"from inetlib import {', '.join(sorted(found))}", ""])


def picture(V, Q, look) -> bytes:
    """The PNG of a net: parallelograms, boundaries, some v-curves; small polygons are filled."""
    plot.use_style()
    figure = plt.figure(figsize=(SIZE, SIZE), layout="none")
    ax = figure.add_axes((0, 0, 1, 1), aspect="equal")
    ax.set_axis_off()
    lines = [(V[line], EDGE, 0.9) for line in rims(V, Q)]
    if look.every:
        curves = mesh.polylines(Q).v[:: look.every]
        lines += [(V[line], plot.COLOURS["v"], 0.9) for line in curves]
    layers = [tiles(V, Q, look.tint)]
    layers += [(*fan(V[rim[:-1]]), plot.SINGULAR) for rim in rims(V, Q) if len(rim) < 10]
    view = plot.camera(*np.radians([look.azimuth, look.elevation]))
    left, right, bottom, top = plot.scene(ax, view, layers, lines, PIXELS).extent
    half = max(right - left, top - bottom) / ROOM / 2
    ax.set_xlim((left + right) / 2 - half, (left + right) / 2 + half)
    ax.set_ylim((bottom + top) / 2 - half, (bottom + top) / 2 + half)
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png", dpi=DPI, metadata={"Software": None})
    plt.close(figure)
    return inked(drawn.getvalue(), look.tint)


def inked(png, tint) -> bytes:
    """The picture in shades of its own colours only, as many as `MOST` bytes allow."""
    image = PIL.Image.open(io.BytesIO(png)).convert("RGB")
    light, dark = np.array(to_rgb(LIGHT)), np.array(to_rgb(tint))
    others = np.array([to_rgb(c) for c in ("white", EDGE, plot.COLOURS["v"], plot.SINGULAR)])
    for shades in SHADES:
        bright = np.linspace(DARKEST, 1, shades)[:, None]
        inks = [light * bright, (light + dark) / 2 * bright, dark * bright, others]
        palette, out = PIL.Image.new("P", (1, 1)), io.BytesIO()
        palette.putpalette(np.round(255 * np.concatenate(inks)).astype(np.uint8).tobytes())
        few = image.quantize(palette=palette, dither=PIL.Image.Dither.NONE)
        few.save(out, "png", optimize=True)
        if out.tell() <= MOST:
            break
    return out.getvalue()


def tiles(V, Q, tint):
    """The quads as a layer of `plot.scene`: parallelograms of this tint, with light corners."""
    middles, black = mesh.checkerboard(V, Q)[:2]
    black = black + len(V)
    light = [np.stack([Q[:, k], black[:, k], black[:, k - 1]], axis=1) for k in range(4)]
    T = np.concatenate([black[:, [0, 1, 2]], black[:, [0, 2, 3]], *light])
    colours = np.repeat([to_rgb(tint), to_rgb(LIGHT)], [2 * len(Q), 4 * len(Q)], axis=0)
    return np.concatenate([V, middles]), T, colours


def rims(V, Q):
    """The boundary as curves of vertex numbers; where a net meets itself is none."""
    Q = repair.merge(V, Q.ravel(), repair.NEAR)[0].reshape(Q.shape)
    edges = np.sort(np.stack(mesh.half_edges(Q), axis=1), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    return mesh.chains(edges[count == 1])


def fan(corners):
    """A polygon as triangles around its middle: (V, F)."""
    k = np.arange(len(corners))
    F = np.stack([np.full(len(k), len(k)), k, np.roll(k, -1)], axis=1)
    return np.vstack([corners, corners.mean(axis=0)]), F


def read() -> dict:
    """What is in gallery.json, {name: facts}; empty when it is missing or broken."""
    try:
        return {} | json.loads((FOLDER / "gallery.json").read_text(encoding="utf-8"))
    except (OSError, TypeError, ValueError):
        return {}


def save(name, png, entry) -> bool:
    """Write the picture of a net and its entry, unless both say the same as those on file."""
    path, found = FOLDER / f"{name}.png", read()
    with suppress(OSError):  # there is no picture, or a broken one
        alike = same.picture(path.read_bytes(), png, *same.FEW)
        if alike and same.claims(found.get(name), entry):
            return False
    found[name] = entry
    entries = {net.__name__: found[net.__name__] for net in NETS if net.__name__ in found}
    with files.scratch(FOLDER) as new:
        (new / path.name).write_bytes(png)
        text = json.dumps(entries, indent=2, allow_nan=False) + "\n"
        (new / "gallery.json").write_text(text, encoding="utf-8", newline="\n")
        for file in (path.name, "gallery.json"):  # it vouches for the picture
            os.replace(new / file, FOLDER / file)
    return True


if __name__ == "__main__":
    listen(lambda: "gallery: stopped, pictures that were not finished are as they were")
    code = main()
    finished()
    sys.exit(code)
