"""What takes long in the explorer, in a real browser: shown, stopped, timed and forgotten."""

import json
import os
import signal
import statistics
import time
from contextlib import contextmanager

import pytest
from browsing import Reader, judge, start

from inetlib import examples, io
from inetlib.design import STAGES

pytestmark = pytest.mark.browser


def test_an_optimisation_runs_can_be_stopped_and_run_again(tab):
    reader = tab("kind=freeform&m=20&n=20&theta=60&theta0=45")
    assert "converged in" in reader.text(".out-message")
    judge(reader)
    seen = reader.page.evaluate("inet.loads")
    reader.page.evaluate("trame.state.update({m: 100, n: 60})")
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


@pytest.mark.alone
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


COUNTED = """
import gc, json, os, signal, sys, threading
from inetlib.explorer.app import App
from inetlib.explorer.session import Session
from inetlib.start import main

find, under_way, counts = Session.find, set(), {"searches": 0, "at_once": 0}

def counted(session, run, *args):
    under_way.add(id(run))
    counts["searches"] += 1
    counts["at_once"] = max(counts["at_once"], len(under_way))
    try:
        return find(session, run, *args)
    finally:
        under_way.remove(id(run))

def tell(*_):
    names = [thread.name.split("_")[0] for thread in threading.enumerate()]
    counts["workers"] = names.count("search")
    counts["threads"] = len(names) - names.count("asyncio")  # these read files: a few at most
    counts["apps"] = sum(type(x) is App for x in gc.get_objects())
    with open("/proc/self/statm") as file:
        counts["mb"] = int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") >> 20
    print(json.dumps(counts), flush=True)

Session.find = counted
signal.signal(signal.SIGUSR1, tell)
sys.exit(main(["explore", *sys.argv[1:]]))
"""


@contextmanager
def counting(*words, folder):
    """(address, counts): an explorer that says on SIGUSR1 what it has; counts() asks it."""
    environment, program = os.environ.copy(), ("-c", COUNTED)
    process, address = start(*words, folder=folder, environment=environment, program=program)

    def counts():
        process.send_signal(signal.SIGUSR1)
        return json.loads(process.stdout.readline())

    try:
        yield address, counts
    finally:
        process.send_signal(signal.SIGINT)
        code = process.wait(20)
        process.stdout.close()
    assert code == 0


CAUGHT = """([begin, words, values]) => new Promise((resolve) => {
  // Change the page's state to begin.  When it shows these words, press Stop or change values;
  // milliseconds until nothing is searched, or the next search has begun.  0: not seen in time.
  const status = document.querySelector('.ex-status');
  let acted = 0, begun = false, next = false, last = performance.now();
  const end = (time) => {
    observer.disconnect();
    clearInterval(timer);
    resolve(time);
  };
  const look = () => {
    const shown = status.querySelector('.out-progress')?.innerText ?? '';
    const now = performance.now(), first = shown.startsWith('preparing');
    if (shown) last = now;
    begun ||= first;
    if (begun && !acted && shown.startsWith(words)) {
      acted = now;
      if (values) trame.state.update(values);
      else document.querySelector('.in-stop').click();
    } else if (acted && values) {
      if (next && shown && !first) end(now - acted);
      next ||= first;
    } else if (begun && !shown) end(acted && now - acted);
    if (now - last > 5000) end(0);
  };
  const observer = new MutationObserver(look), timer = setInterval(look, 10);
  observer.observe(status, {subtree: true, childList: true, characterData: true});
  trame.state.update(begin);
})"""
ENDS = {  # a stage: what is said when it was stopped
    "flatten": "stopped while the surface was flattened",
    "grid": "before there was a net",
    "optimise": "stopped by the caller",
    "report": "converged in",  # there was a net
}


def caught(reader, angles, name, **values):
    """Milliseconds in which a search was stopped, or changed to values, in the stage of a name.

    A busy machine may show it when it is over: then again."""
    for _ in range(5):
        begin = {"kind": "cover", "openings": "fill", "theta": next(angles)}
        found = reader.page.evaluate(CAUGHT, [begin, STAGES[name], values or None])
        said = reader.page.locator(".out-problem, .out-message")
        if found and (values or ENDS[name] in said.first.inner_text()):
            return found
    raise AssertionError(f"not stopped while {STAGES[name]}: {said.first.inner_text()}")


