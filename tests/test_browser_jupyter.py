"""The explorer inside JupyterLab, in a real browser (skipped where there is no Chromium)."""

import json
import os
import re
import subprocess
import sys
from urllib.parse import urljoin

import numpy as np
import pytest
from browsing import PATIENCE, image, is_drawn

from inetlib import explorer

pytestmark = pytest.mark.browser
CELLS = [
    "from inetlib import explorer, surfaces",
    "explorer.show(kind='revolution', m=12, n=10, theta=75)",
    "explorer.turn(*surfaces.freeform_patch(8, 8))",
    "import os; os.environ['INETLIB_PROXY'] = '/proxy/'; explorer.show(m=7, n=7)",
]


@pytest.fixture
def lab(tmp_path):
    """The address of a JupyterLab on this machine, in a folder with one notebook."""
    import nbformat

    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(c) for c in CELLS])
    notebook.metadata.kernelspec = {"name": "python3", "display_name": "Python 3"}
    nbformat.write(notebook, tmp_path / "look.ipynb")
    home = {f"JUPYTER_{k}_DIR": str(tmp_path / k) for k in ("CONFIG", "DATA", "RUNTIME")}
    environment = os.environ | home | {"IPYTHONDIR": str(tmp_path / "ipython")}
    environment.pop("JPY_SESSION_NAME", None)
    options = ["--no-browser", "--ServerApp.ip=127.0.0.1", "--ServerApp.port=0"]
    options += ["--allow-root", "--IdentityProvider.token=secret", f"--notebook-dir={tmp_path}"]
    command = [sys.executable, "-m", "jupyter", "lab", *options]
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, cwd=tmp_path, env=environment
    )
    for line in process.stderr:
        if found := re.search(r"http://127\.0\.0\.1:\d+/", line):
            break
    yield f"{found[0]}lab/tree/look.ipynb?token=secret"
    process.terminate()  # an interrupt would be asked about
    process.communicate(timeout=30)


def frame_of(page, address):
    """The frame with the page of an <object>, when the browser has begun it."""
    for _ in range(200):
        for frame in page.frames:
            if frame.url.partition("?")[0] == address.partition("?")[0]:
                return frame
        page.wait_for_timeout(100)
    raise AssertionError(f"no frame {address} among {[frame.url for frame in page.frames]}")


def test_jupyterlab_shows_a_live_view(chromium, lab, tmp_path):
    page = chromium.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(2 * PATIENCE)
    page.goto(lab)
    page.locator(".jp-NotebookPanel:not(.lm-mod-hidden) .jp-Cell").first.click()
    page.get_by_role("menuitem", name="Run", exact=True).click()
    page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
    for number, faces in ((1, 120), (2, 64), (3, 49)):
        output = page.locator(".jp-Cell").nth(number).locator("object")
        output.wait_for()
        output.scroll_into_view_if_needed()
        address = output.get_attribute("data")
        assert address.startswith("/proxy/") is (number == 3)  # by jupyter-server-proxy
        frame = frame_of(page, urljoin(page.url, address))
        frame.wait_for_selector(".out-flips:not(:empty)")
        assert f"Over all {faces} faces" in frame.inner_text(".ex-right")
        frame.wait_for_function("() => !trame.state.get('trame__busy')")
        page.wait_for_timeout(500)
        assert is_drawn(image(frame.locator(".ex-view").screenshot()))
    page.keyboard.press("Control+s")
    page.wait_for_timeout(1500)
    stored = json.loads((tmp_path / "look.ipynb").read_text(encoding="utf-8"))
    kinds = [set(o["data"]) for cell in stored["cells"][1:] for o in cell["outputs"]]
    assert len(kinds) == 3 and all("image/png" in k for k in kinds)
    assert not any("widget" in name for k in kinds for name in k)
    page.close()


def test_where_the_page_is_gone_the_picture_stays(chromium):
    png = explorer.show(live=False, m=6, n=6).data
    gone = explorer.notebook.Live("http://127.0.0.1:9/index.html", png, 400)
    page = chromium.new_page()
    page.set_content(gone._repr_mimebundle_()["text/html"])
    page.wait_for_function("() => document.images[0].complete")
    seen = image(page.locator("img").screenshot())
    assert len(np.unique(seen.reshape(-1, 3), axis=0)) > 50
    page.close()
