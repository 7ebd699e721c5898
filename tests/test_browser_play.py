"""Touching the net in a real browser: hover, tap, keys, undo (Chromium; else skipped)."""

import os
import re
import signal

import numpy as np
import pytest
from browsing import Reader, is_drawn, start

from inetlib import measure
from inetlib.explorer.choices import Choice

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def reader(chromium, tmp_path_factory):
    """One tab for all tests here; each begins with its own link."""
    folder = tmp_path_factory.mktemp("empty")
    process, address = start(folder=folder, environment=os.environ.copy())
    page = chromium.new_page(viewport={"width": 1000, "height": 640}, has_touch=True)
    found = Reader(page, address, "m=8&n=10")
    yield found
    page.close()
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 0
    process.stdout.close()
    assert found.errors == []


def go(reader, **values):
    """The page with the net of a choice, fitted into the view."""
    state = {k: list(x) if isinstance(x, tuple) else x for k, x in vars(Choice()).items()}
    reader.page.evaluate("values => window.trame.state.update(values)", state | values)
    reader.page.evaluate("inet.touch('none')")
    reader.settled()
    reader.page.locator(".in-fit").click()
    reader.settled()


def face(reader):
    """The number of the face that is shown, None for the whole net."""
    words = reader.text(".out-face").split()
    return int(words[1]) - 1 if words[0] == "Face" else None


def point(reader, x, y):
    """Move the mouse to a place of the view, from 0 to 1."""
    box = reader.page.locator(".ex-view").bounding_box()
    reader.page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])
    reader.settled()


def judge(reader, k):
    """What is said of a face is what `measure` finds."""
    V, Q = reader.net()
    for name, found in zip(("theta", "theta0"), measure.angles(V, Q[k : k + 1]), strict=True):
        shown = reader.text(f".out-face-{name}")
        assert shown == f"{np.degrees(found[0]):.6f}\u00b0"
        assert reader.text(f".out-face-off-{name}").startswith("off by ")


def drawn(reader):
    return reader.page.evaluate("document.querySelector('.ex-touch')?.innerHTML ?? ''")


def test_a_face_is_shown_under_the_pointer_and_the_whole_net_when_it_leaves(reader):
    go(reader, kind="plane", map="inverse", m=8, n=10)
    whole = reader.page.inner_html(".out-parallelogram")
    assert face(reader) is None and not drawn(reader)
    point(reader, 0.6, 0.5)
    one = face(reader)
    judge(reader, one)
    assert reader.page.inner_html(".out-parallelogram") != whole
    outline = drawn(reader)
    assert outline.count("<path") == 12
    point(reader, 0.7, 0.4)
    assert face(reader) not in (one, None) and drawn(reader) != outline
    judge(reader, face(reader))
    point(reader, 0.02, 0.02)  # beside the net
    assert face(reader) is None and not drawn(reader)
    point(reader, 0.6, 0.5)
    reader.page.mouse.move(20, 300)
    reader.settled()
    assert face(reader) is None and reader.page.inner_html(".out-parallelogram") == whole


def test_a_click_holds_a_face_that_follows_the_camera_and_the_angles(reader):
    go(reader, kind="plane", map="inverse", m=8, n=10)
    point(reader, 0.6, 0.5)
    one = face(reader)
    assert one is not None
    reader.page.mouse.down()
    reader.page.mouse.up()
    reader.settled()
    point(reader, 0.7, 0.4)
    assert face(reader) == one
    before = drawn(reader)
    reader.page.locator(".ex-view").focus()
    reader.page.keyboard.press("ArrowLeft")
    reader.settled()
    assert drawn(reader) != before
    reader.type("theta", 75)
    assert face(reader) == one and reader.text(".out-face-theta")[:2] in ("74", "75", "76")
    judge(reader, one)
    reader.page.locator(".ex-view").focus()
    reader.page.keyboard.press("Escape")
    reader.settled()
    assert face(reader) is None


def test_a_tap_shows_a_face_and_one_beside_the_net_lets_it_go(reader):
    go(reader, kind="plane", map="inverse", m=8, n=10)
    box = reader.page.locator(".ex-view").bounding_box()
    for x, y, on_net in ((0.6, 0.5, True), (0.02, 0.02, False)):
        reader.page.touchscreen.tap(box["x"] + x * box["width"], box["y"] + y * box["height"])
        reader.settled()
        assert (face(reader) is not None) is on_net
        assert bool(reader.text(".ex-chip")) is on_net


def test_faces_are_reached_by_keys(reader):
    go(reader, kind="isothermal", surface="sphere", m=8, n=10)
    reader.page.mouse.move(20, 300)
    reader.page.locator(".ex-view").focus()
    seen = []
    for key in ("Enter", "n", "n", "p", "Escape"):
        reader.page.keyboard.press(key)
        reader.settled()
        seen.append(face(reader))
    first = seen[0]
    assert seen[1:] == [first + 1, first + 2, first + 1, None]


