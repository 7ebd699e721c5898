"""Shaded scenes of nets with pyvista (the extra `view`), imported when one is asked for."""

import os
import subprocess
import sys
import warnings
from functools import cache
from typing import Any

import numpy as np

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


def pyvista_module() -> Any:
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


def headless() -> bool:
    """Whether there is no display here: on Linux, where DISPLAY says so."""
    return sys.platform.startswith("linux") and not os.environ.get("DISPLAY")


@cache
def available() -> tuple[bool, str]:
    """(True, a sentence) when pyvista can draw off screen here, else (False, what is missing).

    It is tried once, in a process of its own: without OpenGL, VTK may end the process."""
    try:
        pyvista_module()
        done = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, timeout=120)
    except ImportError as error:
        return False, str(error)
    except subprocess.TimeoutExpired:
        return False, NO_OPENGL.format("a trial took more than two minutes")
    if done.returncode:
        return False, NO_OPENGL.format(f"a trial ended with the exit code {done.returncode}")
    return True, "pyvista draws off screen here"


def scene(
    V: np.ndarray,
    Q: np.ndarray,
    families: mesh.Families | None = None,
    colours: dict | None = None,
    width: float = 0.0035,
    view: tuple = (-1.0, 0.5),
    live: bool = False,
) -> Any:
    """A `pyvista.Plotter` with the shaded faces of a net and its curves as tubes.

    V: (n, 3), Q: (f, 4).  families: `mesh.Families` of vertex indices (k,) or points (k, 3),
    default `mesh.polylines(Q)`.  colours: {"face": ..., "u": ...}, where they differ from
    COLOURS.  width: of a tube, as a part of the bounding box's diagonal.  view: azimuth and
    elevation (radians) of the viewer.  live: whether for a window.  ImportError without
    pyvista, RuntimeError without OpenGL."""
    pyvista = pyvista_module()
    V, Q = mesh.check_arrays(V, Q)
    if not available()[0]:
        raise RuntimeError(available()[1])
    colours = COLOURS | (colours or {})
    size = [k if live else 2 * k for k in SIZE]  # `picture` takes means of 2 x 2 pixels
    plotter = pyvista.Plotter(off_screen=not live, window_size=size)
    plotter.set_background("white")
    faces = pyvista.PolyData.from_regular_faces(V, Q)
    plotter.add_mesh(faces, color=colours["face"], ambient=0.45, diffuse=0.6)
    radius = width / 2 * np.linalg.norm(np.ptp(V, axis=0))
    for name, lines in (families or mesh.polylines(Q))._asdict().items():
        if points := [V[line] if np.ndim(line) == 1 else line for line in lines]:
            ends = np.cumsum([len(p) for p in points])
            cells = pyvista.CellArray.from_irregular_cells(np.split(np.arange(ends[-1]), ends[:-1]))
            curves = pyvista.PolyData(np.concatenate(points), lines=cells)
            tubes = curves.tube(radius=radius, n_sides=12)
            plotter.add_mesh(tubes, color=colours[name], ambient=0.35, smooth_shading=True)
    aim(plotter.camera, V, view)
    return plotter


def aim(camera: Any, V: np.ndarray, view: tuple, aspect: float = SIZE[0] / SIZE[1]) -> None:
    """Orthographic, like `plot.camera`, and as near as the whole net allows."""
    flat, near = plot.camera(*view)(np.eye(3))
    axes = np.vstack([flat.T, near])  # to the right, up, towards the viewer
    low, high = (V @ axes.T).min(axis=0), (V @ axes.T).max(axis=0)
    middle = axes.T @ (low + high) / 2
    camera.parallel_projection = True
    camera.focal_point, camera.up = middle, axes[1]
    camera.position = middle + 2 * np.linalg.norm(high - low) * axes[2]
    camera.parallel_scale = 0.53 * max((high - low)[1], (high - low)[0] / aspect)


def picture(plotter: Any) -> np.ndarray:
    """A `scene` drawn off screen, and closed: an RGB array (460, 600, 3) of bytes."""
    try:
        fine = plotter.screenshot(return_img=True).astype(float)
    finally:
        plotter.close()
    return fine.reshape(SIZE[1], 2, SIZE[0], 2, 3).mean(axis=(1, 3)).round().astype(np.uint8)
