"""The explorer without its page: choices and links, nets, sessions, looks, small drawings."""

import importlib.util
import io as streams
import re
import tempfile
import xml.etree.ElementTree as ET
from dataclasses import asdict
from itertools import chain, combinations, pairwise, product

import igl
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.image import imread
from scipy.interpolate import CubicSpline

from inetlib import design, examples, io, loxodrome, measure, mesh, parallelogram, plot, surfaces
from inetlib.explorer import choices, look, nets, plates, session
from inetlib.explorer.choices import Choice, changed, link, parse
from inetlib.explorer.session import Session

NUMBERS = {k: x for k, x in choices.ALLOWED.items() if isinstance(x, choices.Range)}
NUMBERS = NUMBERS | {"bend": choices.BEND_ROLLED}
RADII = NUMBERS.pop("radii")
SWITCHES = [k for k, x in choices.ALLOWED.items() if x is choices.SWITCH]
PICKED, FAMILIES = choices.OPTIONS, choices.FAMILIES
ANGLES = (60, 45), (75, 110), (120, 50)
EXTREME = tuple(product((0.01, 1, 90, 179, 179.99), repeat=2))
FOUR = tuple(product((("u", "v"), FAMILIES), (False, True)))  # families, parallelograms
each_layout = pytest.mark.parametrize(("families", "parallelograms"), FOUR)


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """Saved pictures are coarse here, and quick."""
    monkeypatch.setattr(look, "PIXELS", 200)


def numbers(low, high, step, unit, open, whole):
    """A strategy: all allowed values of a number."""
    if whole:
        return st.integers(low, high)
    edge = choices.EDGE if open else 0
    return st.floats(low + edge, high - edge)


ALLOWED = {
    **{name: st.sampled_from(list(options)) for name, options in PICKED.items()},
    **{name: numbers(*bounds) for name, bounds in NUMBERS.items()},
    **dict.fromkeys(SWITCHES, st.booleans()),
    "families": st.lists(st.sampled_from(FAMILIES), unique=True).map(tuple),
    "radii": st.tuples(*[numbers(*RADII)] * 7),
}
SIMPLE = st.sampled_from([None, True, 0, 1.5, -1, "", "u", "60", "x", 10**400, float("nan")])
JSON = SIMPLE | st.lists(SIMPLE, max_size=8) | st.lists(st.lists(SIMPLE, max_size=2), max_size=2)


@given(st.fixed_dictionaries(ALLOWED))
def test_allowed_values_are_taken_and_a_link_keeps_all_that_the_kind_uses(values):
    choice, problems = changed(Choice(), **values)
    rolled = values["surface"] == "rolled"
    can_bend = rolled or values["bend"] <= 90
    assert [p.split()[0] for p in problems] == ([] if can_bend else ["bend"])
    for name in set(values) - {"families", "theta0", "bend"}:
        assert getattr(choice, name) == values[name]
    assert set(choice.families) == set(values["families"])
    assert choice.theta0 == values["theta" if values["lock"] else "theta0"]
    assert choice.bend == (values["bend"] if can_bend else Choice().bend)
    names = [pair.split("=")[0] for pair in link(choice).split("&")]
    used = {"kind", "theta", "theta0", "lock", *choices.USES[choice.kind], *choices.SHOWN}
    assert sorted(names) == sorted(used)  # each once
    for text in (link(choice), "?" + link(choice)):
        again, problems = parse(text)
        assert problems == [] and link(again) == link(choice)
        assert all(getattr(again, name) == getattr(choice, name) for name in names)


def refused(name, value, before=None):
    """The sentence by which a value is refused; the choice stays as it was."""
    before = before or changed(Choice(), theta=50, m=9, surface="rolled", families="u,d2")[0]
    after, problems = changed(before, **{name: value})
    assert after == before
    assert len(problems) == 1 and "\n" not in problems[0] and len(problems[0]) < 160
    return problems[0]


@pytest.mark.parametrize("name", NUMBERS)
def test_a_wrong_number_is_refused_in_a_sentence_with_its_name_itself_and_the_range(name):
    low, high, _, _, open, whole = NUMBERS[name]
    outside = [low, high] if open else [low - 1, high + 1]
    fractions = [low + 2.5, f"{high - 0.5}"] if whole else []
    for value in ["nan", float("inf"), "-inf", "1e999", 1e9, "abc", "", *outside, *fractions]:
        sentence = refused(name, value)
        assert sentence.startswith(f"{choices.WORDS.get(name, name)} = {str(value)!r}: ")
        assert re.findall(r"-?\d+", sentence.split(": ")[1]) == [str(low), str(high)]
        assert ("whole" in sentence) is whole


@pytest.mark.parametrize("name", [*PICKED, *SWITCHES])
def test_unknown_options_and_half_switches_are_refused_with_all_the_known_ones(name):
    for value in ("", "cube", "Plane", " plane", "plane,exp", "yes", "2", "-1", "nothing", 2):
        sentence = refused(name, value)
        assert sentence.startswith(f"{name} = {str(value)!r}: ")
        assert all(option in sentence for option in PICKED.get(name, ["1 or 0"]))
    if name in SWITCHES:
        for text, state in (("1", True), ("true", True), ("0", False), ("False", False)):
            assert getattr(changed(Choice(), **{name: text})[0], name) is state


def test_families_come_in_one_order_and_may_be_none_but_no_others():
    for value in ("w", "u,w", "u v", ["u", "D1"], ["u,v"]):
        assert "u, v, d1, d2" in refused("families", value)
    for some in chain.from_iterable(combinations(FAMILIES, k) for k in range(5)):
        backwards = some[::-1]
        for value in (backwards, list(backwards), ",".join(backwards)):
            assert changed(Choice(), families=value) == (Choice(families=some), [])


def test_a_profile_is_a_name_or_a_row_a_list_or_a_text_of_seven_radii_in_their_range():
    for name, radii in choices.PROFILES.items():
        for value in (name, radii, list(radii), ",".join(map(str, radii))):
            assert changed(Choice(), radii=value) == (Choice(radii=radii), [])
    for value in chain(*(((1.0,) * k, ",".join(["1"] * k)) for k in (0, 1, 6, 8, 700))):
        sentence = refused("radii", value)
        assert "radii" in sentence and "7 numbers" in sentence
        assert all(name in sentence for name in choices.PROFILES)
    for value in ("0", "0.0499", "3.01", "nan", "-1", "thick", ""):
        sentence = refused("radii", f"1,1,{value},1,1,1,1")
        assert repr(value) in sentence and "from 0.05 to 3" in sentence and "radius" in sentence


@pytest.mark.parametrize("name", ALLOWED)
def test_long_and_hostile_values_are_shortened_and_made_harmless(name):
    for start in ("9", "x", "<script>alert(1)</script>", "\n\r\x1b[2J", "7,"):
        sentence = refused(name, (start * 4000)[:9000])
        assert name == "radii" or repr(start[0])[1:-1] in sentence
        assert sentence.isprintable()
        problems = parse(f"?{name}={start}" + "z" * 9000)[1]
        assert len(problems) == 1 and len(problems[0]) < 160


def test_each_wrong_name_or_value_has_a_sentence_of_its_own_and_the_good_ones_are_taken():
    for name in ("colour", "Theta", "", "__class__", "theta "):
        assert name in refused(name, "1")
        choice, (problem,) = parse(f"{name}=1&n=7")
        assert choice == Choice(n=7) and repr(name) in problem
    locked = changed(Choice(), theta=50, lock=True)[0]
    assert changed(locked, theta=180)[0] == changed(locked, theta0=180)[0] == locked
    choice, problems = changed(Choice(), theta=0, m="2.5", n="4", kind="cube", shade="1")
    assert choice == Choice(n=4, shade="deviation")  # an old link
    assert [p.split()[0] for p in problems] == ["theta", "m", "kind"]


