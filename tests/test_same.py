"""`same`: what another machine changes is kept, what somebody changes is noticed."""

import io

import matplotlib.pyplot as plt
import numpy as np
import PIL.Image
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inetlib import plot
from inetlib.drawings import same

PAIRS = {  # texts, and whether they say the same
    ("60.000 degrees", "60.001 degrees"): True,
    ("at most 1.22e-11", "at most 1.23e-11"): True,
    ("1e-05", "9e-06"): True,
    ("-0.50, +1.5", "-0.49, +1.6"): True,
    ("", ""): True,
    (r"$\lambda = 1.618$", r"$\lambda = 1.619$"): True,
    ("60.000 degrees", "60.002 degrees"): False,
    ("at most 1.22e-11", "at most 1.24e-11"): False,
    ("7 steps", "8 steps"): False,
    ("7 steps", "7.0 steps"): False,
    ("0.5", "-0.5"): False,
    ("x1 = 0.1", "x2 = 0.1"): False,
    ("0.1", "0.1 0.1"): False,
    ("converged 1.0", "not converged 1.0"): False,
    ("1.0", "nan"): False,
}


@pytest.mark.parametrize("pair", PAIRS)
def test_texts_say_the_same_or_not(pair):
    assert same.text(*pair) == same.text(*pair[::-1]) == PAIRS[pair]


@given(st.floats(-1e6, 1e6), st.integers(1, 9))
def test_a_number_a_last_bit_away_prints_the_same(x, digits):
    for other in (np.nextafter(x, np.inf), np.nextafter(x, -np.inf)):
        assert same.text(f"{x:.{digits}f}", f"{other:.{digits}f}")
        assert same.text(f"{x:.{digits}e}", f"{other:.{digits}e}")


CLAIMS = {"steps": 7, "good": True, "theta": 60.0, "words": "all", "list": [0.25, None]}
CLOSE = [{}, {"theta": 59.999999}, {"list": (0.26, None)}]
DIFFERENT = [{"steps": 8}, {"steps": 7.0}, {"good": 1}, {"theta": 59.998}, {"theta": 61.0}]
DIFFERENT += [{"words": "some"}, {"list": [0.27, None]}, {"list": [0.25]}, {"more": 1}]


def test_claims_are_the_same_within_their_last_digit_or_differ():
    for change in CLOSE + DIFFERENT:
        one, other = CLAIMS, CLAIMS | change
        assert same.claims(one, other) == same.claims(other, one) == (change in CLOSE), change
    assert same.claims({"x": 1.047197551}, {"x": 1.04719755})
    assert same.claims({"x": 0.0}, {"x": 1e-9})


DATA = {"V": np.arange(12.0).reshape(4, 3), "w": np.array([0.5, -20.0])}


def test_data_are_compared_by_the_size_of_the_figure_and_those_that_differ_are_named():
    near = {name: x + 1e-5 for name, x in DATA.items()}  # the size is 20.5
    assert same.data(DATA, near) == []
    far = DATA | {"V": DATA["V"] + 3e-5 * np.eye(4, 3)}
    assert same.data(DATA, far) == ["V"]
    small = {name: x / 1000 for name, x in DATA.items()}
    assert same.data(small, {name: x + 1e-5 for name, x in small.items()}) == ["V", "w"]
    for change in (
        {"V": DATA["V"].reshape(3, 4)},
        {"V": DATA["V"][::-1]},  # another order
        {"V": DATA["V"] * np.nan},
        {"x": np.zeros(0)},
    ):
        assert same.data(DATA, DATA | change) == list(change)
    assert same.data(DATA, {"V": DATA["V"]}) == ["w"]


def written(kind, shift=0.0, colour="#336699", text="a"):
    """A figure with a clip, a marker, polygons and words, as matplotlib writes it."""
    plot.use_style()
    figure, axes = plt.subplots(1, 2, figsize=(3, 1.5))
    for ax in axes:
        ax.plot([0, 1 / 3 + shift, 1], [0, 1, 0.2], "o-", color=colour)
        plot.polygons(ax, np.array([[0, 0], [1, 0], [1, 1 / 7 + shift]]), [[0, 1, 2]])
        ax.set_title(text)
    file = io.BytesIO()
    figure.savefig(file, format=kind, metadata={"Date": None} if kind == "svg" else {})
    plt.close(figure)
    return file.getvalue() if kind == "png" else file.getvalue().decode()


def test_the_names_and_numbers_of_an_svg_are_plain_and_it_looks_as_before():
    """The scales of glyphs are left alone, and no coordinate moves more than half a unit."""
    raw = written("svg")
    plain = same.plain_svg(raw)
    assert len(same.HASHED.findall(raw)) >= 4  # else this test sees nothing
    assert 'id="p-' in plain and "url(#p-" in plain and 'href="#m-' in plain
    for name in same.re.findall(r'(?:url\(|href=")#([\w-]+)', plain):
        assert plain.count(f'id="{name}"') == 1
    old, new = (same.re.findall(r'\bd="([^"]*)"', x) for x in (raw, plain))
    decimals = [x.partition(".")[2] for x in same.COORDINATE.findall(" ".join(new))]
    assert max(map(len, decimals)) == 2
    assert len(plain) < len(raw) and same.plain_svg(plain) == plain
    assert same.re.findall(r"scale\([^)]*\)", raw) == same.re.findall(r"scale\([^)]*\)", plain)
    a, b = (np.array(same.COORDINATE.findall(" ".join(paths)), float) for paths in (old, new))
    assert len(a) > 100
    np.testing.assert_allclose(a, b, atol=0.00501)


def test_an_svg_is_the_same_up_to_hundredths_of_a_point_and_little_colour():
    one, two, three = (same.plain_svg(written("svg", x)) for x in (0, 3e-5, 0.01))
    assert same.svg(one, one)
    assert one != two and same.svg(one, two) and same.svg(two, one)
    assert same.svg(one, one.replace("#336699", "#356799"))
    others = (
        same.plain_svg(written("svg", colour="#446699")),
        same.plain_svg(written("svg", text="b")),
    )
    more, less = one.replace("</svg>", "<g></g></svg>"), one.replace("#336699", "none", 1)
    for other in (three, *others, more, less, ""):
        assert not same.svg(one, other)


def png(array):
    file = io.BytesIO()
    PIL.Image.fromarray(array).save(file, format="png")
    return file.getvalue()


def test_pictures_are_the_same_up_to_a_little_antialiasing():
    grey = np.full((100, 100, 3), 128, dtype=np.uint8)
    few, one, much, many = grey.copy(), grey.copy(), grey.copy(), grey.copy()
    few[:5, :20, 0] += 5
    one[0, 0, 0] += 6
    much[40:60, 40:60] = 0
    many[:50] += 3
    assert same.picture(png(grey), png(grey)) and same.picture(png(grey), png(few))
    for other in (one, much, many, grey[:99]):
        assert not same.picture(png(grey), png(other))
    assert same.picture(png(grey), png(one), 255, 0.005)
    assert not same.picture(png(grey), png(much), 255, 0.005)


def test_pictures_by_matplotlib():
    one = written("png")
    assert same.picture(one, written("png", 1e-9))
    assert not same.picture(one, written("png", 0.05))
    assert not same.picture(one, written("png", text="b"))
