"""What the explorer looks like in a real browser: the view, small screens, light and dark."""

import numpy as np
import pytest
from browsing import image, is_drawn

pytestmark = pytest.mark.browser


def test_the_keyboard_and_the_mouse_turn_the_view_and_the_button_fits_it_again(tab):
    reader = tab("kind=isothermal&surface=sphere&m=8&n=10")
    fitted = before = reader.picture()
    view = reader.page.locator(".ex-view")
    view.focus()
    for key in ("ArrowLeft", "ArrowUp", "+"):
        reader.page.keyboard.press(key)
        reader.settled()
        after = reader.picture()
        assert np.abs(after - before).mean() > 0.3, key
        before = after
    box = view.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    reader.page.mouse.move(x, y)
    reader.page.mouse.down()
    reader.page.mouse.move(x + 120, y + 40, steps=6)
    reader.page.mouse.up()
    reader.settled()
    assert np.abs(reader.picture() - before).mean() > 0.5
    reader.page.locator(".in-fit").click()
    reader.settled()
    assert np.abs(reader.picture() - fitted).mean() < 0.5
    reader.page.locator(".in-theta [role=slider]").press("ArrowRight")
    reader.settled()
    assert reader.choice().theta == 61


def test_a_finger_can_set_a_slider_on_a_small_screen(tab):
    reader = tab("m=8&n=8", width=420, height=800, has_touch=True)
    track = reader.page.locator(".in-theta .v-slider-track")
    track.scroll_into_view_if_needed()
    box = track.bounding_box()
    reader.page.touchscreen.tap(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    reader.page.wait_for_function("() => trame.state.get('theta') > 61")
    reader.settled()
    assert reader.choice().theta == pytest.approx(90, abs=3)
    assert reader.page.evaluate("document.documentElement.scrollWidth") <= 420


def test_light_and_dark(tab):
    reader = tab("m=8&n=8", color_scheme="dark")
    dark = reader.picture()
    assert dark[-5, 5].max() < 60 and is_drawn(dark)
    reader.page.set_viewport_size({"width": 390, "height": 640})
    below = image(reader.page.locator(".out-histogram").screenshot())
    assert below[0, 0].max() < 60  # what is scrolled to is dark, too
    reader.page.set_viewport_size({"width": 1000, "height": 640})
    reader.page.get_by_title("Light or dark").click()
    reader.settled()
    light = reader.picture()
    assert light[-5, 5].min() > 240 and is_drawn(light)


SIZES = {"width": 1280, "height": 720}, {"width": 1920, "height": 1080}
STATES = [
    {"kind": "plane"},
    {"kind": "isothermal", "surface": "minimal", "moebius": True, "shade": "deviation"},
    {"kind": "revolution", "families": ["u", "v", "d1", "d2"], "shade": "none"},
    {"kind": "freeform", "theta0": 45},
    {"kind": "cover", "quads": 100, "trim": False, "shade": "size"},
    {"source": "skylight", "quads": 200, "trim": True},
    {"kind": "plane", "theta": 1, "theta0": 179},
]
CROWDED = """() => {
  const shown = (e) => e.checkVisibility({checkVisibilityCSS: true}) && e.getClientRects().length;
  const names = '.ex-row, .ex-side h2, .ex-side .v-select, .ex-side .v-switch, .ex-plate, '
    + '.ex-side .v-checkbox, .ex-numbers td, .ex-note, .ex-tools .v-btn, .v-app-bar .v-btn';
  const boxes = [...document.querySelectorAll(names)].filter(shown).map((e) => {
    const r = e.getBoundingClientRect();
    return [e, r.left, r.top, r.right, r.bottom];
  });
  const wrong = [];
  for (const [e, l, t, r, b] of boxes) {
    const what = `${e.className} ${e.innerText}`.slice(0, 80);
    if (l < -1 || r > innerWidth + 1) wrong.push(`outside: ${what}`);
    if (e.scrollWidth > e.clientWidth + 2 && e.clientWidth) wrong.push(`clipped: ${what}`);
    for (const [f, l2, t2, r2, b2] of boxes) {
      if (e === f || e.contains(f) || f.contains(e)) continue;
      if (Math.min(r, r2) - Math.max(l, l2) > 2 && Math.min(b, b2) - Math.max(t, t2) > 2)
        wrong.push(`overlap: ${what} / ${f.className} ${f.innerText}`.slice(0, 160));
    }
  }
  return wrong;
}"""


def test_nothing_overlaps_and_nothing_is_clipped(tab):
    reader = tab("m=8&n=8")
    reader.page.evaluate("inet.rest = () => {}")  # the view itself is not looked at
    for size in SIZES:
        reader.page.set_viewport_size(size)
        reader.page.evaluate("trame.state.update({theta: 60, theta0: 60})")
        for values in STATES:
            reader.page.evaluate("values => trame.state.update(values)", values)
            reader.settled()
            choice = reader.choice()
            assert all(getattr(choice, k) == x for k, x in values.items() if k != "families")
            assert reader.page.evaluate(CROWDED) == [], (values, size)
