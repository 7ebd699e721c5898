"""What the browser tests share: a Chromium, a running explorer, and ways to look at its page."""

import io
import re
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from inetlib import measure
from inetlib.explorer import choices

OPTIONS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
PATIENCE = 30_000  # milliseconds: a busy machine is no failure


def start(*words, folder, environment, program=("-m", "inetlib.explorer")):
    """(process, address) of `python -m inetlib.explorer --port 0 ...`, or of another program."""
    command = [sys.executable, *program, "--port", "0", *map(str, words)]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, text=True, cwd=folder, env=environment
    )
    line = process.stdout.readline()
    found = re.fullmatch(
        r"Isogonal nets: (http://127\.0\.0\.1:\d+/[\w-]{22}/) \(Ctrl-C ends it\)\n", line
    )
    assert found, line
    return process, found[1]


STILL = """async () => {  // the server answers in order, and changes wait for one another
  const frame = () => new Promise(requestAnimationFrame);
  const answers = async (count) => {
    for (let k = 0; k < count; k += 1) {
      await frame();
      await trame.client.getRemote().Trame.lifeCycleUpdate('client_still');
    }
    await frame();
  };
  const end = performance.now() + 30000;
  await answers(2);
  while (trame.state.get('searching') || trame.state.get('trame__busy')) {
    if (performance.now() > end) throw new Error('it goes on and on');
    await frame();
  }
  await answers(3);
}"""


REST = """async () => {  // what is seen when nothing moves, drawn now and not when there is time
  inet.sharpen();
  await new Promise((done) => setTimeout(done, 20));
  inet.view().$.provides.view.renderWindow.render();
  for (let k = 0; k < 2; k += 1) await new Promise(requestAnimationFrame);
}"""


class Reader:
    """A tab of the explorer, and what a person would do and read there."""

    def __init__(self, page, address, query="", tour=False):
        self.page, self.address, self.errors = page, address, []
        if not tour:
            page.add_init_script("localStorage.setItem('inet-tour', 'seen')")
        page.set_default_timeout(PATIENCE)
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.goto(f"{address}?{query}")
        page.wait_for_selector(".out-flips:not(:empty)")
        page.wait_for_function("() => window.inet && window.trame")
        self.settled()

    def settled(self):
        """Wait until the server has done what it was asked for, and the view shows it."""
        self.page.evaluate(STILL)

    def text(self, name):
        return self.page.inner_text(name).strip()

    def angles(self):
        """The mean angles as the page shows them, degrees, two texts."""
        return [self.text(f".out-mean-{name}").rstrip("\u00b0") for name in ("theta", "theta0")]

    def choice(self):
        """What the page's link says."""
        choice, problems = choices.parse(self.page.evaluate("trame.state.get('link')"))
        assert problems == []
        return choice

    def net(self):
        """V, Q made by the three lines of Python that the page offers."""
        self.made = {}  # all names that they give a value
        exec(self.page.evaluate("trame.state.get('code')"), self.made)
        return self.made["V"], self.made["Q"]

    def drag(self, name, part):
        """Drag a slider's thumb to a part of its track, as a hand does."""
        track = self.page.locator(f".in-{name} .v-slider-track").bounding_box()
        thumb = self.page.locator(f".in-{name} [role=slider]").bounding_box()
        y = thumb["y"] + thumb["height"] / 2
        self.page.mouse.move(thumb["x"] + thumb["width"] / 2, y)
        self.page.mouse.down()
        self.page.mouse.move(track["x"] + part * track["width"], y, steps=8)
        self.page.mouse.up()
        self.settled()

    def type(self, name, value):
        field = self.page.locator(f".in-{name} input[inputmode]")
        field.fill(str(value))
        field.press("Enter")
        self.settled()

    def choose(self, name, words):
        self.page.locator(f".in-{name}").first.click()
        self.page.locator(".v-overlay__content .v-list-item", has_text=words).click()
        self.settled()

    def picture(self):
        """What the view shows when it is at rest: RGB (h, w, 3)."""
        self.page.evaluate(REST)
        return image(self.page.locator(".ex-view").screenshot())


def image(data):
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)


def is_drawn(picture):
    """Whether there is a net before a plain background."""
    share = (np.abs(picture - picture[-5, 5]).sum(axis=-1) > 30).mean()
    return 0.03 < share < 0.97 and len(np.unique(picture.reshape(-1, 3), axis=0)) > 50


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