@given(st.dictionaries(st.sampled_from(sorted(ALLOWED)), JSON, min_size=1))
def test_whatever_json_a_browser_sends_is_taken_or_refused(values):
    choice, problems = changed(Choice(), **values)
    assert len(problems) <= len(values) and all(isinstance(p, str) for p in problems)
    assert changed(Choice(), **asdict(choice)) == (choice, [])


def test_an_angle_may_be_written_as_on_paper_and_any_number_with_a_comma():
    for text in ("60,5", "60.5\u00b0", " 60,5 deg", "60.5 degrees", "60,5\u00b0 "):
        assert changed(Choice(), theta=text) == (Choice(theta=60.5), [])
    assert changed(Choice(), px="-0,25") == (Choice(px=-0.25), [])
    for name, value in (("theta", "6,0,5"), ("theta", "deg"), ("m", "12\u00b0"), ("px", "1 deg")):
        assert f"{value!r}: a " in refused(name, value)


def test_a_net_is_named_after_what_it_is_made_from_and_its_unit_is_said(tmp_path):
    names = {
        "catenoid": {"kind": "isothermal"},
        "helicoid": {"kind": "isothermal", "bend": 90},
        "minimal_image": {"kind": "isothermal", "bend": 20, "moebius": 1},
        "sphere": {"kind": "isothermal", "surface": "sphere"},
        "barrel": {"kind": "revolution", "radii": "barrel"},
        "revolution": {"kind": "revolution", "radii": "1,1,1,1,1,1,1.1"},
        "square": {"map": "square"},
        "patch": {"kind": "freeform"},
        "saddle": {"kind": "cover", "source": "saddle"},
    }
    for name, values in names.items():
        made = Session()
        assert made.change(**values) == [] and made.name == name and "no unit" in made.unit
    made = Session(net=surfaces.freeform_patch(3, 3))
    assert made.name == "net" and "no unit" in made.unit
    path = tmp_path / "my roof.obj"
    io.write(path, *examples.wavy_roof(6))
    made = Session(io.surface(path), path)
    assert made.name == "my roof" and "my roof.obj" in made.unit
    made.change(kind="plane")
    assert made.name == "exp" and "no unit" in made.unit


def test_each_kind_opens_with_its_own_size_unless_one_is_asked_for():
    def sizes(choice):
        return choice.m, choice.n

    first = {kind: changed(Choice(), kind=kind)[0] for kind in PICKED["kind"]}
    assert len(set(map(sizes, first.values()))) == 4  # covers have none
    for kind, other in product(PICKED["kind"], repeat=2):
        assert sizes(changed(first[kind], kind=other)[0]) == sizes(first[other])
        kept = changed(changed(first[kind], m=9)[0], kind=other)[0]
        assert sizes(kept) == (9, first[other].n)
        assert sizes(changed(first[kind], kind=other, n=7)[0]) == (first[other].m, 7)
    bent = changed(Choice(), kind="isothermal", surface="rolled")[0]
    assert bent.bend > 180 and changed(bent, surface="minimal")[0].bend == Choice().bend
    assert changed(bent, surface="rolled")[0] == bent


@pytest.mark.parametrize(
    ("locked", "values", "angles", "lock"),
    [
        (False, {"lock": "1"}, (50, 50), True),  # theta leads
        (False, {"lock": True, "theta0": 80}, (80, 80), True),
        (False, {"lock": True, "theta": 80, "theta0": 20}, (80, 80), True),
        (True, {"theta": "80"}, (80, 80), True),
        (True, {"theta0": "80"}, (80, 80), True),
        (True, {"theta": 80, "theta0": 20}, (80, 80), True),
        (True, {"lock": False}, (50, 50), False),
        (True, {"lock": False, "theta0": 20}, (50, 20), False),
        (True, {"m": 7}, (50, 50), True),
        (False, {"theta": 80}, (80, 70), False),
        (False, {"theta0": 80}, (50, 80), False),
    ],
)
def test_with_the_lock_on_one_angle_takes_the_other_along(locked, values, angles, lock):
    before = changed(Choice(), theta=50, theta0=50 if locked else 70, lock=locked)[0]
    after, problems = changed(before, **values)
    assert problems == []
    assert (after.theta, after.theta0) == angles and after.lock is lock


@given(st.lists(st.fixed_dictionaries({}, optional=ALLOWED), max_size=4))
def test_locked_angles_are_equal_and_only_sheets_are_bent_beyond_90_degrees(changes):
    choice = Choice()
    for values in changes:
        choice, problems = changed(choice, **values)
        assert problems == [] or [p.split()[0] for p in problems] == ["bend"]
        assert problems == [] or (values["bend"] > 90 and choice.surface != "rolled")
        assert choice.theta == choice.theta0 or not choice.lock
        assert choice.bend <= (350 if choice.surface == "rolled" else 90)


@pytest.mark.parametrize("other", ["minimal", "sphere"])
def test_the_angle_of_bending_is_clamped_when_the_sheet_is_left(other):
    bent = changed(Choice(), surface="rolled", bend=300)[0]
    assert bent.bend == 300
    assert changed(bent, surface=other)[0].bend == 90
    choice, (sentence,) = changed(Choice(surface=other), bend=300)
    assert choice == Choice(surface=other) and "from 0 to 90\u00b0" in sentence
    assert changed(Choice(surface=other), bend=300, surface="rolled")[0].bend == 300
    assert changed(bent, theta=20)[0].bend == 300


PAIRS = st.lists(st.tuples(st.sampled_from(sorted(ALLOWED)) | st.text(max_size=5), st.text()))


@given(st.text() | PAIRS.map(lambda pairs: "?" + "&".join(f"{a}={b}" for a, b in pairs)))
def test_any_text_at_all_is_read_as_a_choice_and_sentences(text):
    choice, problems = parse(text)
    assert all(problem.isprintable() and len(problem) < 160 for problem in problems)
    assert changed(Choice(), **asdict(choice)) == (choice, [])


def test_a_link_changes_the_choice_that_is_there_and_may_be_too_long():
    before = changed(Choice(), kind="cover", theta=20, families=("d1",))[0]
    after, problems = parse("theta=70&theta=71&parallelograms=1", before)  # the last word counts
    assert problems == []
    assert asdict(after) == asdict(before) | {"theta": 71.0, "parallelograms": True}
    choice, (problem,) = parse("x" * 3000 + "=1")
    assert choice == Choice() and len(problem) < 60
    choice, problems = parse("&".join(f"a{k}=1" for k in range(100_000)) + "&theta=20")
    assert choice == Choice() and 0 < len(problems) < 1000  # the rest is not looked at


def test_a_link_may_say_how_the_page_looked_and_nonsense_is_no_camera():
    query = "kind=revolution&m=9&dark=1&camera=-20,45.5,0,0.89,-0.1,0.1,0.9"
    assert parse(query) == parse("kind=revolution&m=9")
    assert choices.seen(query) == (True, [-20, 45.5, 0, 0.89, -0.1, 0.1, 0.9])
    assert choices.seen("dark=0") == (False, []) and choices.seen("m=9") == (None, [])
    for wrong in ("", "1,2,3", "1,2,3,0,5,6,7", "1,2,3,-4,5,6,7", "nan,2,3,4,5,6,7", "x" * 9):
        assert choices.seen(f"dark=2&camera={wrong}") == (None, [])


