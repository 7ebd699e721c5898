"""The explorer in a real browser, as a person uses it (Chromium; skipped where there is none)."""

import functools
import os
import re
import signal
import socket
import statistics
import xml.etree.ElementTree as tree
from urllib.parse import urlsplit

import numpy as np
import pytest
from browsing import Reader, image, is_drawn, start

from inetlib import examples, io, measure, mesh
from inetlib.explorer import choices, session

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    folder = tmp_path_factory.mktemp("empty")
    environment = os.environ | {"TMPDIR": str(folder)}
    process, found = start(folder=folder, environment=environment)
    yield found
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 0
    process.stdout.close()
    assert list(folder.iterdir()) == []  # nothing was left on the disk


@pytest.fixture(scope="module")
def contexts(chromium):
    """contexts(options) -> a browser context, the same for the same options: its cache is warm."""
    return functools.cache(chromium.new_context)


@pytest.fixture
def tab(contexts, address):
    """tab(query, ...) -> a `Reader`; its page must not have thrown an error."""
    opened = []

    def open_tab(query="", width=1000, height=640, **options):
        page = contexts(**options).new_page()
        page.set_viewport_size({"width": width, "height": height})
        opened.append(Reader(page, address, query))
        return opened[-1]

    yield open_tab
    for reader in opened:
        errors = list(reader.errors)
        reader.page.close()
        assert errors == []


def judge(reader):
    """The page's numbers are those of `measure` for the page's own code, digit by digit."""
    V, Q = reader.net()
    for shown, found in zip(reader.angles(), measure.angles(V, Q), strict=True):
        assert shown == f"{np.degrees(found.mean()):.6f}"
    assert reader.text(".out-flips") == str(measure.quality(V, Q).flips)
    choice = reader.choice()
    for name, found in zip(("theta", "theta0"), measure.angles(V, Q), strict=True):
        off = np.abs(np.degrees(found) - getattr(choice, name)).max()
        shown = float(reader.text(f".out-off-{name}").rstrip("\u00b0").replace("\u2212", "-"))
        assert shown == pytest.approx(off, rel=0.06, abs=2e-12)  # two digits, and rounding
    return V, Q


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


def test_an_optimisation_runs_can_be_stopped_and_run_again(tab):
    reader = tab("kind=freeform&m=20&n=20&theta=60&theta0=45")
    assert "converged in" in reader.text(".out-message")
    judge(reader)
    reader.type("m", "100")
    reader.type("n", "60")
    seen = reader.page.evaluate("inet.loads")
    reader.page.locator(".in-run").click()
    reader.page.locator(".out-progress", has_text="step").wait_for()
    reader.page.locator(".in-stop").click()
    reader.page.locator(".out-message").wait_for()
    assert "stopped by the caller" in reader.text(".out-message")
    reader.page.wait_for_function("n => inet.loads > n + 1", arg=seen)  # it was seen on its way
    reader.page.locator(".in-run").click()
    reader.page.locator(".out-progress").wait_for()
    reader.settled()
    assert "converged in" in reader.text(".out-message")
    assert reader.angles() == ["60.000000", "45.000000"]


def test_what_is_saved_is_what_is_shown(tab, tmp_path):
    reader = tab("kind=revolution&m=8&n=6&theta=75&theta0=60")

    def save(suffix):
        reader.page.locator(".in-save").click()
        items = reader.page.locator(".v-overlay__content .v-list-item-title").all_text_contents()
        assert [f".{item.split(',')[0].strip().lower()}" for item in items] == list(session.SAVED)
        with reader.page.expect_download() as waiting:
            reader.page.locator(".v-list-item", has_text=suffix[1:].upper()).click()
        path = tmp_path / waiting.value.suggested_filename
        waiting.value.save_as(path)
        assert path.name == f"vase_75_60{suffix}"
        return path

    V, Q = judge(reader)
    assert all(map(np.array_equal, io.read(save(".obj")), (V, Q)))
    root = tree.fromstring(save(".svg").read_text(encoding="utf-8"))
    found = {part.tag.rpartition("}")[2] for part in root.iter()}
    assert root.tag.endswith("svg") and {"image", "path"} <= found  # the surface, its curves
    assert is_drawn(image(save(".png").read_bytes()))


