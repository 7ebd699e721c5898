"""The explorer's engine seen from a browser: tabs that follow each other, stopping, the end."""

import os
import signal

import numpy as np
import pytest
from browsing import Reader, image, is_drawn, start
from matplotlib.colors import to_rgb

from inetlib.explorer import look

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """(process, address) of an explorer; the last test ends it."""
    process, found = start(folder=tmp_path_factory.mktemp("empty"), environment=os.environ.copy())
    yield process, found
    process.kill()
    process.wait(20)
    process.stdout.close()


@pytest.fixture(scope="module")
def context(chromium):
    return chromium.new_context(viewport={"width": 900, "height": 560})


def opened(context, address, query):
    """(a `Reader`, what its console says of errors and its network of refusals, as it comes)."""
    page, said = context.new_page(), []
    page.on("console", lambda message: said.append((message.type, message.text)))
    page.on("response", lambda answer: said.append((answer.status, answer.url)))
    return Reader(page, address, query), said


def near(picture, colour):
    """How many pixels have nearly a colour."""
    return int((np.abs(picture - 255 * np.array(to_rgb(colour))).max(axis=-1) < 24).sum())


def test_a_tab_has_its_own_net_and_colours_whatever_a_closed_one_showed(served, context):
    for families in ("", "u,v,d1,d2"):  # of the tab that is closed
        first, said = opened(context, served[1], f"m=6&n=6&families={families}&dark=1")
        before = first.picture()
        first.page.close()
        reader, more = opened(context, served[1], "m=7&n=9&families=u,v")
        picture = reader.picture()
        assert is_drawn(picture) and np.abs(picture - before).mean() > 0.5
        for name in "uv":
            assert near(picture, look.LIGHT.families[name]) > 200, name
        assert near(picture, "#0000ff") == 0
        wrong = [
            x for x in said + more if x[0] == "error" or (isinstance(x[0], int) and x[0] > 399)
        ]
        assert [*wrong, *first.errors, *reader.errors] == [], wrong
        reader.page.locator(".in-d1 input").check()  # what was not there at first
        reader.settled()
        assert near(reader.picture(), look.LIGHT.families["d1"]) > 200
        reader.page.close()


NO_WEBGL = """() => {
  const known = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
    return kind.startsWith("webgl") ? null : known.call(this, kind, ...more);
  };
}"""


def test_a_browser_that_cannot_draw_says_so_and_its_numbers_and_pictures_are_right(served, context):
    page = context.new_page()
    page.add_init_script(f"({NO_WEBGL})()")
    reader = Reader(page, served[1], "kind=revolution&m=8&n=6")
    banner = page.locator(".ex-banner")
    assert "WebGL 2" in banner.inner_text() and banner.get_attribute("role") == "alert"
    reader.type("theta", "75")
    assert reader.angles() == ["75.000000", "60.000000"]
    with page.expect_download() as waiting:
        page.evaluate("inet.save('.png', 'image/png')")
    assert is_drawn(image(waiting.value.path().read_bytes()))
    page.close()


def test_when_the_program_ends_the_page_says_so_and_can_still_be_turned(served, context):
    process, address = served
    reader, _ = opened(context, address, "kind=revolution&m=8&n=6")
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 0
    banner = reader.page.locator(".ex-banner")
    banner.wait_for()
    assert "inet explore" in banner.inner_text() and banner.get_attribute("role") == "alert"
    assert reader.page.locator(".in-theta").is_visible()  # no spinner in its place
    before = reader.picture()
    assert is_drawn(before)
    reader.page.locator(".ex-view").focus()
    for _ in range(100):  # until it is drawn
        reader.page.keyboard.press("ArrowLeft")
        if np.abs(reader.picture() - before).mean() > 0.5:
            break
        reader.page.wait_for_timeout(50)
    assert np.abs(reader.picture() - before).mean() > 0.5
    assert reader.errors == []
