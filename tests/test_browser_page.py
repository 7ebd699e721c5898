"""Whether the explorer's page can be read and used by everybody, in a real browser (Chromium)."""

import os
import re
import signal

import numpy as np
import pytest
from browsing import Reader, image, is_drawn, start

from inetlib.explorer import choices, welcome

pytestmark = pytest.mark.browser

CONTRAST = """() => {  // texts whose contrast is below 4.5, with opacity and what lies behind them
  const rgba = (c) => {
    const x = c.match(/[\\d.]+/g).map(Number);
    return c.startsWith('color(') ? [...x.slice(0, 3).map((v) => 255 * v), x[3] ?? 1]
      : [...x.slice(0, 3), x[3] ?? 1];
  };
  const over = (f, b) => [0, 1, 2].map((k) => f[k] * f[3] + b[k] * (1 - f[3])).concat(1);
  const bright = (c) => c.slice(0, 3).map((x) => (x / 255 <= 0.03928
    ? x / 255 / 12.92 : ((x / 255 + 0.055) / 1.055) ** 2.4))
    .reduce((sum, x, k) => sum + x * [0.2126, 0.7152, 0.0722][k], 0);
  const found = [], texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  let count = 0;
  while (texts.nextNode()) {
    const text = texts.currentNode.data.trim(), e = texts.currentNode.parentElement;
    const seen = {visibilityProperty: true, opacityProperty: true};
    if (!text || !e.checkVisibility(seen) || e.closest('style, script, :disabled'))
      continue;
    const style = getComputedStyle(e);
    let front = rgba(e instanceof SVGElement ? style.fill : style.color), back = [255, 255, 255, 1];
    const chain = [];
    for (let p = e; p; p = p.parentElement) {
      front[3] *= Number(getComputedStyle(p).opacity);
      chain.unshift(p);
    }
    for (const p of chain) back = over(rgba(getComputedStyle(p).backgroundColor), back);
    const [a, b] = [bright(over(front, back)), bright(back)].sort((x, y) => y - x);
    count += 1;
    if ((a + 0.05) / (b + 0.05) < 4.5) found.push(`${text}: ${(a + 0.05) / (b + 0.05)}`);
  }
  return [count, found];
}"""
OPACITY = (  # of the dialog that comes
    "() => getComputedStyle(document.querySelector('.v-overlay--active > :last-child')).opacity"
)
WIDE = "() => document.documentElement.scrollWidth - innerWidth"


@pytest.fixture(scope="module")
def reader(chromium, tmp_path_factory):
    """One tab of the explorer for all tests of this file; its page must not throw an error."""
    process, address = start(folder=tmp_path_factory.mktemp("x"), environment=os.environ.copy())
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    found = Reader(page, address, "kind=revolution&m=8&n=6")
    yield found
    errors = list(found.errors)
    page.close()
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 0 and errors == []
    process.stdout.close()


def opened(reader, query, scheme="light", size=(1280, 720)):
    """The page of another link, in light or dark, at a size."""
    reader.page.emulate_media(color_scheme=scheme)
    reader.page.set_viewport_size(dict(zip(("width", "height"), size, strict=True)))
    reader.page.goto(f"{reader.address}?{query}")
    reader.page.wait_for_selector(".out-flips:not(:empty)")
    reader.settled()


def test_whatever_can_be_used_has_a_name_and_what_happens_is_announced(reader):
    session = reader.page.context.new_cdp_session(reader.page)
    nodes = session.send("Accessibility.getFullAXTree")["nodes"]
    session.detach()
    used = [x for x in nodes if "focusable" in [p["name"] for p in x.get("properties", ())]]
    shown = [(x["role"]["value"], x["name"]["value"].strip()) for x in used]
    assert {role for role, _ in shown} >= {"button", "checkbox", "combobox", "application"}
    assert {role for role, name in shown if not name} <= {"generic"}  # what scrolls
    for role in ("slider", "textbox"):  # both of a value are named after it
        words = {name for r, name in shown if r == role}
        assert {"\u03b8", "radius at height 0"} <= {name.removesuffix(", value") for name in words}
    status = reader.page.get_by_role("status").filter(has_text="exact")
    assert status.get_attribute("aria-live") == "polite"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_text_stands_out_and_a_telephone_has_nothing_to_scroll_sideways(reader, scheme):
    opened(reader, "kind=revolution&theta=1&theta0=179&shade=1", scheme)
    count, faint = reader.page.evaluate(CONTRAST)
    assert count > 40 and faint == []
    reader.page.set_viewport_size({"width": 390, "height": 844})
    reader.settled()
    count, faint = reader.page.evaluate(CONTRAST)
    assert count > 40 and faint == [] and reader.page.evaluate(WIDE) <= 0
    top, *rest = (
        reader.page.locator(name).bounding_box() for name in (".ex-view", ".ex-left", ".ex-right")
    )
    assert top["height"] > 300 and all(box["y"] >= top["y"] + top["height"] for box in rest)
    html = "getComputedStyle(document.documentElement).backgroundColor"
    assert (reader.page.evaluate(html) == "rgb(255, 255, 255)") is (scheme == "light")


