"""The net as a pyvista scene that the browser draws: no OpenGL is needed where Python runs."""

import numpy as np

from .. import plot, view
from . import look
from .behind import Behind

STRETCH = 1.8  # a net that grew or shrank more than this is fitted into the view again
FAR = 20  # sizes from the origin: such a net is drawn about its own middle
VIEWS = {"plane": (-90.0, 90.0)}  # azimuth and elevation of the viewer, degrees
VIEWS |= dict.fromkeys(("isothermal", "revolution"), (-50.0, 25.0))
VIEWS |= dict.fromkeys(("freeform", "cover"), (-60.0, 40.0))


class Scene:
    """A plotter with the faces and the curves of a net; only what changes is sent to a browser."""

    def __init__(self):
        pyvista = view.pyvista_module()
        self.plotter = pyvista.Plotter(off_screen=True, lighting=None)
        self.plotter.add_light(pyvista.Light(light_type="headlight"))
        self.faces, self.curves = pyvista.PolyData(), pyvista.PolyData()
        self.behind = Behind(self.plotter)
        self.clear()
        colours = {"scalars": "rgb", "rgb": True}
        solid = self.plotter.add_mesh(self.faces, ambient=0.35, diffuse=0.7, **colours)
        solid.mapper.SetResolveCoincidentTopologyToPolygonOffset()  # curves lie in front
        # Never hidden: what a browser has not seen yet would get other colours there.
        self.actor = self.plotter.add_mesh(self.curves, lighting=False, **colours)
        for actor in (solid, self.actor):  # no table of colours need travel
            actor.mapper.lookup_table = pyvista.LookupTable(n_values=2)

    def clear(self):
        """Hold nothing that can be seen: one point."""
        self._known = self._layout = None
        self.behind.clear()
        self.origin = np.zeros(3)  # of the scene: float32 has no digits to spare far away
        self.faces.points = self.curves.points = np.zeros((1, 3), np.float32)
        self._cells([3, 0, 0, 0], [2, 0, 0], *np.zeros((2, 1, 3), np.uint8))

    def _cells(self, faces, lines, fills, rgb):
        """Take new cells and their colours; the old colours do not fit them."""
        self.faces.cell_data.clear()
        self.curves.cell_data.clear()
        self.faces.faces, self.curves.lines = faces, lines
        self.faces.cell_data["rgb"], self.curves.cell_data["rgb"] = fills, np.uint8(rgb)

    def show(self, V, Q, choice, dark=False, shade=None, cover=None):
        """Put a net into the scene; shade: RGB bytes a quad, (f, 3), or None; cover: of `look`."""
        palette, cut = look.DARK if dark else look.LIGHT, cover and [*map(bytes, cover.polygons)]
        known = choice.families, choice.parallelograms, dark, shade is None, Q.tobytes(), cut
        many = look.crowd(len(Q), choice.theta, choice.theta0)
        known += (look.line_width(many),)
        new, self._known = known != self._known, known
        if new:
            self._layout = look.layout(Q, len(V), choice.families, choice.parallelograms, cover)
            low, high = np.min(V, axis=0), np.max(V, axis=0)
            far = np.abs(low + high).max() > FAR * np.abs(high - low).max()
            self.origin = (low + high) / 2 if far else np.zeros(3)
        plan = self._layout
        points = np.asarray(V - self.origin, np.float32)
        self.faces.points = self.curves.points = look.points(points, plan)
        fills = look.fills(plan, palette, shade)
        if new:
            cells = plan.quads, plan.triangles, plan.cut
            lines = plan.lines or {"none": np.zeros((1, 2), dtype=np.int64)}
            found = [palette.families.get(name, palette.face) for name in lines]
            colours = [look.ink(colour, palette.face, many) for colour in found]
            rgb = np.repeat(np.round(255 * np.array(colours)), [*map(len, lines.values())], axis=0)
            pairs = _counted(np.concatenate(list(lines.values())))
            self._cells(np.concatenate([*map(_counted, cells)]), pairs, fills, rgb)
            self.actor.prop.line_width = look.line_width(many)
            self.plotter.set_background(palette.background)
        elif shade is not None:
            self.faces.cell_data["rgb"] = fills

    def camera(self, V, azimuth, elevation, aspect=1.0):
        """The camera (for vtk.js) that sees all of V, angles in degrees, aspect: width / height."""
        view.aim(
            self.plotter.camera, V - self.origin, tuple(np.radians([azimuth, elevation])), aspect
        )
        return self.plotter.camera

    def place(self, azimuth, elevation, roll, scale, *middle):
        """A camera (for vtk.js) from a link, angles in degrees: the viewer's direction, how far
        the view is turned about it; half the height seen; the point in the middle."""
        flat, near = plot.camera(*np.radians([azimuth, elevation]))(np.eye(3))
        right, up = flat.T
        turned, camera = np.radians(roll), self.plotter.camera
        camera.parallel_projection, camera.parallel_scale = True, scale
        camera.focal_point, camera.position = middle, np.array(middle) + 4 * scale * near
        camera.up = np.cos(turned) * up + np.sin(turned) * right
        return camera


def sight(kind: str, V: np.ndarray | None) -> tuple:
    """From where a net is seen by default: azimuth and elevation in degrees."""
    return VIEWS[kind if V is None or V[:, 2].any() else "plane"]


def is_lost(V: np.ndarray, before: np.ndarray) -> bool:
    """Whether a net V is far off the place and size of the one that was fitted into the view."""
    middle, old = ((W.min(axis=0) + W.max(axis=0)) / 2 for W in (V, before))
    size, reach = (np.abs(W - W.mean(axis=0)).max() for W in (V, before))
    return np.abs(middle - old).max() > reach / 2 or not 1 / STRETCH < size / reach < STRETCH


def _counted(cells):
    """Cells of one size (k, s) as VTK wants them: the size before each."""
    return np.insert(cells, 0, cells.shape[1], axis=1).ravel()


_free: list[Scene] = []  # scenes of tabs that were closed


def borrow() -> Scene:
    """A `Scene`, for `give_back` when it is no longer needed.

    VTK objects that trame has sent to a browser call Python when they are destroyed, and end the
    process where the garbage collector finds them.  So none ever is: the next tab takes it."""
    return _free.pop() if _free else Scene()


def give_back(scene: Scene) -> None:
    """Keep a borrowed scene for the next tab."""
    scene.clear()
    _free.append(scene)