OPENED = """
kind=plane&theta=33.3&theta0=141.7&lock=0&map=moebius&m=9&n=7&px=0.25&py=2 63 4.32344495
kind=plane&map=exp&m=9&n=7&families=d1,d2&parallelograms=0&shade=1 63 14.4569748
kind=isothermal&theta=75&surface=minimal&m=9&n=7&bend=45&moebius=1&px=-1.4&py=0.6 63 11.0020908
?kind=isothermal&surface=rolled&m=9&n=7&bend=300&moebius=0&pz=0.3 63 4.27546958
kind=revolution&theta=70&lock=1&m=9&n=7&radii=0.7,0.95,1.08,1.12,1.08,0.95,0.7 63 17.1879575
kind=freeform&theta=60&theta0=45&m=5&n=4 20 0.869020242
kind=cover&source=saddle&quads=60&direction=20.5&trim=0 56 6.02313761
"""  # links of an earlier version, the number of faces, and the norm of V


@pytest.mark.parametrize("line", OPENED.strip().splitlines())
def test_links_of_an_earlier_version_open_the_same_nets(line):
    query, faces, size = line.split()
    choice, problems = parse(query)
    V, Q, *_ = nets.make(choice)
    assert problems == [] and len(Q) == int(faces)
    assert np.linalg.norm(V) == pytest.approx(float(size), rel=1e-8)


EXACT = {
    **{f"{name} map": {"map": name} for name in ("identity", "square", "exp")},
    "rolled": {"kind": "isothermal", "surface": "rolled"},
    "revolution": {"kind": "revolution"},
}
SAMPLED = {
    "inverse map": {"map": "inverse"},
    "moebius map": {"map": "moebius", "px": -1.4, "py": 0.6},
    **{name: {"kind": "isothermal", "surface": name} for name in ("minimal", "sphere")},
    **{
        f"{name}, inverted": {"kind": "isothermal", "surface": name, "moebius": True}
        for name in PICKED["surface"]
    },
}
CROSSING = (2.5, 0.05, 2.5, 0.05, 2.5, 0.05, 2.5)  # radii of a profile that crosses its axis
POLE = {"px": 0.1, "py": 0.1, "pz": 3.0}  # away from all of these surfaces
CONSTRUCTED = EXACT | SAMPLED
each_constructed = pytest.mark.parametrize("name", CONSTRUCTED)


def built(seen=None, **values):
    """A session with the net of these values; seen: of the steps of a search."""
    made = Session()
    assert made.change(**values) == []
    if made.must_search:
        made.search(made.begin(), seen)
    else:
        made.construct()
    assert made.problem == "" and made.run is None
    return made


def off(V, Q, angles):
    """The largest deviations of both angles, degrees."""
    found = np.degrees(measure.angles(V, Q))
    return np.abs(found - np.reshape(angles, (2, 1))).max(axis=1)


def same(words, V, Q):
    """Whether three lines of Python make exactly this net."""
    assert len(words.splitlines()) == 3
    names = {}
    exec(words, names)
    return np.array_equal(names["V"], V) and np.array_equal(names["Q"], Q)


@pytest.mark.parametrize("angles", ANGLES)
@pytest.mark.parametrize("name", EXACT)
def test_exact_nets_have_both_angles_to_a_billionth_of_a_degree(name, angles):
    found = built(theta=angles[0], theta0=angles[1], m=14, n=11, **EXACT[name])
    assert off(found.V, found.Q, angles).max() < 1e-9
    assert found.message.startswith("exact")


@pytest.mark.parametrize("angles", ANGLES)
@pytest.mark.parametrize("name", SAMPLED)
def test_the_angles_of_sampled_nets_are_off_by_the_square_of_the_edge(name, angles):
    asked = {"theta": angles[0], "theta0": angles[1]} | POLE | SAMPLED[name]
    coarse, fine = (built(m=k, n=k, **asked) for k in (24, 48))
    ratio = off(coarse.V, coarse.Q, angles) / off(fine.V, fine.Q, angles)
    assert np.all((ratio > 3) & (ratio < 5))
    assert "exact" not in fine.message


DIGITS = {"theta": 60.12345678901234, "theta0": 100 / 3, "bend": 200 / 7, "px": 1 / 7, "pz": 20 / 7}


@each_constructed
def test_three_lines_of_python_make_exactly_the_same_net_and_keep_all_digits(name):
    names = "theta", "theta0", "m", "n", "bend"
    rows = (60, 60, 3, 1, 0), (33.3, 141.7, 9, 14, 90), (90, 90, 5, 5, 7)
    asked = [dict(zip(names, row, strict=True)) | {"radii": "hourglass"} | POLE for row in rows]
    for values in (*asked, {"m": 5, "n": 5} | DIGITS):
        found = built(**CONSTRUCTED[name] | values)
        assert same(found.code(), found.V, found.Q)
        again, problems = parse(link(found.choice))
        assert problems == []
        assert np.array_equal(nets.make(again)[0], found.V)


@each_constructed
def test_extreme_angles_make_a_net_or_a_sentence_and_the_former_net_stays(name):
    made = built(m=6, n=5, **CONSTRUCTED[name])
    counts = {True: 0, False: 0}
    for theta, theta0 in EXTREME:
        former, said = (made.V, made.Q, made.shown), made.message
        assert made.change(theta=theta, theta0=theta0) == []
        made.construct()
        counts[bool(made.problem)] += 1
        if made.problem:
            assert made.problem.startswith("no net: ")
            now = made.V, made.Q, made.shown
            assert all(a is b for a, b in zip(former, now, strict=True)) and made.message == said
        else:
            assert made.shown == made.choice and np.isfinite(made.V).all()
            assert np.isfinite(measure.angles(made.V, made.Q)).all()
        assert made.report.quads == len(made.Q)
    assert counts[False] > counts[True]


def test_the_grid_fills_the_unit_disk_and_every_map_is_the_one_that_its_name_says():
    for theta, theta0 in ANGLES:
        V = built(map="identity", theta=theta, theta0=theta0, m=12, n=17).V
        assert np.linalg.norm(V, axis=1).max() == pytest.approx(1, abs=1e-4)  # rounded to 5 digits
        assert np.abs(V.mean(axis=0)).max() < 1e-4
    z = {}
    for name in PICKED["map"]:
        V = built(map=name, m=8, n=8, px=0.25, py=-1.5).V
        z[name] = V[:, 0] + 1j * V[:, 1]
    before = {
        "square": np.sqrt(z["square"]),  # the disk lies in the right half plane
        "inverse": 1 / z["inverse"],
        "moebius": 1 / z["moebius"] + (0.25 - 1.5j),
        "identity": z["identity"],
    }
    for name, back in before.items():
        steps = np.diff(back.reshape(9, 9), axis=0), np.diff(back.reshape(9, 9), axis=1)
        assert all(np.abs(d - d[0, 0]).max() < 1e-12 for d in steps), name  # a sheared grid
    logarithm = np.log(z["exp"]).reshape(9, 9)
    assert np.abs(np.diff(logarithm, n=2, axis=1)).max() < 1e-12


