"""Twelve nets of different constructions, each by a few lines: figures/gallery/NAME.png.

    python tools/gallery.py              all of them
    python tools/gallery.py vase coil    these
"""

import numpy as np

from inetlib import (
    conformal, design, developable, examples, loxodrome, measure, mesh, moebius, planar, reference,
    solver, surfaces,
)  # fmt: skip


def vase():
    """A web of loxodromes and parallels on a vase, exact row by row."""
    points = [(0.42, 0), (0.8, 0.5), (0.98, 1.05), (0.78, 1.7), (0.4, 2.3), (0.36, 2.75), (0.6, 3.15)]
    theta, theta0 = np.radians([75, 60])
    net = loxodrome.web(surfaces.spline_profile(points), theta, theta0, 44)
    return net.V, net.Q, (theta, theta0)


def globe():
    """Loxodromes that wind up to both poles of a sphere, exact."""
    theta, theta0 = np.radians([70, 45])
    net = loxodrome.web(surfaces.sphere_profile(1, -1.4, 1.4), theta, theta0, 40)
    return net.V, net.Q, (theta, theta0)


def cyclide():
    """A closed web of a torus, turned into a Dupin cyclide by an inversion and made exact."""
    theta, theta0 = np.radians([70, 55])
    m, n, shift, *_ = loxodrome.closings(2, 0.9, theta, theta0, 60)[0]
    net = loxodrome.torus_web(2, 0.9, m, n, shift)
    V = moebius.apply(moebius.inversion((4.6, 0, 0), 2), net.V)
    found = solver.optimize(V, net.Q, theta, theta0, via="jump", shape_steps=0)
    return found.V, net.Q, (theta, theta0)


def galaxy():
    """The hyperbolic cosine of a grid: spirals around an ellipse, exact at every size."""
    theta, theta0 = np.radians([75, 50])
    z = conformal.sheared_grid(theta, theta0, 72, 21, 2.05, np.pi / 36, 1j, kappa=1)
    V, Q = conformal.quads(np.cosh(z))
    return V, Q, (theta, theta0)


def star():
    """Twelve rings of quads around an octagon fill a star, by one linear system."""
    theta, theta0 = np.radians([70, 50])
    V, Q, _ = mesh.polygon_rings(8, 12)
    net = planar.planar_net(Q, theta, theta0, start=V)
    return net.V, Q, (theta, theta0)


def scroll():
    """A plane grid rolled along a logarithmic spiral, its chords made exact afterwards."""
    theta, theta0 = np.radians([75, 60])
    rate = 0.16 + 1j

    def spiral(t, k=0):
        z = rate**k * np.exp(rate * t)
        return np.stack([z.real, z.imag], axis=-1)

    curve = developable.arc_length(spiral, 0, 9)
    z = conformal.sheared_grid(theta, theta0, 90, 24, 0, curve.length / 100)
    V, Q = developable.cylinder(z, curve).reshape(-1, 3), mesh.grid_quads(90, 24)
    return V, Q, (theta, theta0)


def band():
    """The Moebius band with a round boundary: a minimal surface of the 3-sphere, sampled."""
    from scipy.special import ellipj
    theta, theta0 = np.radians([75, 90])
    z = conformal.sheared_grid(theta, theta0, 80, 40, 0, np.pi/80)
    w = 2*(z.imag - z.imag.mean())
    sn, cn = ellipj(w, 0.75)[:2]
    X = np.stack([np.cos(2*z.real)*cn, np.sin(2*z.real)*cn, np.cos(z.real)*sn, np.sin(z.real)*sn])
    pole, side = (X[2] - X[0]) / np.sqrt(2), (X[0] + X[2]) / np.sqrt(2)
    V = (np.stack([side, X[1], X[3]]) / (1 - pole)).reshape(3, -1).T
    return V, mesh.grid_quads(80, 40), (theta, theta0)


def coil():
    """A tube that climbs around an axis, a helical surface in isothermal parameters, sampled."""
    theta, theta0 = np.radians([75, 60])
    tube = surfaces.torus_profile(1, 0.42, -np.pi, np.pi)
    surface, height = surfaces.helical_isothermal(tube, 0.19)
    z = conformal.sheared_grid(theta, theta0, 150, 22)
    z *= height / z.imag.max()
    V = surface.point(z.real, z.imag).reshape(-1, 3)
    return V, mesh.grid_quads(150, 22), (theta, theta0)


def minimal():
    """Half way from the catenoid to the helicoid, a minimal surface, sampled."""
    theta, theta0 = np.radians([70, 60])
    z = conformal.sheared_grid(theta, theta0, 100, 24, 0, 4*np.pi/100)
    V = surfaces.conjugate(np.pi / 4).point(z.real, z.imag - z.imag.mean()).reshape(-1, 3)
    return V, mesh.grid_quads(100, 24), (theta, theta0)


def enneper():
    """Enneper's minimal surface, sampled and made exact."""
    theta, theta0 = np.radians([75, 60])
    z = conformal.sheared_grid(theta, theta0, 36, 36, 0, 1)
    z = (z - z.mean()) * 1.9 / np.abs(z - z.mean()).max()
    V = np.stack([(z - z**3/3).real, (-1j*(z + z**3/3)).real, (z**2).real]).reshape(3, -1).T
    Q = mesh.grid_quads(36, 36)
    found = solver.optimize(V, Q, theta, theta0, via="jump", shape_steps=0)
    return found.V, Q, (theta, theta0)


def roof():
    """A freeform roof, where every net has to be found: by the solver."""
    theta, theta0 = np.radians([70, 55])
    V, Q = surfaces.freeform_patch(36, 30)
    found = solver.optimize(V, Q, theta, theta0, reference=reference.mesh(V, Q))
    return found.V, Q, (theta, theta0)


def saddle():
    """A ring of triangles covered by a net that closes around the hole."""
    theta, theta0 = np.radians([75, 55])
    net = design.cover(*examples.saddle_with_hole(), theta, theta0, 2200)
    return net.V, net.Q, (theta, theta0)


def shell():
    """A hanging cloth, upside down, covered."""
    theta, theta0 = np.radians([75, 55])
    net = design.cover(*examples.hanging_shell(), theta, theta0, 1500)
    return net.V, net.Q, (theta, theta0)


def dome():
    """Rings around a hexagon in space."""
    theta, theta0 = np.radians([60, 45])
    V, Q, hexagon = mesh.polygon_rings(6, 12)
    z = (V[:, 0] + 1j * V[:, 1]) / np.hypot(V[:, 0], V[:, 1]).max()
    height = 0.5 * (1 - abs(z) ** 2) + 0.12 * (z**6).real
    V = np.stack([z.real, z.imag, height], axis=1)
    found = solver.optimize(V, Q, theta, theta0, reference=reference.mesh(V, Q), polygons=[hexagon])
    return found.V, Q, (theta, theta0)


def canopy():
    """A wave moved along another wave, made exact."""
    theta, theta0 = np.radians([75, 60])
    surface = surfaces.translation(lambda u: (u, 0 * u, 0.35 * np.cos(1.6 * u)), lambda v: (0 * v, v, -0.3 * v**2))
    z = conformal.sheared_grid(theta, theta0, 44, 34, 0, 0.1)
    z = z - z.mean()
    V, Q = surface.point(z.real, z.imag).reshape(-1, 3), mesh.grid_quads(44, 34)
    found = solver.optimize(V, Q, theta, theta0, reference=reference.mesh(V, Q))
    return found.V, Q, (theta, theta0)
