"""Shaded scenes of nets with pyvista (the extra `view`): pictures, and live windows.

pyvista is imported when a scene is asked for, never before.  Where it or OpenGL is missing,
the error is a sentence; every figure of the project is drawn by `plot` instead, without OpenGL.
"""

import io
import os
import subprocess
import sys
import warnings
from functools import cache

import numpy as np
import PIL.Image

from . import mesh, plot

SIZE = (600, 460)  # pixels
COLOURS = plot.COLOURS | {"face": plot.PALE}
MISSING = "pyvista is not installed: install the extra `view`, pip install -e '.[view]'"
NO_OPENGL = (
    "pyvista cannot draw off screen here, {}: on Debian and Ubuntu install the packages "
    "libegl1 and libgl1-mesa-dri; inetlib.plot draws without OpenGL"
)
PROBE = (
    "from inetlib import view; pv = view.pyvista_module(); p = pv.Plotter(off_screen=True, "
    "window_size=(64, 64)); p.add_mesh(pv.Sphere(), color='black'); image = p.screenshot(); "
    "raise SystemExit(int(image.std() < 1))"
)


def pyvista_module():
    """The module, told to draw without a display where there is none; or an ImportError."""
    if headless():
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    try:
        with warnings.catch_warnings():  # in a notebook without ipywidgets
            warnings.filterwarnings("ignore", "IProgress not found")
            import pyvista
    except ImportError as error:
        raise ImportError(MISSING) from error
    return pyvista


def headless():
    """Whether there is no display here: on Linux, where DISPLAY says so."""
    return sys.platform.startswith("linux") and not os.environ.get("DISPLAY")


@cache
def available():
    """(True, a sentence) when pyvista can draw off screen here, else (False, what is missing).

    A picture is tried once, in a process of its own: where OpenGL is missing, VTK may end the
    process instead of raising an error.
    """
    try:
        pyvista_module()
        command = [sys.executable, "-c", PROBE]
        code = subprocess.run(command, capture_output=True, timeout=120).returncode
    except ImportError as error:
        return False, str(error)
    except subprocess.TimeoutExpired:
        return False, NO_OPENGL.format("a trial took more than two minutes")
    if code:
        return False, NO_OPENGL.format(f"a trial ended with the exit code {code}")
    return True, "pyvista draws off screen here"


def scene(V, Q, families=None, colours=None, width=0.0035, view=(-1.0, 0.5), live=False):
    """A `pyvista.Plotter` with the shaded faces of a net and its curves as tubes.

    V: (n, 3), Q: (f, 4).  families: a `mesh.Families` of vertex indices (k,) or points (k, 3),
    default `mesh.polylines(Q)`; of it, `_replace(d1=[], d2=[])` leaves the diagonals out.
    colours: {"face": ..., "u": ...}, where they shall differ from COLOURS.  width: of a tube,
    as a part of the bounding box's diagonal.  view: azimuth and elevation (radians) of the
    viewer; z points up.  live: for a window.  ImportError without pyvista, RuntimeError
    without OpenGL.
    """
    pyvista = pyvista_module()
    V, Q = mesh.check_arrays(V, Q)
    works, sentence = available()
    if not works:
        raise RuntimeError(sentence)
    colours = COLOURS | (colours or {})
    size = SIZE if live else [2 * k for k in SIZE]  # `picture` takes means of 2 x 2 pixels
    plotter = pyvista.Plotter(off_screen=not live, window_size=list(size))
    plotter.set_background("white")
    faces = pyvista.PolyData.from_regular_faces(V, Q)
    plotter.add_mesh(faces, color=colours["face"], ambient=0.45, diffuse=0.6)
    radius = width / 2 * np.linalg.norm(np.ptp(V, axis=0))
    families = mesh.polylines(Q) if families is None else families
    for name, lines in families._asdict().items():
        if len(lines):
            tubes = _polylines(pyvista, V, lines).tube(radius=radius, n_sides=12)
            plotter.add_mesh(tubes, color=colours[name], ambient=0.35, smooth_shading=True)
    aim(plotter.camera, V, *view)
    return plotter


def aim(camera, V, azimuth, elevation, aspect=SIZE[0] / SIZE[1]):
    """Orthographic, like `plot.camera`, and as near as the whole net allows."""
    flat, near = plot.camera(azimuth, elevation)(np.eye(3))
    axes = np.vstack([flat.T, near])  # to the right, up, towards the viewer
    low, high = (V @ axes.T).min(axis=0), (V @ axes.T).max(axis=0)
    middle = axes.T @ (low + high) / 2
    camera.parallel_projection = True
    camera.focal_point, camera.up = middle, axes[1]
    camera.position = middle + 2 * np.linalg.norm(high - low) * axes[2]
    camera.parallel_scale = 0.53 * max((high - low)[1], (high - low)[0] / aspect)


def _polylines(pyvista, V, lines):
    points = [V[line] if np.ndim(line) == 1 else line for line in lines]
    starts = np.cumsum([0, *(len(p) for p in points)])
    cells = [[len(p), *range(s, s + len(p))] for p, s in zip(points, starts, strict=False)]
    return pyvista.PolyData(np.concatenate(points), lines=np.concatenate(cells))


def picture(V, Q, families=None, colours=None, width=0.0035, view=(-1.0, 0.5)):
    """The `scene` drawn off screen: an RGB array (460, 600, 3) of bytes."""
    plotter = scene(V, Q, families, colours, width, view)
    try:
        fine = plotter.screenshot(return_img=True).astype(float)
    finally:
        plotter.close()
    return fine.reshape(SIZE[1], 2, SIZE[0], 2, 3).mean(axis=(1, 3)).round().astype(np.uint8)


def show(V, Q, families=None, colours=None, width=0.0035, view=(-1.0, 0.5), live=None):
    """The `scene` for a reader: a window to turn it by hand, or a still IPython Image.

    live: True, False, or by default True for a script with a display.  In JupyterLab see
    `explorer.turn`.
    """
    if live is None:
        live = "ipykernel" not in sys.modules and not headless()
    if live:
        return scene(V, Q, families, colours, width, view, live=True).show()
    from IPython.display import Image

    return Image(data=png(V, Q, families, colours, width, view), format="png")


def png(V, Q, families=None, colours=None, width=0.0035, view=(-1.0, 0.5)):
    """The `picture` as the bytes of a small file."""
    file, image = io.BytesIO(), picture(V, Q, families, colours, width, view)
    small = PIL.Image.fromarray(image).quantize(192, dither=PIL.Image.Dither.NONE)
    small.save(file, format="png", optimize=True)
    return file.getvalue()