def test_every_surface_is_the_one_that_its_name_says():
    for values, residual in (
        ({"surface": "sphere"}, lambda x, y, z: x * x + y * y + z * z - 1),
        ({"surface": "minimal", "bend": 0}, lambda x, y, z: np.hypot(x, y) - np.cosh(z)),
        ({"surface": "minimal", "bend": 90}, lambda x, y, z: x * np.cos(z) + y * np.sin(z)),
        (
            {"kind": "revolution", "radii": "1.2,1.05,0.9,0.75,0.6,0.45,0.3"},
            lambda x, y, z: np.hypot(x, y) - 1.2 + 0.3 * z,
        ),
    ):
        x, y, z = built(**{"kind": "isothermal", "m": 9, "n": 7} | values).V.T
        assert np.abs(residual(x, y, z)).max() < 1e-12 and np.ptp(z) > 1, values


@pytest.mark.parametrize("bend", [0, 1, 45, 200, 350])
@pytest.mark.parametrize("angles", [(60, 60), (110, 50), (90, 140)])
def test_the_sheet_is_bent_by_its_angle_from_one_side_to_the_other(bend, angles):
    asked = {"kind": "isothermal", "surface": "rolled", "theta": angles[0], "theta0": angles[1]}
    x, _, z = built(m=12, n=12, bend=bend, **asked).V.T
    far = np.argmax(np.abs(x) + z)
    curvature = 2 * z[far] / (x[far] ** 2 + z[far] ** 2)  # of the circle that touches z = 0 at 0
    turned = np.degrees(np.ptp(np.arctan2(curvature * x, 1 - curvature * z)))
    assert turned == pytest.approx(bend, rel=0.02, abs=1e-9)  # the step v changes a little


@pytest.mark.parametrize("surface", PICKED["surface"])
def test_a_moebius_image_is_inverted_in_the_unit_sphere_around_the_pole(surface):
    asked = {"kind": "isothermal", "surface": surface, "m": 6, "n": 6, **POLE}
    pole = np.array(list(POLE.values()))
    away, found = built(**asked).V - pole, built(moebius=True, **asked).V - pole
    assert np.allclose(found, away / np.sum(away**2, axis=1, keepdims=True), rtol=1e-9)


def test_a_pole_on_a_vertex_and_a_profile_that_crosses_the_axis_are_no_nets():
    made = built(map="identity", m=4, n=4)
    on = made.V[7]
    for values in (
        {"map": "moebius", "px": on[0], "py": on[1]},
        {"kind": "revolution", "radii": CROSSING},
    ):
        assert made.change(**values) == []
        made.construct()
        assert made.problem.startswith("no net: ") and np.array_equal(made.V[7], on)


@pytest.mark.parametrize(
    "values",
    [{"kind": "freeform", "m": 5, "n": 6}]
    + [{"kind": "cover", "source": s, "quads": 60, "direction": 20} for s in examples.SURFACES],
    ids=lambda values: values.get("source", "freeform"),
)
def test_three_lines_of_python_find_exactly_the_same_net(values):
    found = built(theta=70, theta0=50, **values)
    assert off(found.V, found.Q, (70, 50)).max() < 1e-8
    assert found.message.startswith("converged")
    assert same(found.code(), found.V, found.Q)
    assert parse(link(found.choice)) == (found.choice, [])


TRIMMED = {"saddle": "ring", "skylight": "fill", "two_skylights": "ring"}


@pytest.fixture(scope="module", params=TRIMMED)
def trimmed(request):
    """A session with panels to the edge of an example."""
    choice = {"kind": "cover", "source": request.param, "openings": TRIMMED[request.param]}
    return built(theta=70, theta0=50, quads=150, trim=True, **choice)


def area(V, *cells):
    """The area of triangles and quads."""
    return sum(igl.doublearea(*mesh.triangles(V, F)).sum() / 2 for F in cells if len(F))


def test_with_panels_to_the_edge_all_of_the_surface_and_every_side_once_is_drawn(trimmed):
    V, Q, polygons = trimmed.V, trimmed.Q, trimmed.cover.polygons
    assert off(V, Q, (70, 50)).max() < 1e-8 and trimmed.message.startswith("converged")
    texts = plates.numbers(trimmed.report, V, Q)
    assert (texts["quads"], texts["cut"]) == (str(len(Q)), str(len(polygons)))
    plan = look.layout(Q, len(V), ("u", "v"), False, trimmed.cover)
    surface = examples.SURFACES[trimmed.choice.source]()
    whole = area(*surface)
    assert area(V, plan.quads) < 0.9 * whole
    assert area(V, plan.quads, plan.cut) == pytest.approx(whole, rel=0.02)
    sides = edges(np.concatenate([np.stack([x, np.roll(x, -1)]).T for x in [*Q, *polygons]]))
    found = edges(np.concatenate(list(plan.lines.values())))
    assert set(found) >= set(sides) and len(found) == len(set(found))
    for ends in set(found) - set(sides):  # curves that run on to the edge inside a panel
        assert any(set(ends) <= set(panel.tolist()) for panel in polygons)
    rim = set(edges(plan.lines["rim"]))
    free = [side for side in sides if sides.count(side) == 1]
    assert len(rim - set(free)) < 0.05 * len(rim) and set(free) - rim == set()
    loops = [np.stack([x, np.roll(x, -1)]).T for x in mesh.boundary_loops(surface[1])]
    points = V[free].reshape(-1, 3)
    near, _, _ = igl.point_mesh_squared_distance(points, surface[0], np.concatenate(loops))
    assert np.sqrt(near).max() < 1e-9
    assert sorted(plan.lines) == ["rim", "u", "v"]
    palette = look.fills(plan, look.LIGHT)[[0, -1]]
    assert len(np.unique(palette, axis=0)) == 2  # one sees which are cut
    shade = np.full((len(Q), 3), 7, dtype=np.uint8)
    for one in (plan, look.layout(Q, len(V), FAMILIES, True, trimmed.cover)):
        rgb = look.fills(one, look.LIGHT, shade)
        shaded = len(one.quads) or len(one.triangles)  # of all else the parallelograms stand out
        assert np.all(rgb[:shaded] == 7) and np.all(rgb[shaded : -len(one.cut)] > 7)
        assert np.all(rgb[-len(one.cut) :] == palette[1])


def test_panels_to_the_edge_are_in_the_code_the_link_and_in_files(trimmed, tmp_path):
    names = {}
    assert same(trimmed.code(), trimmed.V, trimmed.Q)
    exec(trimmed.code(), names)
    polygons = [polygon.tolist() for polygon in trimmed.cover.polygons]
    assert [polygon.tolist() for polygon in names["polygons"]] == polygons
    assert parse(link(trimmed.choice)) == (trimmed.choice, [])
    path = tmp_path / "net.obj"
    path.write_bytes(trimmed.save(".obj"))
    V, faces = io.read(path)
    assert np.array_equal(V, trimmed.V)
    assert [list(face) for face in faces] == [*trimmed.Q.tolist(), *polygons]
    lines = [row.split()[1:] for row in path.read_text().splitlines() if row.startswith("l ")]
    ends = {int(line[k]) - 1 for line in lines for k in (0, -1)}
    plan = look.layout(trimmed.Q, len(V), (), False, trimmed.cover)
    assert len(ends & set(plan.lines["rim"].ravel().tolist())) > 20  # the curves reach the edge
    if trimmed.choice.source == "saddle":
        assert plot.GREY in trimmed.save(".svg", -1.0, 0.5).decode()


