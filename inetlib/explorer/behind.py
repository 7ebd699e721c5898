"""What is seen with a net: the surface that it covers, and another net kept as a ghost."""

from typing import Any

import numpy as np

from .. import mesh, view
from . import look

MOST = 50_000  # triangles of the surface that a browser is given
BINS = 100  # a side of the bounding box, for larger surfaces


def few(V: np.ndarray, F: np.ndarray) -> Any:
    """A surface as smooth triangles, `pyvista.PolyData`: as it is, or of some `MOST` at most."""
    pyvista = view.pyvista_module()
    from vtkmodules.vtkFiltersCore import vtkBinnedDecimation

    V, F = mesh.triangles(V, F)
    data = pyvista.PolyData.from_regular_faces(V, F)
    if len(F) > MOST:
        coarse = vtkBinnedDecimation()
        coarse.SetInputData(data)
        coarse.SetNumberOfDivisions(BINS, BINS, BINS)
        coarse.Update()
        data = pyvista.wrap(coarse.GetOutput())
    return data.compute_normals(cell_normals=False, split_vertices=False)


class Behind:
    """Two meshes of a plotter beside the net, each of nothing where there is none."""

    def __init__(self, plotter: Any):
        pyvista = view.pyvista_module()
        self.surface, self.ghost = pyvista.PolyData(), pyvista.PolyData()
        self.clear()
        about = {"ambient": 0.4, "diffuse": 0.6, "smooth_shading": False}
        self.pale = plotter.add_mesh(self.surface, **about)
        self.lines = plotter.add_mesh(self.ghost, lighting=False, line_width=1)

    def clear(self) -> None:
        """Hold nothing that can be seen: one point."""
        self._known = None
        for data in (self.surface, self.ghost):
            data.clear_data()
            data.points = np.zeros((1, 3), np.float32)
        self.surface.faces, self.ghost.lines = [3, 0, 0, 0], [2, 0, 0]

    def show(self, surface: Any, ghost: Any, origin: np.ndarray, palette: look.Palette) -> None:
        """surface: of `few`; ghost: V, Q; each None for none.  origin: of the scene."""
        known = surface, ghost, origin.tobytes(), palette
        if self._known is not None and all(
            a is b or (k > 1 and a == b)
            for k, (a, b) in enumerate(zip(known, self._known, strict=True))
        ):
            return
        self.clear()
        self._known = known
        # Whatever is translucent makes a browser draw all in several passes.
        self.pale.prop.opacity = 1.0 if surface is None else look.OPACITY
        self.pale.prop.color, self.lines.prop.color = palette.cut, palette.families["rim"]
        if surface is not None:
            self.surface.points = np.asarray(surface.points - origin, np.float32)
            self.surface.faces = surface.faces
            self.surface.point_data.active_normals = surface.point_data["Normals"]
        if ghost is not None:
            V, Q = ghost
            plan = look.layout(Q, len(V), ("u", "v"))
            self.ghost.points = np.asarray(V - origin, np.float32)
            pairs = np.concatenate(list(plan.lines.values()))
            self.ghost.lines = np.insert(pairs, 0, 2, axis=1).ravel()