@pytest.mark.alone
def test_every_stage_of_a_search_is_shown_and_stops_by_button_and_by_the_next_change(
    chromium, tmp_path, capsys
):
    path = tmp_path / "large roof.ply"
    surface = examples.wavy_roof(350)
    io.write(path, *surface)
    angles, times = iter(range(61, 120)), {}
    with counting(path, folder=tmp_path) as (address, counts):
        page = chromium.new_page(viewport={"width": 1000, "height": 640})
        reader = Reader(
            page,
            address,
            "kind=plane&m=6&n=6&quads=20000&trim=1&theta0=70&target=0&families=&parallelograms=0",
        )
        for name in ENDS:
            changed = caught(reader, angles, name, theta=next(angles))
            times[STAGES[name]] = caught(reader, angles, name), changed
        begun = counts()["searches"]
        assert counts()["at_once"] == 1  # the next one waited for each
        page.evaluate("trame.state.update({quads: 300, trim: false, theta: 75})")
        reader.settled()
        assert reader.angles() == ["75.000000", "70.000000"]
        assert "converged in" in reader.text(".out-message")
        judge(reader)
        page.close()
    assert begun >= 3 * len(ENDS) and reader.errors == []
    lines = [f"{words}: {one:.0f} and {two:.0f} ms" for words, (one, two) in times.items()]
    with capsys.disabled():
        print(
            f"\n{len(surface[1])} triangles; over after Stop, and after a change", *lines, sep="\n"
        )
    assert max(max(pair) for pair in times.values()) < 5000  # this machine may be busy


def test_moves_of_a_slider_during_a_search_do_not_pile_up(chromium, tmp_path, record_property):
    with counting(folder=tmp_path) as (address, counts):
        page = chromium.new_page(viewport={"width": 1000, "height": 640})
        reader = Reader(page, address, "kind=cover&source=saddle&quads=4000&theta=70&target=0")
        before = counts()
        slider = page.locator(".in-theta [role=slider]")
        for _ in range(6):
            slider.press("ArrowRight")
            page.locator(".out-progress", has_not_text="preparing").wait_for()  # it runs
        reader.settled()
        after = counts()
        assert reader.choice().theta == 76 and reader.angles()[0] == "76.000000"
        assert "converged in" in reader.text(".out-message")
        page.close()
    assert after["at_once"] == 1 and after["threads"] == before["threads"]
    assert before["searches"] == 1 and 2 <= after["searches"] <= 7 and reader.errors == []
    record_property("6 moves during a search", f"{after['searches'] - 1} searches, one at a time")


def left(counts):
    """The counts when closed tabs have ended and been collected, or after ten seconds."""
    for _ in range(50):
        found = counts()
        if found["apps"] <= 1 and not found["workers"]:
            break
        time.sleep(0.2)
    return found


def test_tabs_that_are_closed_during_a_search_leave_nothing_behind(
    chromium, tmp_path, record_property
):
    context, found = chromium.new_context(viewport={"width": 900, "height": 560}), []
    with counting(folder=tmp_path) as (address, counts):
        for k in range(13):
            page = context.new_page()
            reader = Reader(page, address, "kind=plane&m=60&n=60&families=&parallelograms=0")
            page.evaluate("trame.state.set('kind', 'freeform')")
            for _ in range(6):
                page.locator(".in-theta [role=slider]").press("ArrowRight")
            page.locator(".out-progress", has_text="optimising").wait_for()
            assert k or counts()["workers"] == 1
            page.close()
            assert reader.errors == []
            if k in (9, 12):
                found.append(left(counts))
    for number, x in zip((10, 13), found, strict=True):
        counted = ", ".join(f"{x[name]} {name}" for name in ("apps", "workers", "threads", "mb"))
        record_property(f"{number} tabs with 7 changes each, closed during a search", counted)
    few, many = found
    assert [(x["apps"], x["workers"]) for x in found] == [(1, 0), (1, 0)]  # that of the server
    assert many["threads"] == few["threads"] and many["mb"] < 1.2 * few["mb"]
    assert many["searches"] >= 13 and many["at_once"] == 1


def test_a_page_does_not_grow_with_its_changes(tab, record_property):
    reader, found = tab("m=12&n=12&families=u,v,d1,d2&parallelograms=1"), []
    session = reader.page.context.new_cdp_session(reader.page)
    session.send("Performance.enable")
    slider = reader.page.locator(".in-theta [role=slider]")
    for _ in range(3):
        for key in ("ArrowRight", "ArrowLeft") * 25:
            slider.press(key)
        reader.settled()
        session.send("HeapProfiler.collectGarbage")
        metrics = {x["name"]: x["value"] for x in session.send("Performance.getMetrics")["metrics"]}
        found.append([metrics[k] for k in ("Nodes", "JSEventListeners", "JSHeapUsedSize")])
    session.detach()
    for number, (nodes, listeners, size) in zip((50, 100, 150), found, strict=True):
        counted = f"{nodes:.0f} nodes, {listeners:.0f} listeners, {size / 1e6:.1f} MB of JavaScript"
        record_property(f"a page after {number} changes", counted)
    for first, last in zip(found[0], found[-1], strict=True):
        assert last < 1.1 * first