def test_the_tour_comes_once_is_led_by_keys_and_is_remembered(reader):
    page, tour = reader.page, reader.page.locator(".ex-tour")
    page.add_init_script("if (!sessionStorage.x) localStorage.clear(); sessionStorage.x = 1")
    opened(reader, "kind=plane&m=8&n=6")
    tour.wait_for()
    seen = []
    for k in range(1, 6):
        assert f"{k} of 5" in tour.inner_text()
        target = page.locator(".ex-tour [data-target]").get_attribute("data-target").split(", ")[0]
        width = page.locator(target).evaluate("e => getComputedStyle(e).outlineWidth")
        assert width == "3px" and page.locator(target).first.is_visible()
        if k == 4:  # the field is lit without a line through its label
            style = "e => [getComputedStyle(e).outlineStyle, getComputedStyle(e).borderLeftWidth]"
            around = page.locator(".in-kind").evaluate(style)[0]
            own = page.locator(".in-kind .v-field__outline__start").evaluate(style)[1]
            assert (around, own) == ("none", "3px")
            assert page.evaluate(CONTRAST)[1] == []
        seen.append(tour.locator("p").inner_text())
        shows = tour.locator("button.v-btn--variant-tonal")
        if k in (2, 3):
            shows.click()
            reader.settled()
        page.locator(".in-next").focus()
        page.keyboard.press("Enter")
    assert len(set(seen)) == 5
    choice = reader.choice()
    assert choice.theta == 90 and choice.families == ("u", "v", "d1", "d2")
    assert tour.count() == 0
    opened(reader, "kind=plane&m=8&n=6")
    assert tour.count() == 0  # it is remembered
    page.get_by_title("Help").click()
    page.locator(".in-tour").click()
    tour.wait_for()
    page.keyboard.press("Escape")
    tour.wait_for(state="detached")
    page.wait_for_function("() => document.activeElement.matches('.ex-view')")
    reader.settled()


def test_on_a_telephone_the_net_and_what_a_step_of_the_tour_is_about_are_in_view(reader):
    page = reader.page
    opened(reader, "kind=plane&m=8&n=6", size=(390, 844))
    page.evaluate("scrollTo(0, 500)")
    seen = """() => {
      const inside = (e) => {
        const r = e.getBoundingClientRect();
        return e.contains(document.elementFromPoint(r.x + r.width / 2, r.y + r.height / 2));
      };
      const part = document.querySelector('.ex-tour [data-target]')?.dataset.target;
      return part && [...document.querySelectorAll(`${part}, .ex-view, .in-next`)].every(inside);
    }"""
    for k in range(1, 6):
        page.evaluate(f"inet.tour({k})")
        page.wait_for_function(seen)
    assert page.locator(".ex-view").bounding_box()["height"] > 180
    page.evaluate("inet.tour(0)")
    page.wait_for_function("() => document.activeElement.matches('.ex-view')")
    reader.settled()
    assert page.locator(".ex-view").bounding_box()["height"] > 400