@pytest.mark.parametrize("source", examples.SURFACES)
def test_a_cover_opens_with_panels_to_its_edge_and_a_link_can_say_that_it_shall_not(source):
    found = {}
    for query in ("", "&trim=0", "&theta=2"):
        choice, problems = parse(f"kind=cover&source={source}{query}")
        found[query] = made = built(**asdict(choice))
        assert problems == [] and not made.is_faulty and same(made.code(), made.V, made.Q)
        assert parse(link(made.choice)) == (made.choice, [])
    panels = [len(made.report.polygons) for made in found.values()]
    assert panels[0] > 60 and panels[1:] == [0, 0]
    whole, opens = found["&trim=0"].report, found[""].report
    assert opens.covered > 0.99 > whole.covered + 0.05 and opens.quads > 0.95 * whole.quads
    assert ["slivers" in made.message for made in found.values()] == [False, False, True]
    texts = [plates.numbers(made.report, made.V, made.Q) for made in found.values()]
    assert [x["faces"] for x in texts] == ["whole faces", "faces", "faces"]
    assert [x["others"] for x in texts] == ["panels cut at the edge", "", ""]


def test_only_a_surface_with_one_hole_can_be_a_ring_or_have_an_opening(tmp_path):
    made, asked = Session(), {}
    for source in PICKED["source"]:
        made.change(kind="cover", source=source)
        if source != "file":
            nets.ground(made.choice).result(60)
        asked[source] = made.has_one_hole
    assert [source for source, one in asked.items() if one] == ["saddle", "skylight"]
    made.change(kind="plane", source="saddle")
    assert made.has_one_hole is False
    path = tmp_path / "ring.obj"
    io.write(path, *examples.saddle_with_hole(8))
    made = Session(io.surface(path), path)
    nets.ground(made.choice, made.surface).result(60)
    assert made.has_one_hole is True
    for openings, same_as in (("ring", None), ("fill", "fill")):
        found = built(kind="cover", source="saddle", quads=60, openings=openings, trim=False)
        angles = np.radians([60, 60])
        V = design.cover(*examples.saddle_with_hole(), *angles, 60, openings=same_as).V
        assert np.array_equal(found.V, V)


@pytest.mark.parametrize("name", ["my roof.obj", 'it\'s "mine".ply', "a\\b {c}.off"])
def test_a_surface_from_a_file_is_covered_and_named_in_the_code(tmp_path, name):
    path = tmp_path / name
    io.write(path, *examples.wavy_roof(12))
    found = Session(io.surface(path), path)
    assert (found.choice.kind, found.choice.source) == ("cover", "file")
    found.change(quads=60, theta=80)
    found.search(found.begin())
    assert off(found.V, found.Q, (80, 60)).max() < 1e-8
    assert same(found.code(), found.V, found.Q)


WHOLE = {"kind": "cover", "trim": False}


@pytest.mark.parametrize("last", [None, 0, 1, 2, 999])
@pytest.mark.parametrize("values", [{"kind": "freeform", "m": 6, "n": 6}, WHOLE])
def test_a_search_begins_with_the_start_stops_after_the_step_under_way_and_keeps_the_best_net(
    values, last
):
    made, way = Session(), []
    made.change(theta=100, theta0=40, quads=60, **values)

    def seen(V, Q, step):
        assert step == len(way)
        way.append((off(V, Q, (100, 40)).max(), V.copy()))
        if step == last:
            made.stop()

    run = made.begin()
    if last is None:  # before it began
        made.stop()
    made.search(run, seen)
    if last is None and made.choice.kind == "cover":  # there is no net yet
        assert not way and made.V is None and "stopped" in made.problem and made.can_search
        return
    whole = last == 999
    assert len(way) == (0 if last is None else made.steps + 1 if whole else last + 1)
    assert run.stopped is not whole and made.run is None and made.problem == ""
    assert ("stopped" in made.message) is not whole and made.shown == made.choice
    if way:
        assert np.array_equal(made.V, min(way, key=lambda net: net[0])[1])
    if made.choice.kind == "freeform":
        first = way[0][1] if way else made.V
        assert np.array_equal(first, surfaces.freeform_patch(6, 6)[0])


def test_a_step_that_comes_late_does_not_take_the_place_of_the_end(monkeypatch):
    made, known = Session(), measure.planarity
    made.change(kind="freeform", m=4, n=4)
    run = made.begin()

    def late(*net):  # the search ends while the step is measured
        monkeypatch.setattr(measure, "planarity", known)
        made.search(run)
        return known(*net)

    monkeypatch.setattr(measure, "planarity", late)
    assert not made.on_the_way(run, *surfaces.freeform_patch(4, 4))
    assert made.message.startswith("converged") and made.run is None


def test_what_a_search_finds_is_shown_when_it_is_taken():
    made = built(m=4, n=4)
    former = made.V, made.Q, made.shown, made.report, made.message
    made.change(kind="freeform")
    run = made.begin()
    found = made.find(run)
    assert made.run is run
    now = made.V, made.Q, made.shown, made.report
    assert all(a is b for a, b in zip(former[:4], now, strict=True))
    assert made.message == former[4] and made.take(run, found) and made.run is None
    assert made.message.startswith("converged") and made.shown.kind == "freeform"
    assert not made.take(run, found)


def test_what_an_older_run_finds_is_forgotten():
    made = built(m=4, n=4)
    former, newer = made.V, []
    made.change(kind="freeform", m=4, n=4)
    old = made.begin()

    def seen(V, Q, step):
        if step == 1:
            made.change(m=5)
            newer.append(made.begin())
        assert made.on_the_way(old, V, Q) is not bool(newer)

    made.search(old, seen)
    assert old.stopped and made.run is newer[0] and not newer[0].stopped
    assert len(made.V) == 25 and made.V is not former  # the step that was shown on the way
    shown = made.V
    made.search(old)  # over: nothing is taken from it
    assert made.V is shown and made.run is newer[0]
    made.search(newer[0])
    assert len(made.V) == 30 and made.run is None and made.shown.m == 5


@pytest.mark.parametrize("former", [True, False])
def test_what_cannot_be_found_becomes_a_problem_and_the_former_net_stays(former):
    made = built(m=4, n=4) if former else Session()
    V, message, said = made.V, made.message, made.report
    made.change(kind="cover", source="file", theta=20)
    made.search(made.begin())
    assert made.problem.startswith("no net: ") and "file" in made.problem and made.run is None
    assert made.V is V and made.message == message and made.report is said
    assert made.must_search and not made.can_search  # it would find the same
    if not former:
        with pytest.raises(ValueError, match="no net"):
            made.save(".obj")
    made.change(kind="plane")
    made.construct()
    assert made.problem == "" and made.V is not None


