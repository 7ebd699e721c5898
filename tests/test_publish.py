"""`publish`: kept unless it changed, stable bytes, honest numbers, and no half-written file."""

import csv
import hashlib
import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import outputs  # tools/outputs.py
import pytest
import redraw  # tools/redraw.py

from inetlib import conformal, drawings, mesh, plot, publish, surfaces
from inetlib.drawings import same, table1

FIGURES = Path(__file__).resolve().parent.parent / "figures"
T, T0 = np.radians(60), np.radians(45)


@pytest.fixture
def draw():
    """Makes drawings of a net, with some parts changed; closes their figures at the end."""
    figures = []

    def make(name="fig00", theta=T, title="a net", **changed):
        figure, axes = plot.canvas([["A", "B"]], 3, 1.5)
        figures.append(figure)
        V, Q = conformal.quads(conformal.sheared_grid(theta, T0, 3, 3))
        plot.net(axes["A"], V, Q)
        plot.black_quads(axes["B"], V, Q)
        plot.panel(axes["A"], "A", title)
        parts = {"parameters": {"theta": round(theta, 9)}, "data": {"V": V, "Q": Q}}
        parts |= {"nets": [(V, Q, theta, T0)], "claims": {"faces": 9}} | changed
        return publish.Drawing(name, figure, "inetlib.drawings.fig00.draw", **parts)

    yield make
    for figure in figures:
        plt.close(figure)


FILES = {"fig00.svg", "fig00.png", "data/fig00.npz", "manifest.json"}