def test_a_preset_opens_the_net_of_its_picture(reader):
    page = reader.page
    opened(reader, "kind=plane&m=8&n=6")
    page.locator(".in-presets").click()
    cards = page.locator(".ex-card")
    assert cards.count() == len(welcome.PRESETS)
    loaded = (
        "() => [...document.querySelectorAll('.ex-card img')].filter(i => i.naturalWidth).length"
    )
    cards.last.scroll_into_view_if_needed()
    page.wait_for_function(f"() => ({loaded})() == {len(welcome.PRESETS)}")
    page.wait_for_function(f"() => ({OPACITY})() == 1")
    assert page.evaluate(CONTRAST)[1] == []
    page.locator(".in-preset-vase").click()
    reader.settled()
    assert reader.choice() == choices.parse(welcome.PRESETS["vase"].link)[0]
    assert is_drawn(reader.picture())
    page.get_by_title("Undo").click()
    reader.settled()
    assert reader.choice().kind == "plane"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_pictures_of_the_presets_are_as_light_or_dark_as_the_page(reader, scheme):
    opened(reader, "kind=plane&m=8&n=6", scheme)
    reader.page.locator(".in-presets").click()
    card = reader.page.locator(".in-preset-hourglass img")
    card.scroll_into_view_if_needed()
    card.evaluate("e => e.decode()")
    reader.page.wait_for_function(f"() => ({OPACITY})() == 1")
    found = image(card.screenshot())
    assert is_drawn(found)
    page = reader.page.evaluate("getComputedStyle(document.documentElement).backgroundColor")
    assert np.abs(found[3, 3] - list(map(int, re.findall(r"\d+", page)))).max() < 8
    inner = found[found.shape[0] // 3 : -found.shape[0] // 3]
    inner = inner[np.abs(inner - found[3, 3]).sum(axis=-1) > 120]
    red, green, blue = inner.reshape(-1, 3).mean(axis=0)
    assert green > blue and green > red - 20  # of four families together, in either light


def test_all_is_there_at_twice_the_size_and_nothing_moves_where_that_is_unwanted(reader):
    page = reader.page
    opened(reader, "kind=revolution&m=8&n=6", size=(640, 360))  # 1280 x 720 at 200 %
    assert page.evaluate(WIDE) <= 0
    for name in (".in-theta input[inputmode]", ".in-u input", ".out-histogram"):
        page.locator(name).scroll_into_view_if_needed()
        assert page.locator(name).bounding_box()["y"] < 360
    page.emulate_media(reduced_motion="reduce")
    spin = """() => Math.max(...[...document.querySelectorAll('*')]
      .map(e => parseFloat(getComputedStyle(e).transitionDuration)))"""
    assert page.evaluate(spin) < 0.001
    page.emulate_media(reduced_motion="no-preference")
    assert page.evaluate(spin) > 0.1


def test_whoever_has_only_keys_sees_where_they_are(reader):
    page = reader.page
    opened(reader, "kind=revolution&m=8&n=6")
    page.locator("body").press("Tab")
    ring = """() => {
      const own = document.activeElement;
      const shown = (e) => e && getComputedStyle(e).outlineStyle != 'none';
      return shown(own) || shown(own.closest('.v-selection-control__input'))
        || shown(own.querySelector('.v-slider-thumb__surface'))
        || Boolean(own.closest('.v-field--focused'))
        || getComputedStyle(own).boxShadow != 'none';
    }"""
    reached = set()
    for _ in range(30):
        assert page.evaluate(ring), page.evaluate("document.activeElement.outerHTML")
        reached.add(
            page.evaluate("document.activeElement.closest('[class*=in-], .ex-view')?.className")
        )
        page.keyboard.press("Tab")
    words = " ".join(filter(None, reached))
    for name in ("in-save", "in-presets", "in-kind", "in-theta", "in-lock", "in-m", "in-radius6"):
        assert name in words, name


def test_a_copied_link_opens_the_same_view_in_the_same_light(reader):
    page, sight = reader.page, "[inet.angles(), trame.state.get('dark')]"
    page.get_by_title("Light or dark").click()
    reader.settled()
    page.evaluate("inet.turn(35, 20)")
    page.evaluate("inet.zoom(0.6)")
    seen = page.evaluate(sight)
    page.get_by_title("Copy link").click()
    page.wait_for_function("() => location.search.includes('&camera=')")
    page.goto(page.url)
    page.wait_for_selector(".out-flips:not(:empty)")
    reader.settled()
    assert page.evaluate(sight) == seen and seen[1] is True
    assert is_drawn(reader.picture())
