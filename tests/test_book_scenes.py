"""Nets that turn, and the half-plane of rho, in a real browser, opened as files."""

import base64
import functools
import json
import re
import shutil
import sys
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from browsing import image, is_drawn

from inetlib import measure, parallelogram

pytestmark = pytest.mark.book
BOOK = Path(__file__).resolve().parent.parent / "book"
sys.path.insert(0, str(BOOK))
import scenes  # noqa: E402

PAGE = """<!doctype html>
<html data-theme="light"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="stylesheet" href="_static/scenes.css"><script defer src="_static/viewer.js"></script>
<style>
  body {{ max-width: 800px; margin: 16px auto; padding: 0 12px; }}
  html[data-theme=dark] {{ --pst-color-background: #14181e; --pst-color-text-base: #ced6dd; }}
  body {{ background: var(--pst-color-background, #fff); font-family: sans-serif; }}
</style></head><body>{}<div style="height: 1500px"></div></body></html>"""
STILL = '<img alt="still" width="300" height="300" src="data:image/svg+xml,<svg/>">'
SCENE = '<div class="scene" data-scene="{}">' + STILL.replace("{", "{{") + "</div>"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder of pages as in the book: one a scene, all, none, and rho."""
    found = tmp_path_factory.mktemp("book")
    static = found / "_static"
    static.mkdir()
    for package, file in (
        ("trame_client", "module/vue3-www/vue.global.js"),
        ("trame_vtk", "modules/common/serve/trame-vtk.js"),
    ):
        shutil.copy(resources.files(package) / file, static)
    for file in (*BOOK.glob("*.js"), *BOOK.glob("*.css")):
        shutil.copy(file, static)
    scenes.write(static / "scenes")
    pages = {name: SCENE.format(name) for name in scenes.SCENES}
    pages |= {"all": "".join(pages.values()), "none": "<p>Nothing turns here.</p>"}
    pages["turning"] = SCENE.format("vase").replace("data-scene", "data-turn data-scene")
    pages["unknown"] = SCENE.format("unknown")
    pages["rho"] = re.search(r'<div class="rho".*?</div>', (BOOK / "rho.md").read_text())[0]
    for name, body in pages.items():
        (found / f"{name}.html").write_text(PAGE.format(body), encoding="utf-8")
    return found


@pytest.fixture
def visit(chromium, folder):
    """visit(page) -> an open page; nothing but files was asked for, the console stayed empty."""
    opened, wrong = [], []

    def route(route):
        if route.request.url.startswith(("file:", "data:", "blob:")):
            return route.continue_()
        wrong.append(route.request.url)
        return route.abort()

    def open_page(name, width=900, height=760, wait=True, before=None, **options):
        context = chromium.new_context(viewport={"width": width, "height": height}, **options)
        page = context.new_page()
        opened.append(context)
        page.asked = []
        page.on("request", lambda request: page.asked.append(request.url.rpartition("/")[2]))
        page.on("console", lambda message: wrong.append(message.text))
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.route("**/*", route)
        if before:
            page.add_init_script(before)
        page.goto((folder / f"{name}.html").as_uri())
        if wait:
            page.wait_for_selector(".scene-canvas.ready, .rho-app", timeout=60_000)
            page.wait_for_timeout(500)
        return page

    open_page.wrong = wrong
    yield open_page
    for context in opened:
        context.close()
    assert wrong == []


FRAMES = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


def picture(page, other=None, least=0.0):
    """What the first view shows, when two looks are the same, and not those of another picture."""
    before = None
    for _ in range(40):
        page.evaluate(FRAMES)
        data = page.locator(".scene-view").first.screenshot()
        if data == before and (other is None or differ(other, image(data)) > least):
            return image(data)
        before = data
        page.wait_for_timeout(150)
    raise AssertionError("the picture does not come to rest")


def differ(one, two):
    """The share of pixels that are not alike."""
    return (np.abs(one - two).sum(axis=-1) > 40).mean()


def numbers(page):
    """The table beside the first net, as texts."""
    rows = page.locator(".scene-numbers").first.locator("tr")
    return dict(re.split(r"\s*\t\s*", text.strip()) for text in rows.all_inner_texts())


def step(page, k):
    """Put the slider of the first net at state k, as a hand does."""
    page.locator(".scene-slider input").first.fill(str(k))


@functools.cache
def stored(folder, name):
    text = (folder / "_static" / "scenes" / f"{name}.js").read_text("ascii")
    return json.loads(text[text.index("{") : text.rindex("}") + 1])


def net(folder, name, k):
    """V, Q as they lie in the file of a scene."""
    scene = stored(folder, name)
    state = scene["states"][k]
    V, Q = (base64.b64decode(text) for text in (state["V"], state.get("Q") or scene["Q"]))
    Q = np.frombuffer(Q, "<u2").reshape(-1, 4).astype(int)
    return np.frombuffer(V, "<f4").reshape(-1, 3).astype(float), Q[: state["faces"]]


def said(V, Q, asked):
    """What a page must say of a net made for these angles, by `measure`."""
    (lam, mu), angles = measure.ratios(V, Q), np.degrees(measure.angles(V, Q))
    quality, off = measure.quality(V, Q), np.abs(angles - np.degrees(asked)[:, None]).max()
    return {
        "\u03b8": f"{angles[0].mean():.2f}\u00b0",
        "\u03b8\u2080": f"{angles[1].mean():.2f}\u00b0",
        "\u03bb": f"{lam.mean():.4f}",
        "\u03bc": f"{mu.mean():.4f}",
        "largest deviation": "below 0.001\u00b0" if off < 0.001 else f"{off:.3f}\u00b0",
        "quads": f"{len(Q)}",
        "flipped, darts": f"{quality.flips}, {quality.darts}",
    }


def test_the_numbers_of_20_random_states_are_those_of_measure(visit, folder):
    random = np.random.default_rng(16)
    names = random.permutation([*scenes.SCENES] * 2)
    for name in sorted(set(names)):
        page = visit(name)
        for _ in range((names == name).sum()):
            k = int(random.integers(len(stored(folder, name)["states"])))
            step(page, k)
            state = scenes.made(name).states[k]
            assert numbers(page) == said(*net(folder, name, k), [state.theta, state.theta0])
            assert page.inner_text(".scene-slider b") == state.label
            corner, centre = page.locator(".scene-parallelogram text").all_text_contents()
            found = np.degrees(measure.angles(*net(folder, name, k))).mean(axis=1)
            for text, angle in zip((corner, centre), found, strict=True):
                assert abs(float(text.split()[1][:-1]) - angle) < 0.051
        page.context.close()


@pytest.mark.parametrize("name", scenes.SCENES)
def test_a_net_turns_and_a_step_of_its_slider_changes_it(visit, name):
    page = visit(name)
    before, told = picture(page), numbers(page)
    assert is_drawn(before)
    box = page.locator(".scene-view").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 90, y + 25, steps=6)
    turned = picture(page, before, 0.03)
    page.mouse.up()
    assert numbers(page) == told
    page.click("text=front view")
    assert differ(before, picture(page, turned, 0.03)) < 0.005
    slider = page.locator(".scene-slider input")
    slider.focus()
    page.keyboard.press(
        "ArrowLeft" if slider.input_value() == slider.get_attribute("max") else "End"
    )
    picture(page, before, 0.01)
    if name not in ("bending", "associate"):  # all angles of these stay, as they should
        assert numbers(page) != told
    assert page.locator(".scene > img").is_hidden()


def test_every_family_can_be_hidden_and_has_its_colour(visit):
    page = visit("sphere")
    for name in ("inner", "u", "v"):
        page.uncheck(f"input[name={name}]")
    bare = picture(page)
    assert np.ptp(bare, axis=-1).max() < 70  # no colour is left
    for name, colour in {"u": "#0b3c8c", "v": "#d1440c", "d1": "#1f9e77", "d2": "#e0a100"}.items():
        page.check(f"input[name={name}]")
        wanted = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
        assert (np.abs(picture(page) - wanted).sum(axis=-1) < 30).mean() > 0.01, name
        page.uncheck(f"input[name={name}]")
    assert differ(bare, picture(page)) == 0
    page.check("input[name=inner]")
    assert differ(bare, picture(page)) > 0.1


def test_keys_turn_and_zoom(visit):
    page = visit("vase")
    before = picture(page)
    page.focus(".scene-view")
    page.keyboard.press("ArrowLeft")
    turned = picture(page)
    page.keyboard.press("ArrowRight")
    assert differ(before, turned) > 0.01 and differ(before, picture(page)) < 0.005
    page.keyboard.press("+")
    assert differ(before, picture(page)) > 0.02
    page.keyboard.press("-")
    assert differ(before, picture(page)) < 0.005
    page.keyboard.press("w")  # would be wires, in vtk.js
    assert differ(before, picture(page)) < 0.005


def test_a_button_turns_the_net_and_stops_it(visit):
    page = visit("hexagon")
    before = picture(page)
    page.click("text=turn")
    page.wait_for_timeout(1500)
    page.click("text=stop")
    turned = picture(page)
    assert differ(before, turned) > 0.02
    page.wait_for_timeout(300)
    assert differ(turned, picture(page)) == 0


def test_a_net_that_turns_by_itself_stops_when_it_is_touched(visit):
    page = visit("turning")
    box = page.locator(".scene-view").bounding_box()
    looks = [image(page.locator(".scene-view").screenshot())]
    page.wait_for_timeout(1500)
    looks.append(image(page.locator(".scene-view").screenshot()))
    assert differ(*looks) > 0.02
    page.mouse.click(box["x"] + 100, box["y"] + 100)
    still = picture(page)
    page.wait_for_timeout(300)
    assert differ(still, picture(page)) == 0


def test_who_wants_no_motion_gets_none(visit):
    page = visit("turning", reduced_motion="reduce")
    before = picture(page)
    page.wait_for_timeout(1000)
    assert differ(before, picture(page)) == 0


def test_the_wheel_scrolls_the_page_and_zooms_with_ctrl(visit):
    page = visit("vase", height=600)
    box, before = page.locator(".scene-view").bounding_box(), picture(page)
    page.mouse.move(box["x"] + 150, box["y"] + 200)
    page.mouse.wheel(0, 200)
    page.wait_for_function("scrollY > 100")
    page.evaluate("scrollTo(0, 0)")
    assert differ(before, picture(page)) == 0
    page.keyboard.down("Control")
    page.mouse.wheel(0, 200)
    page.keyboard.up("Control")
    assert differ(before, picture(page)) > 0.02
    assert page.evaluate("scrollY") == 0


def test_a_finger_turns_the_net_and_the_page_stays(visit):
    page = visit("vase", 390, 800, has_touch=True, is_mobile=True, device_scale_factor=1)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    before, box = picture(page), page.locator(".scene-view").bounding_box()
    session = page.context.new_cdp_session(page)

    def touch(kind, *points):
        points = [{"x": x, "y": y} for x, y in points]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    touch("touchStart", (x, y))
    for k in range(1, 9):
        touch("touchMove", (x + 8 * k, y - 12 * k))
        page.wait_for_timeout(30)
    touch("touchEnd")
    assert differ(before, picture(page)) > 0.02
    assert page.evaluate("scrollY") == 0


def test_dark_pages_have_dark_views_and_keep_what_was_chosen(visit):
    page = visit("sphere")
    step(page, 7)
    page.check("input[name=d1]")
    page.evaluate("document.documentElement.dataset.theme = 'dark'")
    page.wait_for_timeout(500)
    dark = picture(page)
    assert dark[3, 3].tolist() == [0x14, 0x18, 0x1E] and is_drawn(dark)
    assert page.locator(".scene-slider input").input_value() == "7"
    assert page.is_checked("input[name=d1]")
    page.evaluate("document.documentElement.dataset.theme = 'light'")
    page.wait_for_timeout(500)
    assert picture(page)[3, 3].tolist() == [255, 255, 255]


def test_few_views_are_alive_and_come_back_as_they_were(visit):
    page = visit("all", 900, 700)
    first = picture(page)
    step(page, 1)
    changed, told = picture(page), numbers(page)
    assert differ(first, changed) > 0.01
    for element in page.locator(".scene").all():
        element.scroll_into_view_if_needed()
        page.wait_for_timeout(700)
        assert element.locator(".scene-canvas").count() == 1
        assert page.locator(".scene canvas").count() <= 6
    assert page.locator(".scene").first.locator("canvas").count() == 0
    assert page.locator(".scene > img").first.is_visible()
    page.evaluate("scrollTo(0, 0)")
    page.wait_for_selector(".scene:first-of-type .scene-canvas.ready")
    page.wait_for_timeout(500)
    assert differ(changed, picture(page)) < 0.005 and numbers(page) == told


def test_a_page_without_scenes_loads_nothing(visit):
    page = visit("none", wait=False)
    page.wait_for_timeout(500)
    assert sorted(page.asked) == ["none.html", "scenes.css", "viewer.js"]


def test_without_webgl_the_picture_stays_and_a_sentence_says_why(visit):
    none = "HTMLCanvasElement.prototype.getContext = () => null"
    page = visit("vase", wait=False, before=none)
    page.wait_for_selector(".scene > p")
    assert "WebGL" in page.inner_text(".scene > p") and page.locator(".scene > img").is_visible()
    assert "trame-vtk.js" not in page.asked


def test_a_scene_that_is_not_there_leaves_its_picture(visit):
    page = visit("unknown", wait=False)
    page.wait_for_selector(".scene > p")
    assert page.locator(".scene > img").is_visible()
    assert len(visit.wrong) == 1 and "ERR_FILE_NOT_FOUND" in visit.wrong.pop()  # the browser's own


ON_LINES = """(svg) => [...svg.querySelectorAll('text')].filter((text) => {
  const box = text.getBBox(), view = svg.viewBox.baseVal;
  const outside = box.x < view.x || box.y < view.y || box.x + box.width > view.x + view.width
    || box.y + box.height > view.y + view.height;
  return outside || [...svg.querySelectorAll('line')].some((line) => {
    const at = (name) => Number(line.getAttribute(name));
    return [...Array(201).keys()].map((k) => k / 200).some((t) => {
      const x = at('x1') + t * (at('x2') - at('x1')), y = at('y1') + t * (at('y2') - at('y1'));
      return x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height;
    });
  });
}).map((text) => text.textContent)"""


@pytest.mark.parametrize("name", ["vase", "patch", "hexagon"])
def test_no_words_lie_on_lines(visit, folder, name):
    page = visit(name)
    for k in range(len(stored(folder, name)["states"])):
        step(page, k)
        assert page.locator(".scene-parallelogram").evaluate(ON_LINES) == [], k


def test_rho_has_the_numbers_of_the_library_at_1000_random_points(visit):
    page = visit("rho")
    random = np.random.default_rng(2)
    rho = random.uniform(-2.5, 2.5, 1000) + 1j * 10 ** random.uniform(-3, 0.5, 1000)
    found = page.evaluate(
        "points => points.map(([x, y]) => inetRho.shape(x, y))", [[z.real, z.imag] for z in rho]
    )
    shape = parallelogram.from_rho(rho)
    for name, wanted in shape._asdict().items():
        np.testing.assert_allclose([x[name] for x in found], wanted, rtol=1e-12, err_msg=name)
    lam, mu = (np.array([x[name] for x in found]) for name in ("lam", "mu"))
    np.testing.assert_allclose(parallelogram.rho(lam, mu), rho, rtol=1e-6)  # near the rim: less
    angles = random.uniform(0.02, np.pi - 0.02, (1000, 2))
    back = page.evaluate(
        "pairs => pairs.map((pair) => [inetRho.ratios(...pair), inetRho.point(...pair)])",
        angles.tolist(),
    )
    ratios = np.array([[pair["lam"], pair["mu"]] for pair, _ in back])
    np.testing.assert_allclose(ratios.T, parallelogram.ratios(*angles.T), rtol=1e-12)
    points = np.array([complex(*point) for _, point in back])
    wanted = np.exp(1j * angles[:, 1]) / parallelogram.ratios(*angles.T)[1]
    np.testing.assert_allclose(points, wanted, rtol=1e-12)


def rows(page):
    texts = page.locator(".rho-numbers tr").all_inner_texts()
    return [text.split("\t")[1].strip() for text in texts]


def expected(x, y):
    shape = parallelogram.from_rho(complex(x, y))
    angles = [f"{np.degrees(angle):.2f}\u00b0" for angle in (shape.theta, shape.theta0)]
    return [f"{shape.lam:.4f}", f"{shape.mu:.4f}", *angles]


def test_rho_is_dragged_and_everything_follows(visit):
    page = visit("rho")
    page.locator(".rho-plane").scroll_into_view_if_needed()
    assert rows(page)[1:] == expected(0.95, 1.15)
    parts = [".rho-plane", ".rho-shape >> nth=0", ".rho-web"]
    before = [image(page.locator(part).screenshot()) for part in parts]
    box = page.locator(".rho-plane").bounding_box()
    handle = page.locator(".handle").bounding_box()
    page.mouse.move(handle["x"] + handle["width"] / 2, handle["y"] + handle["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.4 * box["height"], steps=5)
    page.mouse.up()
    x, y = (float(t) for t in re.findall(r"[\d.]+", rows(page)[0]))
    assert rows(page)[0].startswith("\u2212") and 0.9 < x < 1.1 and 1.3 < y < 1.5
    for number, wanted in zip(rows(page)[1:], expected(-x, y), strict=True):
        number, wanted = (float(text.rstrip("\u00b0")) for text in (number, wanted))
        assert number == pytest.approx(wanted, rel=5e-3)
    after = [image(page.locator(part).screenshot()) for part in parts]
    for one, two in zip(before, after, strict=True):
        assert differ(one, two) > 0.01
    page.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 0.4 * box["height"])
    assert rows(page)[0].startswith("\u2212")  # let go


def test_rho_is_moved_by_keys_sliders_and_clicks(visit):
    page = visit("rho")
    page.focus(".rho-plane")
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("Shift+ArrowDown")
    assert rows(page)[1:] == expected(0.90, 1.14)
    inputs = page.locator(".rho .scene-slider input")
    for k, angle in enumerate((60, 45)):
        inputs.nth(k).fill(str(angle))
    assert rows(page)[1:] == ["2.1889", "1.4884", "60.00\u00b0", "45.00\u00b0"]
    page.locator(".mark").first.click()
    assert rows(page)[1:] == ["1.0000", "1.0000", "90.00\u00b0", "90.00\u00b0"]
    assert page.locator(".bold").count() == 4


def test_no_words_beside_the_parallelogram_of_rho_lie_on_lines(visit):
    page = visit("rho")
    random = np.random.default_rng(3)
    for x, y in random.uniform([-2.5, 0.06], [2.5, 2.35], (60, 2)).tolist():
        page.evaluate("([x, y]) => document.querySelector('.rho').inetGo(x, y)", [x, y])
        assert page.locator(".rho-shape").first.evaluate(ON_LINES) == [], (x, y)


def test_rho_fits_a_telephone_and_a_finger_moves_it(visit):
    page = visit("rho", 390, 800, has_touch=True, is_mobile=True, device_scale_factor=1)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    box, before = page.locator(".rho-plane").bounding_box(), rows(page)
    page.touchscreen.tap(box["x"] + box["width"] / 4, box["y"] + box["height"] / 2)
    assert rows(page) != before and rows(page)[0].startswith("\u2212")
