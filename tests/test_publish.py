"""`publish`: stable bytes, honest numbers, and no half-written file."""

import hashlib
import json

import matplotlib.pyplot as plt
import numpy as np
import pytest

from inetlib import conformal, plot, publish

T, T0 = np.radians(60), np.radians(45)


@pytest.fixture
def draw():
    """Makes drawings of a net; closes their figures at the end."""
    figures = []

    def make(name="fig00", theta=T, claims=None, parameters=None, nets=None):
        figure, axes = plot.canvas([["A", "B"]], 3, 1.5)
        figures.append(figure)
        V, Q = conformal.quads(conformal.sheared_grid(theta, T0, 3, 3))
        plot.net(axes["A"], V, Q)
        plot.black_quads(axes["B"], V, Q)
        plot.panel(axes["A"], "A", "a net")
        return publish.Drawing(
            name=name,
            figure=figure,
            function="inetlib.drawings.fig00.draw",
            parameters={"theta": round(theta, 9)} if parameters is None else parameters,
            data={"V": V, "Q": Q},
            nets=[(V, Q, theta, T0)] if nets is None else nets,
            claims={"faces": 9} if claims is None else claims,
        )

    yield make
    for figure in figures:
        plt.close(figure)


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


# --- the hash -----------------------------------------------------------------------------

DATA = {"V": np.arange(12).reshape(4, 3) / 7, "z": np.array([1 + 2j, -0.5j])}


def micro(values):
    """Values in the middle of a rounding cell, where small noise cannot carry them out."""
    return np.round(np.asarray(values) * 1e6) / 1e6


def test_the_digest_is_the_sha256_of_names_shapes_and_rounded_numbers():
    data = {"b": [0.1234564], "a": np.array([[2, 1]])}
    text = b"a(1, 2)" + np.array([2.0, 1.0]).tobytes() + b"b(1,)" + np.array([0.123456]).tobytes()
    assert publish.digest(data) == hashlib.sha256(text).hexdigest()


def test_the_digest_ignores_rounding_noise():
    quiet = {name: micro(values) for name, values in DATA.items()}
    rng = np.random.default_rng(1)
    noisy = {name: x + 1e-9 * rng.uniform(-1, 1, x.shape) for name, x in quiet.items()}
    assert not np.array_equal(noisy["V"], quiet["V"])
    assert publish.digest(noisy) == publish.digest(quiet)


def test_the_digest_takes_minus_zero_and_negative_noise_for_zero():
    zero = publish.digest({"x": np.zeros(3), "z": np.zeros(2, dtype=complex)})
    assert zero == publish.digest({"x": -np.zeros(3), "z": -np.zeros(2, dtype=complex)})
    assert zero == publish.digest({"x": np.full(3, -1e-12), "z": np.full(2, -1e-12 - 1e-12j)})


def test_the_digest_does_not_depend_on_layout_type_or_order():
    V = np.arange(6.0).reshape(2, 3)
    wanted = publish.digest({"V": V, "n": [1]})
    assert wanted == publish.digest({"n": np.array([1.0]), "V": V})
    assert wanted == publish.digest({"V": np.asfortranarray(V), "n": [1]})
    assert wanted == publish.digest({"V": V.astype(np.int32), "n": np.array([1], dtype=np.uint8)})
    assert wanted == publish.digest({"V": V.tolist(), "n": (1,)})


CHANGED = {
    "a coordinate": DATA | {"V": DATA["V"] + 1e-5 * np.eye(4, 3)},
    "an imaginary part": DATA | {"z": DATA["z"] + np.array([0, 1e-5j])},
    "the shape": DATA | {"V": DATA["V"].reshape(3, 4)},
    "the order": DATA | {"V": DATA["V"][::-1]},
    "a name": {"W": DATA["V"], "z": DATA["z"]},
    "less": {"V": DATA["V"]},
    "more": DATA | {"x": np.zeros(0)},
}


@pytest.mark.parametrize("what", CHANGED)
def test_the_digest_notices_a_change_of(what):
    assert publish.digest(CHANGED[what]) != publish.digest(DATA)


# --- deviations ---------------------------------------------------------------------------


def test_deviations_are_the_largest_of_all_faces_of_all_nets_in_degrees():
    V, Q = conformal.quads(np.add.outer(np.arange(3), 1j * np.arange(2)))  # squares: 90 degrees
    nets = [
        (V, Q, np.radians(90), np.radians(91)),
        (V, Q, np.radians(87), np.radians(90.5)),
    ]
    assert publish.deviations(nets) == pytest.approx((3, 1))
    V[0, 0] += 1  # one diagonal (1, 1) becomes (0, 1): its angle with (1, -1) is 135 degrees
    assert publish.deviations([(V, Q, np.pi / 2, np.pi / 2)])[0] == pytest.approx(45)