def test_the_code_and_the_link_can_be_copied(tab, address):
    permissions = "clipboard-read", "clipboard-write"
    reader = tab("kind=plane&map=exp&theta=80&theta0=50", permissions=permissions)
    reader.page.get_by_title("Copy link").click()
    reader.page.locator(".out-alert", has_text="link copied").wait_for()
    copied = reader.page.evaluate("navigator.clipboard.readText()")
    reader.page.wait_for_function("link => location.href == link", arg=copied)
    other = tab(urlsplit(copied).query)
    assert urlsplit(copied)._replace(query="").geturl() == f"{address}index.html"
    reader.type("theta", "81")
    reader.page.wait_for_function("() => location.search.includes('theta=81')")
    reader.type("theta", "80")
    assert other.angles() == ["80.000000", "50.000000"]
    reader.page.get_by_title("Python").click()
    code = reader.text(".ex-code")
    assert len(code.splitlines()) == 3 and code == reader.page.evaluate("trame.state.get('code')")


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


STATES = [
    "kind=plane",
    "kind=isothermal&surface=minimal&moebius=1&shade=1",
    "kind=revolution&families=u,v,d1,d2&parallelograms=1",
    "kind=freeform&theta0=45",
    "kind=cover&quads=100&trim=0&shade=1",
    "kind=cover&source=skylight&quads=200",
    "theta=1&theta0=179",
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


@pytest.mark.parametrize("size", [(1280, 720), (1920, 1080)])
def test_nothing_overlaps_and_nothing_is_clipped(tab, size):
    reader = tab("m=8&n=8", *size)
    for query in STATES:
        reader.page.goto(f"{reader.address}?m=8&n=8&{query}")
        reader.page.wait_for_selector(".out-flips:not(:empty)")
        reader.settled()
        assert reader.page.evaluate(CROWDED) == [], query


SEEN = """() => {
  let drawn = 0;
  for (const name of ['drawArrays', 'drawArraysInstanced']) {
    const known = WebGL2RenderingContext.prototype, draw = known[name];
    known[name] = function (...a) { drawn += 1; return draw.apply(this, a); };
  }
  const look = () => {  // reading pixels back waits until they are there
    const small = Object.assign(document.createElement('canvas'), {width: 160, height: 120});
    const context = small.getContext('2d');
    context.drawImage(document.querySelector('.ex-view canvas'), 0, 0, 160, 120);
    return context.getImageData(0, 0, 160, 120).data.reduce((h, x) => (h * 31 + x) | 0, 0);
  };
  window.move = (key) => new Promise((resolve, reject) => {
    const before = look(), start = performance.now();
    drawn = 0;
    document.activeElement.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));
    const wait = () => {
      if (drawn) {
        drawn = 0;
        if (look() !== before) return resolve(performance.now() - start);
      }
      if (performance.now() - start > 20000) return reject(new Error('no new picture'));
      requestAnimationFrame(wait);
    };
    wait();
  });
}"""


@pytest.mark.parametrize("side", [32, 100])
def test_from_slider_to_picture(tab, side, capsys):
    reader = tab(f"m={side}&n={side}&families=u,v,d1,d2")
    reader.page.evaluate(SEEN)
    reader.page.locator(".in-theta [role=slider]").focus()
    times = []
    for k in range(20):  # there and back; each move must show a new picture
        times.append(reader.page.evaluate("key => move(key)", ("ArrowRight", "ArrowLeft")[k % 2]))
        reader.page.wait_for_timeout(60)
    reader.settled()
    judge(reader)
    middle, low, high = statistics.median(times), min(times), max(times)
    words = f"slider to picture, {side * side} quads, all curves: median {middle:.0f} ms"
    with capsys.disabled():  # printed, not asserted: this machine may be busy
        print(f"\n{words} of {len(times)} moves ({low:.0f} to {high:.0f})")


def test_a_file_of_the_command_line_is_covered_and_sigint_ends_everything(chromium, tmp_path):
    path = tmp_path / "my roof.obj"
    io.write(path, *examples.wavy_roof(15))
    before = path.read_bytes()
    process, address = start(path, folder=tmp_path, environment=os.environ.copy())
    try:
        page = chromium.new_page()
        reader = Reader(page, address, "quads=120&theta=70&theta0=60&kind=cover&source=file")
        assert "converged in" in reader.text(".out-message")
        assert page.title().startswith("my roof 70 60")
        assert page.locator(".in-source", has_text="my roof.obj").is_visible()
        V, Q = judge(reader)
        assert mesh.is_labelled(Q) and 60 < len(Q) < 240 and len(V) == Q.max() + 1
        reader.type("quads", "4000")  # a search is under way when it ends
    finally:
        process.send_signal(signal.SIGINT)
        code, rest = process.wait(20), process.stdout.read()
        process.stdout.close()
    page.close()
    assert (code, rest) == (0, "")
    with pytest.raises(OSError), socket.create_connection(("127.0.0.1", urlsplit(address).port)):
        pass
    assert os.listdir(tmp_path) == ["my roof.obj"] and path.read_bytes() == before
