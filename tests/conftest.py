"""Drawing without a screen, and properties that try the same examples on every machine."""

import sys
from pathlib import Path

import matplotlib
import pytest
from hypothesis import settings

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tools"))

matplotlib.use("Agg")
settings.register_profile("still", derandomize=True, deadline=None, database=None, max_examples=60)
settings.load_profile("still")


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
