"""What takes long in the explorer, in a real browser: shown, stopped, timed and forgotten."""

import statistics

import pytest
from browsing import judge

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
