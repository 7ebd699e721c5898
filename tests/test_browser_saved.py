"""Files that go into the explorer and come out of it, links and code, in a real browser."""

import os
import signal
import socket
import xml.etree.ElementTree as tree
from urllib.parse import urlsplit

import numpy as np
import pytest
from browsing import Reader, image, is_drawn, judge, start

from inetlib import examples, io, mesh
from inetlib.explorer import session

pytestmark = pytest.mark.browser


def test_what_is_saved_is_what_is_shown(tab, tmp_path):
    reader = tab("kind=revolution&m=8&n=6&theta=75&theta0=60")

    def save(suffix):
        reader.page.locator(".in-save").click()
        items = reader.page.locator(".v-overlay__content .v-list-item-title").all_text_contents()
        assert [f".{item.split(',')[0].strip().lower()}" for item in items] == list(session.SAVED)
        with reader.page.expect_download() as waiting:
            reader.page.locator(".v-list-item", has_text=suffix[1:].upper()).click()
        path = tmp_path / waiting.value.suggested_filename
        waiting.value.save_as(path)
        assert path.name == f"vase_75_60{suffix}"
        return path

    V, Q = judge(reader)
    assert all(map(np.array_equal, io.read(save(".obj")), (V, Q)))
    root = tree.fromstring(save(".svg").read_text(encoding="utf-8"))
    found = {part.tag.rpartition("}")[2] for part in root.iter()}
    assert root.tag.endswith("svg") and {"image", "path"} <= found  # the surface, its curves
    assert is_drawn(image(save(".png").read_bytes()))


def test_the_code_and_the_link_can_be_copied(tab, address):
    permissions = "clipboard-read", "clipboard-write"
    reader = tab("kind=plane&map=exp&theta=80&theta0=50", permissions=permissions)
    reader.page.get_by_title("Copy link").click()
    reader.page.locator(".out-alert", has_text="link copied").wait_for()
    copied = reader.page.evaluate("navigator.clipboard.readText()")
    reader.page.wait_for_function("link => location.href == link", arg=copied)
    other = tab(urlsplit(copied).query)
    assert urlsplit(copied)._replace(query="").geturl() == f"{address}index.html"
    reader.type("theta", "81")
    reader.page.wait_for_function("() => location.search.includes('theta=81')")
    reader.type("theta", "80")
    assert other.angles() == ["80.000000", "50.000000"]
    reader.page.get_by_title("Python").click()
    code = reader.text(".ex-code")
    assert len(code.splitlines()) == 3 and code == reader.page.evaluate("trame.state.get('code')")


def test_a_file_of_the_command_line_is_covered_and_sigint_ends_everything(chromium, tmp_path):
    path = tmp_path / "my roof.obj"
    io.write(path, *examples.wavy_roof(15))
    before = path.read_bytes()
    process, address = start(path, folder=tmp_path, environment=os.environ.copy())
    try:
        page = chromium.new_page()
        reader = Reader(page, address, "quads=120&theta=70&theta0=60&kind=cover&source=file")
        assert "converged in" in reader.text(".out-message")
        assert page.title().startswith("my roof 70 60")
        assert page.locator(".in-source", has_text="my roof.obj").is_visible()
        V, Q = judge(reader)
        assert mesh.is_labelled(Q) and 60 < len(Q) < 240
        assert int(reader.text(".out-cut")) > 0 and len(V) > Q.max() + 1  # up to the edge
        reader.type("quads", "4000")  # a search is under way when it ends
    finally:
        process.send_signal(signal.SIGINT)
        code, rest = process.wait(20), process.stdout.read()
        process.stdout.close()
    page.close()
    assert (code, rest) == (0, "")
    with pytest.raises(OSError), socket.create_connection(("127.0.0.1", urlsplit(address).port)):
        pass
    assert os.listdir(tmp_path) == ["my roof.obj"] and path.read_bytes() == before
