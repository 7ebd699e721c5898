"""Drawing without a screen, and properties that try the same examples on every machine."""

import functools
import inspect
import os
import signal
import sys
from pathlib import Path

import matplotlib
import pytest
from hypothesis import settings

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tools"))

pytest.register_assert_rewrite("browsing")
matplotlib.use("Agg")
settings.register_profile("still", derandomize=True, deadline=None, database=None, max_examples=60)
settings.load_profile("still")

LONGEST = ["notebooks", "elsewhere", "stopping", "exercises", "design"]
LONGEST += ["drawings", "explorer_serve", "course", "loxodrome", "io", "properties"]
LONGEST += ["publish", "explorer", "fuzz", "view", "browser_run"]


def pytest_addoption(parser):
    parser.addoption("--long", action="store_true", help="the tests marked long, too: half an hour")
    parser.addoption(
        "--book", action="store_true", help="the tests marked book, too: make book first"
    )


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem):
    """Tests that are coroutines run in the event loop of the fixture `run`."""
    if inspect.iscoroutinefunction(pyfuncitem.function):
        given = {name: pyfuncitem.funcargs[name] for name in pyfuncitem._fixtureinfo.argnames}
        pyfuncitem.funcargs["run"](pyfuncitem.function(**given))
        return True


def pytest_collection_modifyitems(config, items):
    # First the files that take longest, so that no core waits for another one at the end.
    order = {f"test_{name}": k for k, name in enumerate(LONGEST)}
    items.sort(key=lambda item: order.get(item.path.stem, len(order)))
    for name in ("long", "book"):
        if not config.getoption(f"--{name}"):
            marked = [item for item in items if item.get_closest_marker(name)]
            config.hook.pytest_deselected(items=marked)
            items[:] = [item for item in items if item not in marked]


def pytest_terminal_summary(terminalreporter):
    """What tests have counted (`record_property`): it comes from other processes, too."""
    for report in terminalreporter.getreports("passed"):
        for name, words in report.user_properties if report.when == "call" else ():
            terminalreporter.write_line(f"{name}: {words}")


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


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """The address of an explorer that runs for a whole file of tests."""
    from browsing import start

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
    from browsing import Reader

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


@pytest.fixture(scope="session")
def somebody(tmp_path_factory):
    """The environment of a user with a set-up of his own, which must change nothing."""
    home = tmp_path_factory.mktemp("a home")
    mine = "print('hello'); import matplotlib as m; m.rcParams['font.size']=30"
    kernel = '{"argv": ["nothing"], "display_name": "wrong", "language": "python"}'
    lines = "c.InteractiveShellApp.exec_lines = ['print(1)']"
    looks = "backend: svg\nfont.size: 17\nlines.linewidth: 4\naxes.facecolor: red\n"
    looks += "savefig.bbox: tight\nfigure.dpi: 50\nsvg.fonttype: none\npath.simplify: True\n"
    looks += "mathtext.fontset: stix\nimage.cmap: jet\n"
    profile = home / "profile_default"
    for path, text in {
        home / "matplotlibrc": looks,
        profile / "startup" / "mine.py": mine,
        profile / "ipython_kernel_config.py": lines,
        home / "kernels" / "python3" / "kernel.json": kernel,
    }.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    places = "HOME", "USERPROFILE", "MPLCONFIGDIR", "MATPLOTLIBRC", "IPYTHONDIR", "JUPYTER_PATH"
    other = {"MPLBACKEND": "svg", "LC_ALL": "de_DE.UTF-8", "TZ": "Asia/Tokyo"}
    other |= {"PYTHONHASHSEED": "7", "PYTHONSTARTUP": str(profile / "startup" / "mine.py")}
    return other | dict.fromkeys(places, str(home))
