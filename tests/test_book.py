"""The built book, every page in Chromium, opened as files and served, with no network."""

import functools
import http.server
import re
import threading
from pathlib import Path

import pytest
from browsing import PATIENCE

HTML = Path(__file__).resolve().parent.parent / "book" / "_build" / "html"
PAGES = sorted(str(p.relative_to(HTML)) for p in HTML.rglob("*.html") if "_static" not in p.parts)
LIMIT = 60e6  # bytes of the book
SECTIONS = "4_isogonal_nets", "5_1_developable_nets", "5_2_isothermal_nets", "5_3_loxodrome_webs"
TURNING = ["index", *(f"notebooks/{name}" for name in (*SECTIONS, "6_optimisation"))]
pytestmark = pytest.mark.book


@pytest.fixture
def visit(chromium):
    """visit(address, width, theme): the page when all is shown; what it asked for is judged."""
    opened = []

    def visit(address, width=1280, theme="light"):
        context = chromium.new_context(viewport={"width": width, "height": 900})
        page, asked, said = context.new_page(), [], []
        page.set_default_timeout(PATIENCE)
        page.add_init_script(f"localStorage.mode = localStorage.theme = '{theme}'")
        here = address.split("/", 3)[:3] if address.startswith("http") else ["file:"]

        def route(way):
            inside = way.request.url.startswith(("/".join(here), "data:", "blob:"))
            if not inside:
                asked.append(way.request.url)
            return way.continue_() if inside else way.abort()

        page.route("**/*", route)
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("console", lambda m: said.append(m.text) if m.type in ("error", "warning") else 0)
        page.goto(address)
        opened.append((context, address, asked, said))
        return page

    yield visit
    for context, address, asked, said in opened:
        context.close()
        assert not asked and not said, (address, asked, said)


def shown(page):
    """Wait for the mathematics; what is wrong with it, the pictures and the width of the page."""
    page.wait_for_function("() => !window.MathJax || MathJax.startup?.promise")
    return page.evaluate(
        """async () => {
          if (window.MathJax) await MathJax.startup.promise;
          for (const image of document.images) image.loading = "eager";
          await Promise.all([...document.images].map((image) => image.decode().catch(() => 0)));
          const main = document.querySelector("main") ?? document.body;
          const math = [...document.querySelectorAll(".math")];
          return {
            untypeset: math.filter((x) => !x.querySelector("mjx-container")).length,
            wrong: document.querySelectorAll("mjx-merror, [data-mjx-error]").length,
            lost: [...document.images].filter((x) => !x.naturalWidth).map((x) => x.src),
            wider: document.documentElement.scrollWidth - innerWidth > 1,
            empty: main.innerText.length < 20,
          };
        }"""
    )


GOOD = {"untypeset": 0, "wrong": 0, "lost": [], "wider": False, "empty": False}


def test_the_book_is_there_and_small():
    assert (HTML / "index.html").exists(), "make book first"
    assert sum(path.stat().st_size for path in HTML.rglob("*") if path.is_file()) < LIMIT
    assert len(list((HTML / "notebooks").glob("*.html"))) == 11 and len(PAGES) > 100


@pytest.mark.parametrize("page", PAGES)
def test_a_page_opened_as_a_file_shows_everything(visit, page):
    assert shown(visit((HTML / page).as_uri())) == GOOD


@pytest.mark.parametrize("page", [x for x in PAGES if not x.startswith(("_modules", "api"))])
def test_a_page_fits_on_a_telephone_in_the_dark(visit, page):
    assert shown(visit((HTML / page).as_uri(), 390, "dark")) == GOOD


@pytest.fixture
def served():
    """The address of a server of the book, on this machine only."""

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *words):
            pass

    handler = functools.partial(Quiet, directory=HTML)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()
        thread.join()


@pytest.mark.parametrize("page", ["index.html", "rho.html", "notebooks/4_isogonal_nets.html"])
def test_a_page_from_a_server_shows_everything(visit, served, page):
    assert shown(visit(served + page)) == GOOD


@pytest.mark.parametrize("page", TURNING)
def test_the_nets_of_a_page_turn_under_the_mouse(visit, page):
    opened = visit((HTML / f"{page}.html").as_uri())
    for scene in opened.locator(".scene").all():
        scene.scroll_into_view_if_needed()
        canvas = scene.locator("canvas")
        canvas.wait_for()
        canvas.scroll_into_view_if_needed()
        opened.wait_for_timeout(700)
        before, box = canvas.screenshot(), canvas.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        opened.mouse.move(x, y)
        opened.mouse.down()
        opened.mouse.move(x + 80, y + 30, steps=4)
        opened.mouse.up()
        opened.mouse.move(5, 5)
        opened.wait_for_timeout(500)
        assert canvas.screenshot() != before


def test_the_search_works_without_a_network(visit):
    page = visit((HTML / "search.html").as_uri() + "?q=loxodrome")
    page.wait_for_selector("#search-results li a")
    assert page.locator("#search-results li a").count() > 3


def test_the_summary_prints_on_two_pages(visit):
    page = visit((HTML / "summary.html").as_uri())
    assert shown(page) == GOOD
    printed = page.pdf(prefer_css_page_size=True)
    assert len(re.findall(rb"/Type\s*/Page\b", printed)) == 2


@pytest.mark.parametrize("name", ["what", "where"])
def test_the_slides_go_on_with_the_arrow_keys_and_fit(visit, name):
    page = visit((HTML / "slides" / f"{name}.html").as_uri())
    page.wait_for_function("() => window.Reveal?.isReady()")
    for number in range(page.evaluate("Reveal.getTotalSlides()")):
        assert page.evaluate("Reveal.getIndices().h") == number
        assert page.evaluate("Reveal.getCurrentSlide().scrollHeight") <= 730, number
        page.keyboard.press("ArrowRight")