def contents(folder):
    """{name: bytes} of all files below a folder."""
    paths = sorted(path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def test_deviations_are_the_largest_of_all_faces_of_all_nets():
    V, Q = conformal.quads(np.add.outer(np.arange(3), 1j * np.arange(2)))  # squares: 90 degrees
    nets = [(V, Q, *np.radians([90, 91])), (V, Q, *np.radians([87, 90.5]))]
    assert publish.deviations(nets) == pytest.approx(np.radians([3, 1]))
    V[0, 0] += 1  # one diagonal (1, 1) becomes (0, 1): its angle with (1, -1) is 135 degrees
    assert publish.deviations([(V, Q, np.pi / 2, np.pi / 2)])[0] == pytest.approx(np.pi / 4)
    assert np.isnan(publish.deviations([])).all()


def test_a_drawing_has_the_name_of_its_module_and_the_arguments_of_the_call():
    @drawings.drawn("angle")
    def draw(angle=np.pi / 4, count=3, places=((0, 0.5), (1, 2)), rho=1 + 2j, profile=None):
        return "figure", {"x": angle}, [], {"half": np.float64(1 / 3)}

    drawing = draw(np.radians(60.5), profile=surfaces.vase_profile())
    assert (drawing.name, drawing.function) == ("test_publish", f"{__name__}.draw")
    parameters = {"angle": 60.5, "count": 3, "places": [[0, 0.5], [1, 2]], "rho": [1, 2]}
    assert drawing.parameters == parameters and draw().parameters["angle"] == 45
    assert drawing.claims == {"half": 0.333333333} and drawing.data == {"x": np.radians(60.5)}


def test_a_drawing_counts_the_darts_in_its_nets():
    arrow = np.array([[0, 0, 0], [4, 1, 0], [0, 2, 0], [1, 1, 0]], dtype=float)
    kite, face = arrow - np.outer([0, 0, 0, 2], [1, 0, 0]), np.array([[0, 1, 2, 3]])

    @drawings.drawn()
    def draw():
        nets = [(V, face, T, T0) for V in (arrow, kite, arrow)]
        return "figure", {}, nets, drawings.sampled("kite", kite, face, (T, T0))

    claims = draw().claims
    assert (claims["darts"], claims["kite_darts"]) == (2, 0) and claims["kite_max_deviation_deg"]


def darts(V, Q):
    """Faces with a corner that turns the other way, seen along the normal of their diagonals."""
    P = V[Q]
    normal = np.cross(P[:, 2] - P[:, 0], P[:, 3] - P[:, 1])
    sides = np.roll(P, -1, axis=1) - P
    turns = np.cross(np.roll(sides, 1, axis=1), sides)
    return np.flatnonzero((np.sum(turns * normal[:, None], axis=2) < 0).any(axis=1)).tolist()


def test_every_figure_with_nets_says_that_none_has_darts_or_which():
    for name, entry in publish.read_manifest(FIGURES).items():
        said = {k: n for k, n in entry["claims"].items() if k.endswith("darts")}
        assert "darts" in said or entry["max_deviation_theta_deg"] is None, name
        wanted = {"darts": 2} if name == "fig03" else {}  # at the zero of z^2, see below
        assert {k: n for k, n in said.items() if n} == wanted, name
        panels = {"fig09": 20, "fig12": 5, "fig13": 4}.get(name, 0)
        assert len(said) > panels
    with open(FIGURES / "table1.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 7 * 5  # runs of the paper's formulation that end off their angles, too
    assert {row["flips, darts"] for row in rows} == {"-", "0, 0"}


def test_the_two_darts_of_fig_3_are_corners_of_120_degrees_doubled():
    z = publish.read_data(FIGURES / "data" / "fig03.npz")["C3"].reshape(-1, 2) @ [1, 1j]
    V, Q = np.stack([z.real, z.imag, 0 * z.real], axis=1), mesh.grid_quads(10, 10)
    around, k = np.nonzero(Q == 60)
    before, after = z[Q[around, k - 1]], z[Q[around, (k + 1) % 4]]
    corners = np.degrees(np.angle(before / after)) % 360  # inside, the faces turn to the left
    assert sorted(corners) == pytest.approx([120, 120, 240, 240], abs=1e-4) and abs(z[60]) < 1e-7
    assert darts(V, Q) == around[corners > 180].tolist()


def test_an_independent_judge_finds_no_darts_in_the_nets_of_figs_9_12_and_13():
    open_ = mesh.grid_quads(14, 36)
    faces = {555: open_, 540: open_ // 37 * 36 + open_ % 37 % 36, 441: mesh.grid_quads(20, 20)}
    faces[486] = mesh.polygon_rings(6, 8)[1]
    seen = 0
    for name in ("fig09", "fig12", "fig13"):
        for key, V in publish.read_data(FIGURES / "data" / f"{name}.npz").items():
            if key.startswith(("net_", "image_")):
                assert not darts(V, faces[len(V)]), (name, key)
                seen += 1
    assert seen == 20 + 5 + 4


def test_saving_twice_gives_the_same_bytes_without_dates_and_a_manifest(draw, tmp_path):
    drawing = draw()
    for _ in range(2):
        entry = publish.save(drawing, tmp_path)
    first = contents(tmp_path)
    assert set(first) == FILES
    assert publish.save(draw(), tmp_path) == entry and contents(tmp_path) == first
    assert first["fig00.png"].startswith(b"\x89PNG") and b"<svg" in first["fig00.svg"]
    assert b"<dc:date>" not in first["fig00.svg"] and b"Matplotlib" not in first["fig00.png"]
    assert entry == {
        "function": "inetlib.drawings.fig00.draw",
        "parameters": {"theta": round(T, 9)},
        "sha256": hashlib.sha256(first["data/fig00.npz"]).hexdigest(),
        "max_deviation_theta_deg": 0.0,
        "max_deviation_theta0_deg": 0.0,
        "claims": {"faces": 9},
    }
    text = first["manifest.json"]
    assert json.loads(text) == publish.read_manifest(tmp_path) == {"fig00": entry}
    assert text.endswith(b"}\n") and b"\r" not in text


def test_a_wrong_claim_about_the_angles_shows_in_the_manifest(draw, tmp_path):
    V, Q = conformal.quads(conformal.sheared_grid(T, T0, 2, 2))
    entry = publish.save(draw(nets=[(V, Q, T + np.radians(0.5), T0)]), tmp_path)
    assert entry["max_deviation_theta_deg"] == pytest.approx(0.5, abs=1e-8)
    assert entry["max_deviation_theta0_deg"] == 0
    assert publish.save(draw(nets=[]), tmp_path)["max_deviation_theta_deg"] is None


def test_the_data_are_there_to_be_read(draw, tmp_path):
    drawing = draw(data={"z": np.array([1 / 3, 1 - 2j / 3]), "n": np.array([1, 2]), "o": [-1e-12]})
    publish.save(drawing, tmp_path)
    found = publish.read_data(tmp_path / "data" / "fig00.npz")
    assert {name: array.tolist() for name, array in found.items()} == {
        "z": [[0.3333333, 0.0], [1.0, -0.6666667]],
        "n": [1.0, 2.0],
        "o": [0.0],
    }
    assert not np.signbit(found["o"]).any()


def test_what_differs_by_the_last_digits_is_kept(draw, tmp_path):
    first = publish.save(draw(claims={"x": 0.123456, "whole": 60.0}), tmp_path)
    before, rng = contents(tmp_path), np.random.default_rng(3)
    changed = {"parameters": {"theta": T + 1e-13}, "claims": {"x": 0.123457, "whole": 59.999999}}
    other = draw(theta=T + 1e-13, **changed)
    data = {k: x * (1 + 1e-8 * rng.uniform(-1, 1, x.shape)) for k, x in other.data.items()}
    assert publish.save(other._replace(data=data), tmp_path) == first
    assert contents(tmp_path) == before


def test_broken_or_missing_files_are_made_again(draw, tmp_path):
    publish.save(draw(), tmp_path)
    whole = contents(tmp_path)
    for name in FILES - {"manifest.json"}:
        for broken in (b"", b"<<<<<<< ours", whole[name][: len(whole[name]) // 2], None):
            (tmp_path / name).unlink()
            if broken is not None:
                (tmp_path / name).write_bytes(broken)
            publish.save(draw(), tmp_path)
            assert contents(tmp_path) == whole, name


ANOTHER = [
    ({"theta": T + 1e-3, "parameters": {"theta": 1.0472}}, ["data V", "svg", "png"]),
    ({"parameters": {"theta": 2.0}}, ["manifest"]),
    ({"claims": {"faces": 8}}, ["manifest"]),
    ({"nets": []}, ["manifest"]),
    ({"title": "another net"}, ["svg", "png"]),
    ({"data": {"V": np.zeros(3)}}, ["data Q", "data V"]),
]


@pytest.mark.parametrize(("change", "words"), ANOTHER)
def test_what_changed_is_named_and_rewritten_alone(draw, tmp_path, change, words):
    folder, other = tmp_path / "one", tmp_path / "two"
    for place in (folder, other):
        publish.save(draw("fig02", parameters={"theta": 1.0472}), place)
        publish.save(draw("fig01"), place)
    before = contents(folder)
    entry = publish.save(draw("fig02", **{"parameters": {"theta": 1.0472}} | change), folder)
    assert publish.differences("fig02", folder, other) == words
    after = contents(folder)
    changed = {name for name in after if after[name] != before[name]}
    assert changed <= {name.replace("fig00", "fig02") for name in FILES}
    assert {"svg": "fig02.svg", "png": "fig02.png"}.get(words[-1], "manifest.json") in changed
    manifest = publish.read_manifest(folder)
    assert list(manifest) == ["fig01", "fig02"] and manifest["fig02"] == entry
    assert publish.differences("fig01", folder, other) == []
    assert "data" not in change or "data/fig02.npz" in changed


def test_data_that_are_not_those_of_the_manifest_are_noticed(draw, tmp_path):
    for place in ("one", "two"):
        publish.save(draw(), tmp_path / place)
    path = tmp_path / "two" / "data" / "fig00.npz"
    np.savez_compressed(path, **publish.read_data(path))
    assert publish.differences("fig00", tmp_path / "one", tmp_path / "two") == ["manifest"]
    assert publish.differences("fig09", tmp_path / "one", tmp_path / "two") == ["missing"]


def test_a_text_is_kept_unless_it_says_something_else(tmp_path):
    path = tmp_path / "table.md"
    for text, kept in (("7 | 0.25", "7 | 0.25"), ("7 | 0.26", "7 | 0.25"), ("8 | 1", "8 | 1")):
        publish.save_text(f"{text}\n", path)
        assert path.read_bytes() == f"{kept}\n".encode()
    assert list(tmp_path.iterdir()) == [path]


def test_showing_writes_nothing_unless_somebody_says_where(draw, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv(publish.FOLDER, raising=False)
    lines = [["12A", *12 * ["-"]]]
    for colours in (None, 96):
        picture = publish.show(draw(), colours)
        assert (picture is None) == (colours is None)
        table1.show(lines)
    assert publish.asked() is None and contents(tmp_path) == {}
    monkeypatch.setenv(publish.FOLDER, str(tmp_path / "figures"))
    publish.show(draw())
    assert table1.show(lines).data.count("\n") == 3
    assert set(contents(tmp_path / "figures")) == FILES | {"table1.md", "table1.csv"}


def test_a_shown_drawing_has_the_first_words_of_its_docstring_as_alternative_text(monkeypatch):
    @drawings.drawn()
    def draw():
        """A net of nine faces,
        drawn twice.

        No more words."""
        return plot.canvas([["A"]], 2, 2)[0], {}, [], {}

    shown, drawing = [], draw()
    assert drawing.words == "A net of nine faces, drawn twice."
    monkeypatch.setattr("IPython.display.display", lambda *args, **named: shown.append(named))
    monkeypatch.delenv(publish.FOLDER, raising=False)
    publish.show(drawing)
    assert shown == [] and plt.fignum_exists(drawing.figure.number)  # of a window, not our affair
    monkeypatch.setattr(plt, "get_backend", lambda: "inline")
    publish.show(drawing)
    assert shown == [{"metadata": {"image/png": {"alt": drawing.words}}}]
    assert not plt.fignum_exists(drawing.figure.number)
    assert publish.show(draw(), 96).alt == drawing.words


def test_the_kernels_of_redraw_write_into_figures_and_others_nowhere(monkeypatch):
    monkeypatch.setenv(publish.FOLDER, "somewhere")
    assert publish.FOLDER not in outputs.environment("own")
    assert redraw.environment("own")[publish.FOLDER] == str(FIGURES)


def test_the_table_of_redraw_tells_exact_nets_from_drawn_ones():
    claims = {"net_max_deviation_deg": 0.25, "other_max_deviation_deg": 0.5, "start_theta_deg": 9}
    exact = {"max_deviation_theta_deg": 0.0, "max_deviation_theta0_deg": 1e-9}
    assert redraw.deviations(exact | {"claims": claims}) == (1e-9, 0.5)
    assert redraw.deviations(exact | {"claims": {}}) == (1e-9, 1e-9)
    assert redraw.deviations(dict.fromkeys(exact) | {"claims": {}}) == (None, None)


def test_no_stored_figure_is_larger_than_allowed():
    for path in FIGURES.iterdir():
        assert path.is_dir() or path.stat().st_size <= same.LARGE, path.name


def test_the_users_settings_change_no_byte(draw, tmp_path):
    publish.save(draw(), tmp_path / "one")
    with plt.rc_context({"font.size": 20, "lines.linewidth": 5, "axes.facecolor": "red"}):
        plt.rcParams["savefig.bbox"], plt.rcParams["svg.fonttype"] = "tight", "none"
        plt.rcParams["axes.formatter.use_locale"] = True
        publish.save(draw(), tmp_path / "two")
    assert contents(tmp_path / "one") == contents(tmp_path / "two")


def test_a_folder_with_spaces_is_made_when_only_its_last_part_is_missing(draw, tmp_path):
    folder = tmp_path / "my figures (new)"
    assert publish.read_manifest(folder) == {}
    publish.save(draw(), str(folder))
    assert set(contents(folder)) == FILES
    with pytest.raises(FileNotFoundError, match="nowhere"):
        publish.save(draw(), tmp_path / "nowhere" / "figures")


@pytest.mark.parametrize("kind", ["svg", "png"])
def test_a_failing_savefig_leaves_only_the_old_files(draw, tmp_path, monkeypatch, kind):
    publish.save(draw(), tmp_path)
    before, drawing = contents(tmp_path), draw(theta=np.radians(75))
    real = drawing.figure.savefig

    def failing(path, format, **options):
        real(path, format=format, **options)
        if format == kind:
            raise OSError("disk full")

    monkeypatch.setattr(drawing.figure, "savefig", failing)
    with pytest.raises(OSError, match="disk full"):
        publish.save(drawing, tmp_path)
    assert contents(tmp_path) == before


@pytest.mark.parametrize("text", ['{"fig01": ', "[1, 2]", "\udcff"])
def test_a_corrupt_manifest_is_named_and_nothing_is_overwritten(draw, tmp_path, text):
    publish.save(draw(), tmp_path)
    (tmp_path / "manifest.json").write_text(text, errors="surrogateescape", encoding="utf-8")
    before = contents(tmp_path)
    with pytest.raises(ValueError, match=r"manifest\.json is not a JSON object: delete it"):
        publish.save(draw(theta=np.radians(75)), tmp_path)
    assert contents(tmp_path) == before


NO_ANGLE = (*conformal.quads(conformal.sheared_grid(T, T0, 1, 1)), np.nan, T0)
UNWRITABLE = {
    "not a number": (dict(claims={"x": float("nan")}), ValueError, "not JSON compliant"),
    "an array": (dict(parameters={"x": np.zeros(2)}), TypeError, "not JSON serializable"),
    "an angle that is no number": (dict(nets=[NO_ANGLE]), ValueError, "not JSON compliant"),
}


@pytest.mark.parametrize("what", UNWRITABLE)
def test_nothing_is_written_when_the_entry_cannot_be(draw, tmp_path, what):
    change, error, words = UNWRITABLE[what]
    with pytest.raises(error, match=words):
        publish.save(draw(**change), tmp_path)
    assert contents(tmp_path) == {}
