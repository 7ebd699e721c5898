"""The explorer's controls in a real browser, as a person uses them (skipped without Chromium)."""

import re

import numpy as np
import pytest
from browsing import is_drawn, judge

from inetlib.explorer import choices

pytestmark = pytest.mark.browser


def test_dragging_both_sliders_changes_the_net(tab):
    reader = tab("kind=isothermal&surface=minimal&m=12&n=16")
    before = reader.picture()
    reader.drag("theta", 0.5)
    theta = reader.choice().theta
    assert theta == pytest.approx(90, abs=3)
    reader.drag("theta0", 0.4)
    choice = reader.choice()
    assert choice.theta0 == pytest.approx(72, abs=3) and choice.theta == theta
    judge(reader)
    after = reader.picture()
    assert is_drawn(after) and np.abs(after - before).mean() > 1


def test_a_typed_value_is_taken_and_a_wrong_one_is_explained(tab):
    reader = tab()
    assert is_drawn(reader.picture()) and reader.angles() == ["60.000000", "60.000000"]
    judge(reader)
    reader.type("theta", "72,25\u00b0")
    assert reader.angles()[0] == "72.250000"
    judge(reader)
    for wrong in ("0", "180", "-5", "seventy", ""):
        reader.type("theta", wrong)
        assert "above 0 and below 180\u00b0" in reader.text(".out-alert")
        assert reader.page.input_value(".in-theta input[inputmode]") == "72.25"
        assert reader.angles()[0] == "72.250000"
    reader.type("m", "2.5")
    assert "a whole number from 3 to 150" in reader.text(".out-alert")
    reader.page.locator(".in-lock input").check()
    reader.settled()
    assert reader.angles() == ["72.250000", "72.250000"]
    reader.type("theta0", "50")
    assert reader.angles() == ["50.000000", "50.000000"]
    lam, mu = re.findall(r"= ([\d.]+)", reader.text(".out-ratios"))
    assert lam == mu


def test_every_kind_of_net_can_be_chosen(tab):
    reader = tab("m=8&n=10&quads=60")
    pictures = []
    for words in choices.OPTIONS["kind"].values():
        reader.choose("kind", words)
        V, Q = judge(reader)
        assert len(Q) < 200 and np.isfinite(V).all()
        pictures.append(reader.picture())
        assert is_drawn(pictures[-1]), words
    reader.choose("kind", "Isothermal surface")
    for words in choices.OPTIONS["surface"].values():
        reader.choose("surface", words)
        judge(reader)
    reader.page.locator(".in-moebius input").check()
    reader.settled()
    judge(reader)


def test_panels_to_the_edge_can_be_switched_on_and_a_hole_be_an_opening(tab):
    reader = tab("kind=cover&source=skylight&quads=200&target=0&trim=0")
    switch, cut = (reader.page.locator(name) for name in (".in-trim", ".out-cut"))
    assert switch.is_visible() and not cut.is_visible()
    judge(reader)
    reader.choose("openings", choices.OPTIONS["openings"]["fill"])
    seen = [reader.picture()]
    switch.locator("input").check()
    reader.settled()
    judge(reader)
    whole, cut_ones = (len(reader.made[name]) for name in ("Q", "polygons"))
    assert cut.inner_text() == str(cut_ones)
    assert reader.page.locator("h2", has_text=f"Over all {whole} whole faces").is_visible()
    seen.append(reader.picture())
    before, after = ((np.abs(x - x[-5, 5]).sum(axis=-1) > 30).sum() for x in seen)
    assert after > 1.1 * before  # more is covered
    choice = reader.choice()
    assert choice.trim and choice.openings == "fill"
    reader.choose("source", choices.OPTIONS["source"]["two_skylights"])
    assert not reader.page.locator(".in-openings").is_visible()
    assert cut.inner_text().isdigit()
    reader.choose("kind", choices.OPTIONS["kind"]["plane"])
    assert not switch.is_visible() and not cut.is_visible()
    judge(reader)
    reader.page.goto(f"{reader.address}?kind=cover&quads=60")
    reader.page.wait_for_selector(".out-cut:not(:empty)")
    reader.settled()
    seen = reader.picture()[40:-3]  # below the shadow of the bar, above the line
    assert is_drawn(seen) and np.abs(seen[:, [2, -3]] - seen[-5, 5]).max() < 30  # all is in view


def test_the_profile_can_be_edited(tab):
    reader = tab("kind=revolution&m=8&n=6")
    reader.page.get_by_role("button", name="barrel").click()
    reader.settled()
    assert reader.choice().radii == choices.PROFILES["barrel"]
    reader.type("radius0", "1.25")
    V, _ = judge(reader)
    assert np.hypot(*V[:, :2].T).max() > 1.24
    reader.type("radius3", "0")
    assert "a radius of the profile" in reader.text(".out-alert")


def test_families_parallelograms_and_shading_can_be_shown(tab):
    reader = tab("kind=isothermal&m=8&n=10&families=u&parallelograms=0")
    seen = [reader.picture()]
    for name in ("v", "d1", "d2", "parallelograms"):
        reader.page.locator(f".in-{name} input").check()
        reader.settled()
        seen.append(reader.picture())
        assert np.abs(seen[-1] - seen[-2]).mean() > 0.2, name
    for name, words in list(choices.OPTIONS["shade"].items())[1:]:
        reader.choose("shade", words)
        seen.append(reader.picture())
        assert np.abs(seen[-1] - seen[-2]).mean() > 0.2 and reader.text(".out-legend"), name
    choice = reader.choice()
    assert choice.families == choices.FAMILIES and choice.parallelograms
    assert choice.shade == "planarity"


def test_both_ends_of_both_sliders_leave_a_page_that_works(tab):
    reader = tab("kind=revolution&m=8&n=4")
    for kind in ("revolution", "plane", "isothermal"):
        reader.choose("kind", choices.OPTIONS["kind"][kind])
        for keys in (("Home", "Home"), ("Home", "End"), ("End", "Home"), ("End", "End")):
            for name, key in zip(("theta", "theta0"), keys, strict=True):
                reader.page.locator(f".in-{name} [role=slider]").press(key)
            reader.settled()
            choice = reader.choice()
            wanted = [1 if key == "Home" else 179 for key in keys]
            assert [choice.theta, choice.theta0] == wanted
            if not reader.page.locator(".out-problem").count():
                judge(reader)
        reader.type("theta", "60")
        reader.type("theta0", "60")
        judge(reader)
