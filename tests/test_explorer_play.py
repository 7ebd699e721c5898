"""What one does with a net in the explorer, without its page: shading, undo, touching, remedies."""

import io as streams
import re
import time
from dataclasses import replace

import igl
import numpy as np
import pytest
import pyvista
from matplotlib.image import imread

from inetlib import design, examples, io, measure, mesh, plot
from inetlib.explorer import behind, look, plates, probe, remedy
from inetlib.explorer.choices import Choice
from inetlib.explorer.history import MOST, History
from inetlib.explorer.session import Session


def built(**values):
    """A `Session` with the net of a choice."""
    found = Session()
    assert found.change(**values) == []
    found.construct()
    return found


def in_words(legend):
    return [float(words.split()[0]) for _, words in legend]


def test_faces_are_shaded_by_their_size_with_a_scale_in_the_units_of_the_net():
    i, j = np.array([0, 1, 3, 6, 10.0]), np.array([0, 2.0])
    V = np.stack([*map(np.ravel, np.meshgrid(i, j, indexing="ij")), np.zeros(10)], axis=1)
    Q = mesh.grid_quads(4, 1)
    rgb, legend = look.shading("size", V, Q, None)
    assert np.allclose(in_words(legend), np.linspace(2**0.5, 8**0.5, 5), atol=0.005)
    brightness = rgb.astype(int).sum(axis=1)
    assert np.all(np.diff(brightness) < -50)  # larger is darker
    for k, (colour, _) in ((0, legend[0]), (3, legend[-1])):
        assert colour == "rgb({},{},{})".format(*rgb[k])
    rgb, legend = look.shading("size", *mesh_of_squares(), None)
    assert len(legend) == 1 and legend[0][1] == "all 1" and len(np.unique(rgb, axis=0)) == 1


def mesh_of_squares():
    x = np.linspace(0.3, 3.3, 4)  # no two are equal to the last digit
    V = np.stack([*map(np.ravel, np.meshgrid(x, x, indexing="ij")), np.full(16, 0.1)], axis=1)
    return V, mesh.grid_quads(3, 3)


def test_faces_are_shaded_by_their_planarity_in_percent_and_flat_ones_are_alike():
    V, Q = mesh_of_squares()
    V[0, 2] += 0.2
    rgb, legend = look.shading("planarity", V, Q, None)
    off = 100 * measure.planarity(V, Q)
    d = np.array([1.0, 1, -0.2]), np.array([1.0, -1, 0])  # of the first face
    normal = np.cross(*d) / np.linalg.norm(np.cross(*d))
    apart = abs(normal @ [0, 1, -0.2]) / np.mean([np.linalg.norm(x) for x in d])
    assert off[0] == pytest.approx(100 * apart) and np.all(off[1:] < 1e-12)
    assert in_words(legend) == pytest.approx(np.linspace(0, off[0], 5), rel=0.05)
    assert all(words.endswith(" %") for _, words in legend)
    assert len(np.unique(rgb[1:], axis=0)) == 1 and rgb[0].sum() < rgb[1].sum() - 150
    assert measure.quality(V, Q).planarity == measure.planarity(V, Q).max()


def test_a_shaded_session_has_the_legend_of_its_choice_and_none_without():
    for name, ending in (("deviation", "\u00b0"), ("size", ""), ("planarity", " %")):
        rgb, legend = built(kind="isothermal", m=5, n=4, shade=name).shading()
        assert rgb.shape == (20, 3) and legend[-1][1].endswith(ending), name
    assert built(m=5, n=4).shading() == (None, [])


def camera(azimuth, elevation, scale=1.0, middle=(0.0, 0, 0)):
    """As vtk.js has it, looking at a point; the radians are those of `plot.camera`."""
    a, e = azimuth, elevation
    near = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    up = [-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)]
    place = {"focalPoint": list(middle), "position": (middle + 5 * near).tolist()}
    return place | {"viewUp": up, "parallelScale": scale}