@pytest.mark.parametrize(
    "values",
    [{"map": "inverse"}, {"kind": "isothermal", "surface": "minimal"}, {"kind": "revolution"}],
)
def test_the_numbers_agree_with_the_judge_and_with_the_corners(values):
    found = built(theta=70, theta0=55, m=9, n=6, **values)
    V, Q = found.V, found.Q
    theta, theta0 = np.degrees(measure.angles(V, Q))
    v1, v2, v3, v4 = V[Q].transpose(1, 0, 2)
    medial = [(v3 + v4 - v1 - v2) / 2, (v4 + v1 - v2 - v3) / 2]
    sizes = np.linalg.norm(medial, axis=2)
    texts = plates.numbers(found.report, V, Q)
    assert (texts.pop("faces"), texts.pop("others")) == ("faces", "")
    said = {name: float(x.replace("\u2212", "-")) for name, x in texts.items()}
    assert said["quads"] == len(Q) and said["flips"] == measure.quality(V, Q).flips
    assert (said["theta"], said["theta0"]) == (70, 55)
    ratios = parallelogram.angles(said["lam"], said["mu"])
    assert np.degrees(ratios) == pytest.approx([70, 55], abs=0.01)  # five digits
    for name, angle, asked in (("theta", theta, 70), ("theta0", theta0, 55)):
        assert said[f"mean_{name}"] == pytest.approx(angle.mean(), abs=1e-6)
        most = np.abs(angle - asked).max()
        assert said[f"{name}_off"] == pytest.approx(most, rel=0.06, abs=1e-12)
    assert (said["size_low"], said["size_high"]) == pytest.approx(
        (sizes.min(), sizes.max()), rel=0.006
    )
    wanted = np.stack([theta - 70, theta0 - 55])
    assert np.allclose(found.deviations(), wanted, atol=1e-12)
    shades = look.shades(np.abs(wanted).max(axis=0)).astype(int)
    found.change(shade="deviation")
    assert np.abs(found.shading()[0] - shades).max() <= 1


def test_a_given_net_stays_whatever_is_chosen_and_is_judged_by_its_mean_angles():
    V, Q = surfaces.freeform_patch(5, 4)
    made = Session(net=(V, Q))
    means = [np.degrees(x.mean()) for x in measure.angles(V, Q)]
    assert (made.choice.theta, made.choice.theta0) == pytest.approx(means)
    said = made.report
    assert np.degrees([said.theta.mean, said.theta0.mean]) == pytest.approx(means)
    assert np.degrees(said.theta.max_deviation) == pytest.approx(off(V, Q, means)[0])
    for values in ({"kind": "freeform"}, {"kind": "plane"}, {"theta": 20}):
        assert made.change(**values) == [] and not made.must_search
        made.construct()
        assert np.array_equal(made.V, V) and np.array_equal(made.Q, Q) and made.report is said
    assert made.code().startswith("#")
    for W in (V[:, :2], V[:-1], np.where(np.arange(30)[:, None] == 5, np.nan, V), 0 * V):
        with pytest.raises(ValueError):
            Session(net=(W, Q))
    with pytest.raises(ValueError, match=r"^no net: the faces at the edge 1-0 are oriented"):
        Session(net=(V, [*Q, [Q[0, 0], Q[0, 1], 28, 29]]))


PACKAGES = {".vtp": "pyvista", ".dxf": "ezdxf", ".3dm": "rhino3dm"}


@pytest.fixture
def scratch(tmp_path, monkeypatch):
    """The folder of temporary files, in which nothing must be left."""
    folder = tmp_path / "scratch"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    yield folder
    assert list(folder.iterdir()) == []


@pytest.fixture(scope="module")
def vase():
    """A small web."""
    return built(kind="revolution", m=7, n=4)


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".off", ".vtp", ".glb", ".dxf", ".3dm"])
def test_saved_nets_are_the_files_that_io_writes(vase, scratch, tmp_path, suffix):
    pytest.importorskip(PACKAGES.get(suffix, "numpy"), reason="an optional package is missing")
    path, saved = tmp_path / f"net{suffix}", vase.save(suffix)
    io.write(path, vase.V, vase.Q, "all" if suffix in io.WITH_CURVES else None)
    written = path.read_bytes()
    dated = suffix in (".dxf", ".3dm")
    assert abs(len(saved) - len(written)) < 99 if dated else saved == written
    path.write_bytes(saved)
    if suffix in (".obj", ".ply", ".off", ".vtp"):
        assert all(map(np.array_equal, io.read(path), (vase.V, vase.Q)))


@each_layout
def test_saved_drawings_are_xml_and_the_same_each_time(
    scratch, monkeypatch, families, parallelograms
):
    monkeypatch.setattr(look, "PIXELS", 200)  # quick
    drawn = set()
    for shade in PICKED["shade"]:
        looks = {"families": families, "parallelograms": parallelograms, "shade": shade}
        data = built(map="inverse", m=4, n=3, **looks).save(".svg", 0.3, 0.5)
        assert ET.fromstring(data).tag.endswith("svg")
        assert built(map="inverse", m=4, n=3, **looks).save(".svg", 0.3, 0.5) == data
        for name, colour in plot.COLOURS.items():
            assert (colour.encode() in data) is (name in families)
        drawn.add(data)
    assert len(drawn) == len(PICKED["shade"])


def test_a_saved_picture_decodes_and_shows_the_net_in_the_middle(vase, scratch):
    data = vase.save(".png", -0.9, 0.4)
    image = imread(streams.BytesIO(data), format="png")
    ink = (image[..., :3] < 0.99).any(axis=2)
    assert min(ink.shape) > 500
    for axis in (0, 1):
        some = np.flatnonzero(ink.any(axis=1 - axis))
        assert abs((some[0] + some[-1]) / 2 / ink.shape[axis] - 0.5) < 0.05
    assert vase.save(".png", -0.9, 0.4) == data
    assert vase.save(".png", 0.5, 1.4) != data


def test_all_formats_are_offered_others_refused_and_missing_packages_named(
    vase, scratch, monkeypatch
):
    known = {".svg", ".png", ".obj", ".ply", ".off", ".stl", ".vtp", ".glb", ".dxf", ".3dm"}
    assert set(session.SAVED) == known
    for suffix in ("", "obj", ".step", ".OBJ", ".py", "/../x.obj", "net.obj"):
        with pytest.raises(ValueError, match=r"\.svg.*\.obj"):
            vase.save(suffix)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert {s: io.missing(s) for s in session.SAVED if io.missing(s)} == PACKAGES
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: name)
    assert not any(map(io.missing, session.SAVED))


LOOKED = {
    "skew patch": surfaces.freeform_patch(5, 4),
    "closed web": loxodrome.web(surfaces.sphere_profile(), 1.2, 0.9, 6, 3)[:2],
    "one quad": (
        np.array([[0, 1, 0], [0, 0, 0.2], [1, 0, 0], [1.5, 1.2, 0]]),
        mesh.grid_quads(1, 1),
    ),
}
each_net = pytest.mark.parametrize("net", LOOKED.values(), ids=LOOKED)


def edges(pairs):
    """Segments as sorted pairs of vertex numbers, sorted."""
    return sorted(map(tuple, np.sort(pairs, axis=1).tolist()))


def filled(plan, W):
    """(points, triangles) of all that is filled."""
    quads = plan.quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    return W, np.concatenate([quads, plan.triangles]).astype(np.int64)


@each_net
@each_layout
def test_every_edge_is_drawn_once_in_the_family_of_its_polyline_over_cells_of_the_layout(
    net, families, parallelograms
):
    V, Q = net
    plan = look.layout(Q, len(V), families, parallelograms)
    assert tuple(plan.lines) == families
    for name, lines in zip("uv", mesh.polylines(Q), strict=False):
        pieces = [pair for line in lines for pair in pairwise(line)]
        assert edges(plan.lines[name]) == edges(pieces)
    inner = len(families) > 2
    assert len(plan.quads) == (len(Q) if parallelograms or not inner else 0)
    assert len(plan.triangles) == (4 * len(Q) if parallelograms or inner else 0)
    W = look.points(V, plan)
    assert np.array_equal(W[: len(V)], V)
    every = np.concatenate([a.ravel() for a in (plan.quads, plan.triangles, *plan.lines.values())])
    assert every.max() < len(W)
    if parallelograms:
        board = mesh.checkerboard(V, Q)
        assert np.allclose(W[plan.quads], board.V[board.black], atol=1e-15)
    for palette in (look.LIGHT, look.DARK):
        rgb = look.fills(plan, palette)
        assert rgb.shape == (len(plan.quads) + len(plan.triangles), 3) and rgb.dtype == np.uint8
        # The parallelograms alone differ from the rest:
        assert len(np.unique(rgb, axis=0)) == (2 if parallelograms else 1)
        assert len(np.unique(rgb[: len(plan.quads)], axis=0)) <= 1


