"""Drawing without a screen, and properties that try the same examples on every machine."""

import inspect
import sys
from pathlib import Path

import matplotlib
import pytest
from hypothesis import settings

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tools"))

matplotlib.use("Agg")
settings.register_profile("still", derandomize=True, deadline=None, database=None, max_examples=60)
settings.load_profile("still")


def pytest_addoption(parser):
    parser.addoption("--long", action="store_true", help="the tests marked long, too: half an hour")


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem):
    """Tests that are coroutines run in the event loop of the fixture `run`."""
    if inspect.iscoroutinefunction(pyfuncitem.function):
        given = {name: pyfuncitem.funcargs[name] for name in pyfuncitem._fixtureinfo.argnames}
        pyfuncitem.funcargs["run"](pyfuncitem.function(**given))
        return True


def pytest_collection_modifyitems(config, items):
    if not config.getoption("--long"):
        long = [item for item in items if item.get_closest_marker("long")]
        config.hook.pytest_deselected(items=long)
        items[:] = [item for item in items if item not in long]


@pytest.fixture(scope="module")
def chromium():
    """A running Chromium, driven by playwright; skipped with the reason where there is none."""
    import browser  # tools/browser.py
    from browsing import OPTIONS

    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    path = browser.chromium()
    if path is None:
        pytest.skip("no Chromium is here: make test-browser installs it")
    with playwright.sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=path, args=OPTIONS)
        yield found
        found.close()