def test_the_face_that_is_hit_is_the_one_that_a_ray_meets_first():
    net = built(kind="isothermal", surface="sphere", m=9, n=8, theta0=80)
    V, Q = net.V, net.Q
    a, b, c = V[Q[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)].transpose(1, 0, 2)
    rng, hits = np.random.default_rng(3), 0
    for azimuth, elevation in ((0.3, 0.2), (2, -1), (-1.2, np.pi / 2)):
        sight = camera(azimuth, elevation, 1.5, [0.1, 0.2, 0])
        back = np.subtract(sight["focalPoint"], sight["position"])
        right = np.cross(back, sight["viewUp"])
        for x, y in rng.uniform(-1, 1, (20, 2)):
            aside = 1.5 * x * right / np.linalg.norm(right) + 1.5 * y * np.array(sight["viewUp"])
            rays = np.stack([b - a, c - a, np.broadcast_to(-back, a.shape)], axis=2)
            s, t, far = np.linalg.solve(rays, (sight["position"] + aside - a)[..., None])[..., 0].T
            met = np.flatnonzero((s >= 0) & (t >= 0) & (s + t <= 1))
            wanted = met[np.argmin(far[met])] // 2 if len(met) else None
            assert probe.hit(V, Q, sight, x, y) == wanted
            hits += wanted is not None
    assert 10 < hits < 50
    assert probe.hit(V, Q, sight, 40, 0) is None
    aside = camera(0.3, 0.2, 1, [9, 0, 0])
    assert probe.hit(V, Q, aside, 0, 0) is None and 0 <= probe.middle(V, Q, aside) < len(Q)


def test_a_face_is_told_by_its_own_angles_and_drawn_with_them():
    net = built(kind="plane", map="inverse", m=6, n=5, theta=70, theta0=50)
    theta, theta0 = np.degrees(measure.angles(net.V, net.Q))
    told = probe.about(net.V, net.Q, 7, (70, 50))
    assert told["name"] == "Face 8"
    assert (told["theta"], told["theta0"]) == (f"{theta[7]:.6f}", f"{theta0[7]:.6f}")
    off = float(told["theta_off"].replace("\u2212", "-"))
    assert off == pytest.approx(theta[7] - 70, rel=0.06) and told["theta_off"][0] in "+\u2212"
    picture = plates.face(net.V[net.Q[7]])
    lines = {name: [] for name in ("d1", "d2", "u", "v")}
    for name, *ends in re.findall(
        r'<line class="(\w+)" [^>]*x1="([\d.]+)" y1="([\d.]+)" x2="([\d.]+)" y2="([\d.]+)"', picture
    ):
        x1, y1, x2, y2 = map(float, ends)
        lines[name].append(complex(x2 - x1, y1 - y2))
    assert [len(lines[name]) for name in lines] == [2, 2, 3, 3]  # quad, sides, medial lines
    between = np.degrees(np.angle(lines["d2"][0] / lines["d1"][0]))
    assert between == pytest.approx(theta[7], abs=1)
    wide = max(abs(x) for x in lines["u"])
    assert wide > 30 and all(abs(x) < 300 for x in lines["u"])


def test_undo_and_redo_go_through_the_choices_and_a_drag_is_one():
    first = Choice()
    past = History(first)
    assert past.undo() == past.redo() == first
    for k in range(5):
        past.take(replace(first, theta=61.0 + k), 10 + 0.1 * k)
    past.take(replace(first, theta=65.0, m=7), 10.5)
    past.take(replace(first, theta=65.0, m=8), 19.0)  # after a rest
    past.take(replace(first, theta=65.0, m=9), 30.0, 1)
    past.take(replace(first, theta=65.0, m=10), 90.0, 1)  # a slow drag
    assert past.undo().m == 8
    assert [past.undo().m for _ in range(2)] == [7, first.m]
    assert past.undo() == past.undo() == first
    assert past.redo() == replace(first, theta=65.0) and past.redo().m == 7
    past.take(replace(first, theta=90.0), 30.0)
    assert past.redo().theta == 90 and not past.next and past.undo().m == 7
    for k in range(300):
        past.take(replace(first, theta=1.0 + k % 2), 100.0 + 10 * k)
    assert len(past.past) == MOST


def covered(**values):
    found = Session()
    assert found.change(kind="cover", quads=60, trim=False, **values) == []
    found.search(found.begin())
    return found