@each_net
@pytest.mark.parametrize("parallelograms", [False, True])
def test_diagonals_run_through_the_mean_of_the_corners_on_what_is_filled(net, parallelograms):
    V, Q = net
    plan = look.layout(Q, len(V), FAMILIES, parallelograms)
    W = look.points(V, plan)
    for name, ends in (("d1", (0, 2)), ("d2", (1, 3))):
        pairs = plan.lines[name]
        count = np.bincount(pairs.ravel(), minlength=len(W))
        expected = np.bincount(Q[:, ends].ravel(), minlength=len(V))  # one end a face
        assert np.array_equal(count[: len(V)], expected)
        middles = W[np.flatnonzero(count[len(V) :] == 2) + len(V)]
        if parallelograms:  # a piece across each of them
            middles = W[pairs[(pairs >= len(V)).all(axis=1)]].mean(axis=1)
        for face in Q:
            assert np.linalg.norm(middles - V[face].mean(axis=0), axis=1).min() < 1e-12
        assert len(pairs) == len(Q) * (3 if parallelograms else 2)
        along = np.linspace(W[pairs[:, 0]], W[pairs[:, 1]], 6)
        near, _, _ = igl.point_mesh_squared_distance(along.reshape(-1, 3), *filled(plan, W))
        assert np.sqrt(near).max() < 1e-9


@each_layout
def test_every_cell_has_the_colour_of_the_face_it_is_cut_from_and_all_fill_it_once(
    families, parallelograms
):
    i, j = np.meshgrid(np.arange(4.0), np.arange(5.0), indexing="ij")
    V, Q = np.stack([i, j, 0 * i], axis=-1).reshape(-1, 3), mesh.grid_quads(3, 4)
    V[:, :2] += np.random.default_rng(0).uniform(-0.05, 0.05, (20, 2))
    place = np.floor(V[Q].mean(axis=1))[:, :2]
    shade = np.concatenate([place, place[:, :1] + 7], axis=1).astype(np.uint8)
    plan = look.layout(Q, len(V), families, parallelograms)
    W = look.points(V, plan)
    middles = [W[cells].mean(axis=1) for cells in (plan.quads, plan.triangles) if len(cells)]
    square = np.floor(np.concatenate(middles))[:, :2]
    rgb = look.fills(plan, look.LIGHT, shade)
    shaded = len(Q) if parallelograms else len(rgb)  # only they are shaded, then
    assert np.array_equal(rgb[:shaded, :2], square[:shaded]) and np.all(rgb[shaded:] > 100)
    a, b, c = W[filled(plan, W)[1]].transpose(1, 0, 2)
    d1, d2 = V[Q[:, 2]] - V[Q[:, 0]], V[Q[:, 3]] - V[Q[:, 1]]
    area, whole = (np.cross(*pair)[:, 2] for pair in ((b - a, c - a), (d1, d2)))
    assert np.all(area > 0) and area.sum() == pytest.approx(whole.sum())


@pytest.mark.parametrize("angles", [(60, 60), (75, 50), (30, 150), (120, 20), (2, 60), (90, 179)])
def test_the_curves_of_slender_quads_are_drawn_like_those_of_more_quads(angles):
    made = built(map="identity", m=4, n=4, theta=angles[0], theta0=angles[1])
    x, y, _ = made.V[made.Q[0]].T
    area = abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    middles = (made.V[made.Q[0]] + np.roll(made.V[made.Q[0]], -1, axis=0)) / 2
    longest = max(np.linalg.norm(middles[k] - middles[k + 2]) for k in (0, 1))
    narrow = (area / longest) ** 2 / area  # beside a square of the same area, squared
    assert look.crowd(100, *angles) == pytest.approx(100 * max(1, 0.5 / narrow))
    if angles in ((60, 60), (75, 50)):
        assert look.crowd(100, *angles) == 100  # nothing changes there
    if angles in ((2, 60), (90, 179)):
        width, many = (look.line_width(x) for x in (600, look.crowd(600, *angles)))
        assert many < width
    pens = [
        float(re.search(rb"stroke-width: ([\d.]+)", built(theta=theta).save(".svg"))[1])
        for theta in (60, 178)
    ]
    assert pens[1] < pens[0] / 2  # in a saved picture, too


def test_shades_darken_with_the_deviation_between_the_ends_of_the_scale():
    brightness = look.shades(np.logspace(-12, 2, 200)).astype(int).sum(axis=1)
    assert np.all(np.diff(brightness) <= 0)
    assert len(np.unique(brightness)) > 50
    assert look.shades(np.array([0.0])).min() > 230  # exact faces are nearly white
    scale = look.scale()  # it names the deviations of its colours
    for colour, words in scale[1:]:
        rgb = look.shades(np.array([float(words.removesuffix("\u00b0"))]))[0]
        assert colour == "rgb({},{},{})".format(*rgb)
    values = [float(words.strip("< \u00b0")) for _, words in scale]
    assert np.allclose(np.diff(np.log10(values[1:])), 1)
    assert scale[0][1].startswith("<") and values[0] == values[1]
    below = look.shades(np.array([values[1] / 10]))[0]
    assert scale[0][0] == "rgb({},{},{})".format(*below)
    assert len({colour for colour, _ in scale}) == len(scale)


MODERATE = list(product((35, 60, 90, 140), (40, 90, 120)))
SVG = "{http://www.w3.org/2000/svg}"


def parsed(text):
    root = ET.fromstring(text)
    assert root.tag == SVG + "svg" and root.get("aria-label")
    return root


def segments(root, kind):
    """The lines of a class: complex (k, 2)."""
    found = [e for e in root.iter(SVG + "line") if e.get("class") == kind]
    values = [[float(e.get(k)) for k in ("x1", "y1", "x2", "y2")] for e in found]
    return np.array(values).reshape(-1, 4) @ np.array([[1, 0], [1j, 0], [0, 1], [0, 1j]])


def polyline(element):
    pairs = [pair.split(",") for pair in element.get("points").split()]
    return np.array([complex(float(x), float(y)) for x, y in pairs])


def between(a, b):
    """The angle between two directions, degrees in (0, 180)."""
    return np.degrees(np.abs(np.angle(b / a)))


def drawn(theta, theta0):
    """The root of the drawn parallelogram and its corners A, B, C, D, by classes alone."""
    root = parsed(plates.parallelogram(*np.radians([theta, theta0])))
    (B, D), (one, two) = segments(root, "u")[0], segments(root, "v")[0]

    def is_side(kind, p, q):
        return any({p, q} == set(ends) for ends in segments(root, kind).tolist())

    A, C = (one, two) if is_side("d1", B, two) else (two, one)
    for kind, p, q in (("d1", B, C), ("d1", A, D), ("d2", B, A), ("d2", C, D)):
        assert is_side(kind, p, q)
    assert len(segments(root, "d1")) == len(segments(root, "d2")) == 2
    return root, (A, B, C, D)