def test_hovering_does_not_queue_up(reader):
    go(reader, m=30, n=30)
    box = reader.page.locator(".ex-view").bounding_box()
    calls = """() => {
      const { trigger } = window.trame;
      window.asked = 0;
      window.trame.trigger = (...a) => {
        window.asked += 1;
        return trigger.apply(window.trame, a);
      };
    }"""
    reader.page.evaluate(calls)
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    events = """([x, y]) => { for (let k = 0; k < 300; k += 1) {
      document.querySelector('.ex-view canvas').dispatchEvent(new PointerEvent('pointermove',
        {clientX: x + k / 10, clientY: y, bubbles: true, pointerType: 'mouse'}));
    } }"""
    reader.page.evaluate(events, [x, y])
    reader.settled()
    assert 1 <= reader.page.evaluate("window.asked") < 10
    last = reader.page.evaluate("([x, y]) => inet.at({clientX: x + 29.9, clientY: y})", [x, y])
    reader.settled()
    assert last is True and face(reader) is not None
    judge(reader, face(reader))


def test_undo_and_redo_by_button_and_keys(reader):
    reader.page.goto(f"{reader.address}?m=8&n=10")
    reader.page.wait_for_selector(".out-flips:not(:empty)")
    reader.settled()
    undo, redo = (reader.page.locator(f".in-{name}") for name in ("undo", "redo"))
    assert undo.is_disabled() and redo.is_disabled()
    reader.drag("theta", 0.5)  # one entry, not one a step
    dragged = reader.choice().theta
    reader.type("m", 9)
    undo.click()
    reader.settled()
    assert (reader.choice().m, reader.choice().theta) == (8, dragged)
    reader.page.locator(".ex-view").focus()
    reader.page.keyboard.press("Control+z")
    reader.settled()
    assert reader.choice().theta == 60 and reader.angles()[0] == "60.000000"
    assert undo.is_disabled() and redo.is_enabled()
    reader.page.keyboard.press("Control+Shift+Z")
    reader.page.keyboard.press("Control+y")
    reader.settled()
    assert (reader.choice().m, reader.choice().theta) == (9, dragged)
    field = reader.page.locator(".in-m input[inputmode]")
    field.fill("12")
    field.press("Control+z")  # that of the field
    reader.settled()
    assert reader.choice().m == 9


def test_a_net_is_kept_as_a_ghost_with_its_numbers_until_it_is_removed(reader):
    go(reader, kind="plane", map="square", theta=60, theta0=60, m=8, n=10)
    plain = reader.picture()
    reader.page.locator(".in-keep").click()
    reader.type("theta0", 100)
    assert reader.text(".out-ghost-theta0") == "60\u00b0"
    assert reader.text(".out-numbers-theta0") == "100\u00b0"
    assert reader.text(".out-ghost-quads") == "80"
    with_ghost = reader.picture()
    reader.page.locator(".in-forget").click()
    reader.settled()
    assert reader.page.locator(".out-ghost").count() == 0
    alone = reader.picture()
    grey = (np.ptp(with_ghost, axis=2) < 12) & (np.abs(with_ghost - alone).sum(axis=2) > 60)
    assert grey.mean() > 0.005  # its lines were there
    reader.type("theta0", 60)
    assert np.abs(reader.picture() - plain).mean() < 0.5


def test_the_surface_is_seen_below_a_cover_unless_it_is_switched_off(reader):
    go(reader, kind="cover", quads=60, trim=0)
    seen = [reader.picture()]
    assert re.fullmatch(r"[\d.]+ %", reader.text(".out-covered"))
    assert reader.text(".out-distance").endswith(" %")
    reader.page.locator(".in-target input").uncheck()
    reader.settled()
    seen.append(reader.picture())
    full, bare = ((np.abs(x - x[-5, 5]).sum(axis=-1) > 12).mean() for x in seen)
    assert full > 1.1 * bare and not reader.choice().target


def test_where_there_is_no_net_the_view_says_why_and_a_button_makes_one(reader):
    go(reader, kind="cover", source="file")
    assert "no file" in reader.text(".ex-view .out-problem")
    offer = reader.page.locator(".ex-view .in-remedy").first
    offer.wait_for()
    grey = reader.picture()
    assert is_drawn(grey[120:]) and np.ptp(grey[200:], axis=2).max() < 12  # without colours
    reader.page.evaluate("trame.state.set('quads', 60)")
    offer.wait_for()
    offer.click()
    reader.page.locator(".out-problem").wait_for(state="detached")
    reader.settled()
    assert reader.choice().source == "roof" and not reader.page.locator(".in-remedy").count()
    judge_net(reader)
    reader.page.locator(".in-undo").click()
    reader.page.locator(".out-problem").wait_for()


def judge_net(reader):
    V, Q = reader.net()
    assert reader.text(".out-flips") == str(measure.quality(V, Q).flips) == "0"


def test_darts_are_counted_marked_and_mended(reader):
    go(reader, kind="revolution", theta=120, theta0=30, m=5, n=60)
    V, Q = reader.net()
    darts = measure.quality(V, Q).darts
    assert reader.text(".out-darts") == str(darts) != "0"
    show = reader.page.locator(".in-marks")
    show.click()
    reader.settled()
    assert drawn(reader).count('class="mark"') == darts
    show.click()
    reader.settled()
    assert not drawn(reader)
    reader.page.locator(".in-remedy").first.click()
    reader.settled()
    assert reader.text(".out-darts") == "0" and not show.is_visible()
    judge_net(reader)