def test_a_cover_has_its_surface_below_it_and_says_how_much_it_covers_and_how_near():
    net = covered()
    V, F = examples.wavy_roof()
    assert net.target.n_cells == len(F) and np.allclose(net.target.points, V, atol=1e-6)
    said = plates.numbers(net.report, net.V, net.Q)
    part = 100 * design.report.area_of(net.V, net.Q) / design.report.area_of(V, F)
    assert float(said["covered"]) == pytest.approx(part, abs=0.06)
    squares, _, _ = igl.point_mesh_squared_distance(net.V, V, F)
    off = 100 * np.sqrt(squares) / np.linalg.norm(np.ptp(V, axis=0))
    for name, found in (("distance", off.max()), ("distance_mean", off.mean())):
        shown = float(said[name].replace("\u2212", "-"))
        assert shown == pytest.approx(found, rel=0.06, abs=1e-12)
    net.change(kind="plane")
    net.construct()
    assert net.target is None
    assert "covered" not in plates.numbers(net.report, net.V, net.Q)


def test_a_large_surface_is_shown_with_fewer_triangles_and_a_broken_one_not_at_all():
    V, F = examples.wavy_roof(200)
    few = behind.few(V, F)
    assert len(F) > behind.MOST > few.n_cells > 5000
    squares, _, _ = igl.point_mesh_squared_distance(few.points.astype(float), V, F)
    assert np.sqrt(squares.max()) < 1 / behind.BINS * np.ptp(V, axis=0).max()
    broken = Session(io.Surface(V[:3] * np.nan, np.array([[0, 1, 2]]), []), "x.obj")
    broken.search(broken.begin())
    assert broken.target is None and broken.problem and broken.V is None


def test_the_surface_and_the_ghost_are_sent_when_they_change_and_leave_nothing():
    net, other = covered(), built(m=4, n=3)
    plotter = pyvista.Plotter(off_screen=True)
    shown = behind.Behind(plotter)
    origin = np.zeros(3)

    def show(*what):
        before = shown.surface.GetMTime(), shown.ghost.GetMTime()
        shown.show(*what, origin, look.LIGHT)
        return (shown.surface.GetMTime(), shown.ghost.GetMTime()) != before

    ghost = other.V, other.Q
    assert show(net.target, ghost) and not show(net.target, ghost)
    assert shown.surface.n_cells == net.target.n_cells
    assert shown.ghost.n_cells == 4 * 4 + 5 * 3  # each edge once
    assert np.allclose(shown.ghost.points, other.V, atol=1e-6)
    assert shown.pale.prop.opacity < 1
    assert show(None, None) and shown.pale.prop.opacity == 1  # else all is drawn several times
    assert shown.surface.n_points == shown.ghost.n_points == 1
    plotter.close()