@pytest.mark.parametrize(("theta", "theta0"), [*MODERATE, *EXTREME])
def test_the_drawn_parallelogram_fits_its_box_and_has_both_angles_and_marks_them(theta, theta0):
    root, (A, B, C, D) = drawn(theta, theta0)
    box, centre = list(map(float, root.get("viewBox").split()))[2:], (A + C) / 2
    texts = [complex(float(e.get("x")), float(e.get("y"))) for e in root.iter(SVG + "text")]
    arcs = [polyline(e) for e in root.iter(SVG + "polyline")]
    points = np.concatenate([[A, B, C, D], texts, *arcs])
    points = np.stack([points.real, points.imag], axis=1)
    assert np.all((points >= 0) & (points <= box))
    assert (np.ptp(points[:4], axis=0) / box).max() > 0.6  # and fills it
    if (theta, theta0) in MODERATE:
        assert abs(A - B - (D - C)) < 0.3 and B.imag > A.imag  # A is above B
        assert between(C - B, A - B) == pytest.approx(theta, abs=1)
        assert between(A - centre, D - centre) == pytest.approx(theta0, abs=1)
        for arc, apex, angle in zip(arcs, (B, centre), (theta, theta0), strict=True):
            assert np.ptp(np.abs(arc - apex)) < 0.3
            assert between(arc[0] - apex, arc[-1] - apex) == pytest.approx(angle, abs=2)
        names = [e.text for e in root.iter(SVG + "text")]
        assert names == ["\u03b8", "\u03b8\u2080"]


def bars(root, row):
    """(middles, heights) of the bars of a histogram."""
    found = [e for e in root.iter(SVG + "rect") if e.get("class") == f"bar{row}"]
    get = [[float(e.get(k)) for k in ("x", "width", "height", "y")] for e in found]
    x, width, height, _ = np.array(get).reshape(-1, 4).T
    return x + width / 2, height


def test_the_bars_of_the_histograms_count_the_faces_around_a_common_zero():
    values, count = np.array([-0.37, 0.0, 0.15, 0.3]), np.array([3, 12, 6, 1])  # far apart
    theta = np.repeat(values, count)
    root = parsed(plates.histograms((theta, np.full(9, -0.1)), (60, 45.5)))
    *names, low, zero, high = root.iter(SVG + "text")
    words = ["\u03b8 \u2212 60\u00b0", "\u03b8\u2080 \u2212 45.5\u00b0"]
    assert [e.text for e in names] == words
    reach = float(high.text.strip("\u00b0"))
    assert low.text == f"\u2212{high.text}" and zero.text == "0\u00b0"
    assert reach == 0.5  # the next of 1, 2, 5 times a power of ten
    left, right = float(low.get("x")), float(high.get("x"))
    at = (values / reach + 1) / 2 * (right - left) + left
    x, height = bars(root, 0)
    assert np.abs(x - at).max() < (right - left) / 27
    assert np.allclose(height / height.max(), count / count.max(), atol=0.01)
    x, other = bars(root, 1)
    assert other.max() == height.max()  # both use all of their room
    assert len(x) == 1 and abs(x[0] - (left + right) / 2 + 0.2 * (right - left) / 2) < 5


def test_no_face_falls_out_of_the_histogram_and_exact_nets_have_one_bar_in_the_middle():
    for most in (1, 1 + 5e-13, 2 - 1e-12, 5 + 1e-12, 1e-7, 0.001, 1000, 0.2 + 1e-14):
        spread = most * np.array([-1.0, -0.6, 0.0, 0.5, 1.0])
        for values in (spread, -spread):
            root = parsed(plates.histograms((values, values[1:4]), (60, 60)))
            assert len(bars(root, 0)[0]) == 5 and len(bars(root, 1)[0]) == 3
    root = parsed(plates.histograms((np.zeros(50), np.full(50, 1e-13)), (60, 60)))
    width = float(root.get("viewBox").split()[2])
    for row in (0, 1):
        x, _ = bars(root, row)
        assert len(x) == 1 and x[0] == pytest.approx(width / 2, abs=1)


def test_the_profiles_are_those_of_the_command_line_at_seven_heights():
    assert {*choices.PROFILES} == {*surfaces.PROFILES} - {"torus"}  # which goes down again
    for name, radii in choices.PROFILES.items():
        radius, height, *ends = surfaces.PROFILES[name]()
        t = np.linspace(*ends, 9)
        scale = 3 / np.ptp(height(t))
        near = CubicSpline(choices.HEIGHTS, radii)(scale * (height(t) - height(t)[0]))
        assert np.abs(near - scale * radius(t)).max() < 0.05 * max(radii), name


@pytest.mark.parametrize("name", choices.PROFILES)
def test_the_drawn_profile_has_its_radii_and_passes_through_its_dots_where_there_is_one(name):
    radii = np.array(choices.PROFILES[name])
    root = parsed(plates.profile(tuple(radii)))
    dots = [complex(float(e.get("cx")), float(e.get("cy"))) for e in root.iter(SVG + "circle")]
    dots, axis = np.array(dots), segments(root, "axis")[0].real[0]
    widest = radii.argmax()
    scale = (dots[widest].real - axis) / radii[widest]
    assert np.allclose(dots.real - axis, scale * radii, atol=0.2)
    assert np.allclose(dots.imag, dots[0].imag - scale * 0.5 * np.arange(7), atol=0.2)  # upwards
    curve = polyline(next(root.iter(SVG + "polyline")))
    step = np.abs(np.diff(curve)).max()
    assert np.abs(dots[:, None] - curve).min(axis=1).max() < step / 2 + 0.2
    assert abs(curve[0] - dots[0]) < 0.2 and abs(curve[-1] - dots[-1]) < 0.2
    root = parsed(plates.profile(CROSSING))
    assert len(list(root.iter(SVG + "circle"))) == 7 and not list(root.iter(SVG + "polyline"))


WRITTEN = {0: "0", 0.25: "0.25", -0.25: "\u22120.25", 3e6: "3e6", 2e12: "2e12"}
WRITTEN |= {4.321e-13: "4.3e\u221213", 1.5e-7: "1.5e\u22127"}


@given(st.floats(-1e15, 1e15, allow_subnormal=False), st.integers(1, 3))
def test_short_numbers_are_short_and_near_and_written_as_on_paper(x, digits):
    assert {y: plates.short(y) for y in WRITTEN} == WRITTEN
    text = plates.short(x, digits)
    assert "-" not in text and "+" not in text and "e0" not in text
    assert len(text) <= digits + 8
    value = float(text.replace("\u2212", "-"))
    assert value == pytest.approx(x, rel=0.51 * 10.0 ** (1 - digits), abs=1e-300)


@pytest.mark.parametrize("values", [{"theta0": 1}, {"map": "moebius", "theta0": 1}, {"theta0": 60}])
def test_a_constructed_net_with_faulty_faces_says_so(values):
    made = built(**{"kind": "plane", "map": "square", "m": 12, "n": 12} | values)
    quality = measure.quality(made.V, made.Q)
    faults = quality.flips + quality.darts
    assert (values["theta0"] == 1) is (faults > 0)
    assert (f"but {faults} of 144 faces" in made.message) is (faults > 0)


def test_angles_that_are_nearly_none_are_refused_like_none():
    said = changed(Choice(), theta=0)[1][0].replace("'0'", "{}")
    for angle in (1e-300, 5e-324, 0.0099, 179.995, 180.0):
        assert changed(Choice(), theta=angle) == (Choice(), [said.format(repr(str(angle)))])
    assert changed(Choice(), theta=0.01)[1] == []