def test_without_nets_there_is_no_deviation():
    assert np.isnan(publish.deviations([])).all()


# --- saving -------------------------------------------------------------------------------


def test_saving_twice_gives_the_same_bytes(draw, tmp_path):
    drawing = draw()
    publish.save(drawing, tmp_path)
    first = contents(tmp_path)
    assert set(first) == {"fig00.svg", "fig00.png", "manifest.json"}
    publish.save(drawing, tmp_path)
    assert contents(tmp_path) == first
    publish.save(draw(), tmp_path)
    assert contents(tmp_path) == first


def test_the_files_are_an_svg_and_a_png_without_dates(draw, tmp_path):
    publish.save(draw(), tmp_path)
    found = contents(tmp_path)
    assert found["fig00.png"].startswith(b"\x89PNG")
    assert b"<svg" in found["fig00.svg"]
    assert b"<dc:date>" not in found["fig00.svg"]
    assert b"Matplotlib" not in found["fig00.png"]


def test_the_manifest_holds_what_stands_behind_the_figure(draw, tmp_path):
    drawing = draw()
    entry = publish.save(drawing, tmp_path)
    assert entry == {
        "function": "inetlib.drawings.fig00.draw",
        "parameters": {"theta": round(T, 9)},
        "sha256": publish.digest(drawing.data),
        "max_deviation_theta_deg": 0.0,
        "max_deviation_theta0_deg": 0.0,
        "claims": {"faces": 9},
    }
    text = (tmp_path / "manifest.json").read_bytes()
    assert json.loads(text) == {"fig00": entry}
    assert text.endswith(b"}\n")
    assert b"\r" not in text
    assert publish.read_manifest(tmp_path) == {"fig00": entry}


def test_a_wrong_claim_about_the_angles_shows_in_the_manifest(draw, tmp_path):
    V, Q = conformal.quads(conformal.sheared_grid(T, T0, 2, 2))
    nets = [(V, Q, T + np.radians(0.5), T0)]
    entry = publish.save(draw(nets=nets), tmp_path)
    assert entry["max_deviation_theta_deg"] == pytest.approx(0.5, abs=1e-8)
    assert entry["max_deviation_theta0_deg"] == 0


def test_a_figure_without_nets_has_no_deviation_in_the_manifest(draw, tmp_path):
    entry = publish.save(draw(nets=[]), tmp_path)
    assert entry["max_deviation_theta_deg"] is None
    assert b"NaN" not in (tmp_path / "manifest.json").read_bytes()


def test_the_manifest_keeps_other_figures_and_is_sorted(draw, tmp_path):
    for name in ("fig02", "fig01", "fig03"):
        publish.save(draw(name), tmp_path)
    changed = publish.save(draw("fig02", theta=np.radians(70)), tmp_path)
    manifest = publish.read_manifest(tmp_path)
    assert list(manifest) == ["fig01", "fig02", "fig03"]
    assert manifest["fig02"] == changed
    assert manifest["fig01"]["sha256"] == manifest["fig03"]["sha256"] != changed["sha256"]


def test_a_folder_with_spaces_is_made_when_only_its_last_part_is_missing(draw, tmp_path):
    folder = tmp_path / "my figures (new)"
    publish.save(draw(), str(folder))
    assert set(contents(folder)) == {"fig00.svg", "fig00.png", "manifest.json"}


def test_a_missing_parent_folder_is_named(draw, tmp_path):
    with pytest.raises(FileNotFoundError, match="nowhere"):
        publish.save(draw(), tmp_path / "nowhere" / "figures")
    assert contents(tmp_path) == {}


@pytest.mark.parametrize("kind", ["svg", "png"])
def test_a_failing_savefig_leaves_the_old_files_and_no_temporary_ones(
    draw, tmp_path, monkeypatch, kind
):
    publish.save(draw(), tmp_path)
    before = contents(tmp_path)
    drawing = draw(theta=np.radians(75))
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


UNWRITABLE = {
    "not a number": (dict(claims={"x": float("nan")}), ValueError, "not JSON compliant"),
    "an array": (dict(parameters={"x": np.zeros(2)}), TypeError, "not JSON serializable"),
    "an angle that is no number": (
        dict(nets=[(*conformal.quads(conformal.sheared_grid(T, T0, 1, 1)), np.nan, T0)]),
        ValueError,
        "target = nan",
    ),
}


@pytest.mark.parametrize("what", UNWRITABLE)
def test_nothing_is_written_when_the_entry_cannot_be(draw, tmp_path, what):
    change, error, words = UNWRITABLE[what]
    with pytest.raises(error, match=words):
        publish.save(draw(**change), tmp_path)
    assert contents(tmp_path) == {}


def test_there_is_no_manifest_yet_in_an_empty_folder(tmp_path):
    assert publish.read_manifest(tmp_path) == {}