@pytest.mark.parametrize("form", [".svg", ".png"])
def test_a_saved_picture_has_the_surface_below_the_net_and_the_ghost(monkeypatch, form):
    monkeypatch.setattr(look, "PIXELS", 200)
    net, other = covered(), built(m=4, n=3)
    aside = np.array([3 * np.ptp(net.V[:, 0]), 0, 0])
    ghost = other.V + aside, other.Q

    def saved(*more, **shown):
        assert net.change(**shown) == []
        return net.save(form, -1.0, 0.7, *more)

    plain, both = saved(target=False), saved(ghost, target=True)
    assert both == saved(ghost) and len({plain, saved(), saved(ghost, target=False), both}) == 4
    if form == ".svg":  # the ghost as vectors, all else in one picture
        texts = plain.decode(), saved().decode(), both.decode()
        assert [plot.GREY in text for text in texts] == [False, False, True]
        assert [text.count("<image") for text in texts] == [1, 1, 1]
        return
    one, below, all_of_it = (
        np.round(255 * imread(streams.BytesIO(data))[..., :3]) for data in (plain, saved(), both)
    )
    pale = (below < 253).any(axis=-1) & (below.min(axis=-1) > 195)  # 0.3 of it, over white
    assert 0.05 < pale.mean() < 0.5 and (one.min(axis=-1) > 195).mean() > 0.5
    V, cam = examples.wavy_roof()[0], plot.camera(-1.0, 0.7)
    wide, narrow = (np.ptp(cam(W)[0], axis=0) for W in (V, net.V))
    for picture, size in ((below, wide), (one, narrow)):  # what is drawn fills the picture
        rows, columns = (np.ptp(np.flatnonzero((picture < 253).any(axis=(k, 2)))) for k in (1, 0))
        assert columns / rows == pytest.approx(size[0] / size[1], rel=0.06)
    right = all_of_it[:, -all_of_it.shape[1] // 3 :]  # where the ghost is alone
    assert (right < 200).any() and np.ptp(right, axis=-1).max() < 20
    assert net.save(".obj", ghost=ghost) == net.save(".obj")


def test_a_surface_that_the_net_is_not_on_is_not_shown_with_it():
    net = covered()
    assert net.beneath is net.target is not None
    net.change(source="saddle")
    net.search(net.begin())
    net.change(source="roof")  # whose net is not there yet
    assert net.target is not None and net.beneath is None
    net.change(source="saddle", target=False)
    assert net.target is not None and net.beneath is None


FAULTY = [
    {"kind": "revolution", "theta": 120, "theta0": 30, "m": 5, "n": 60},
    {"kind": "plane", "map": "moebius", "px": 0.5, "py": 0.2},
    {"kind": "plane", "map": "square", "theta": 1, "theta0": 179},
    {"kind": "cover", "source": "file"},
    {"kind": "cover", "source": "shell", "theta": 165, "theta0": 165, "quads": 100},
]


@pytest.mark.parametrize("values", FAULTY)
def test_where_there_is_no_good_net_each_change_that_is_offered_makes_one(values):
    found = Session()
    found.change(m=values.get("m", 8), n=values.get("n", 8), quads=60)
    found.change(**values)
    (found.search(found.begin()) if found.must_search else found.construct())
    assert found.is_faulty
    offers = remedy.remedies(found.choice)
    if values.get("source") == "shell":  # there are whole quads
        assert offers[0] == {"trim": False}
    assert 1 <= len(offers) <= remedy.MOST and all(offers.count(one) == 1 for one in offers)
    for change in offers:
        other = Session()
        other.choice = found.choice
        assert other.change(**change) == []
        (other.search(other.begin()) if other.must_search else other.construct())
        quality = measure.quality(other.V, other.Q)
        assert not (other.problem or other.is_faulty or quality.flips or quality.darts), change
        assert all(getattr(found.choice, name) != x for name, x in change.items())
        words = remedy.words(change)
        assert words.isprintable() and words.count("=") == len(change)


def test_the_angles_that_are_offered_are_near_and_nothing_is_tried_when_it_must_end():
    choice = replace(Choice(), theta=1.0, theta0=179.0, m=8, n=8)
    both = remedy.remedies(choice)[0]
    assert 1 < both["theta"] < 20 and 160 < both["theta0"] < 179
    (one,) = [x for x in remedy.remedies(replace(choice, theta=90.0)) if "theta0" in x]
    assert "theta" not in one  # it is right as it is
    locked = replace(choice, theta=3.0, theta0=3.0, lock=True)
    assert all(x["theta"] == x["theta0"] for x in remedy.remedies(locked) if "theta" in x)
    start = time.monotonic()
    assert remedy.remedies(choice, going=lambda: False) == []
    assert time.monotonic() - start < 0.5
    assert remedy.words({"theta": 62.0, "px": -1.5}) == "\u03b8 = 62\u00b0, pole x = \u22121.5"
    assert not built(m=5, n=4).is_faulty and not Session().is_faulty


def test_where_there_never_was_a_net_that_of_an_offer_stands_in_and_the_problem_stays():
    found = Session()
    found.change(kind="cover", source="file", quads=60)
    found.search(found.begin())
    choice, problem = found.choice, found.problem
    assert problem and found.V is None
    found.stand_in(found.other(source="roof"))
    assert (found.choice, found.problem) == (choice, problem) and found.is_faulty
    assert found.shown.source == "roof" and len(found.Q) > 30
