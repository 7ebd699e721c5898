"""The book: `make book` writes book/_build/html, to be read in a browser, online or not.

    python book/build.py

The notebooks are shown as they are stored: nothing is run again.  All warnings are errors."""

import shutil
import sys
from html.parser import HTMLParser
from importlib import resources
from pathlib import Path
from urllib.parse import unquote, urldefrag

import pages
import scenes
import slides
from sphinx.cmd.build import build_main

HERE = Path(__file__).resolve().parent
BUILT = HERE / "_build"
SOURCE, HTML = BUILT / "source", BUILT / "html"
# What pages load beside our own files: (package, file in it, name in _static)
PARTS = [
    ("trame_client", "module/vue3-www/vue.global.js", "vue.global.js"),
    ("trame_vtk", "modules/common/serve/trame-vtk.js", "trame-vtk.js"),
    ("mathjax", "static/mathjax/es5/tex-svg.js", "mathjax/tex-svg.js"),
]


def assemble():
    """Write everything that Sphinx reads into _build/source."""
    shutil.rmtree(SOURCE, ignore_errors=True)
    static = SOURCE / "_static"
    (static / "mathjax").mkdir(parents=True)
    for package, file, name in PARTS:
        shutil.copyfile(resources.files(package) / file, static / name)
    for file in (*HERE.glob("*.js"), *HERE.glob("*.css")):
        shutil.copyfile(file, static / file.name)
    scenes.write(static / "scenes")
    pages.write(SOURCE)


class Page(HTMLParser):
    """What a page has (its anchors) and what it asks for (links, pictures, scripts, styles)."""

    def __init__(self, path):
        super().__init__()
        self.anchors, self.asked = {""}, set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.anchors |= {given[name] for name in ("id", "name") if given.get(name)}
        self.asked |= {given[name] for name in ("href", "src") if given.get(name) and tag != "base"}


def broken(folder: Path) -> list[str]:
    """Links of the pages in a folder that lead nowhere in it, or load from another host."""
    pages = {
        path: Page(path) for path in sorted(folder.rglob("*.html")) if "_static" not in path.parts
    }
    found = []
    for path, page in pages.items():
        for address in sorted(page.asked):
            if address.startswith(("https://", "http://", "mailto:", "data:")):
                continue  # somewhere else, for who follows it; what is loaded is judged in tests
            file, mark = urldefrag(address)
            target = (path.parent / unquote(file.partition("?")[0])).resolve() if file else path
            there = pages[target].anchors if target in pages else {""}
            if not target.exists() or unquote(mark) not in there:
                found.append(f"{path.relative_to(folder)}: {address}")
    return found


def main():
    """Exit code 0 when the book is there without a warning, and all its links lead somewhere."""
    assemble()
    shutil.rmtree(HTML, ignore_errors=True)
    options = ["--fail-on-warning", "--keep-going", "--quiet", "--jobs", "auto"]
    doctrees = ["--doctree-dir", str(BUILT / "doctrees"), "--conf-dir", str(HERE)]
    failed = build_main([*options, "--builder", "html", *doctrees, str(SOURCE), str(HTML)])
    if not failed:
        slides.write(HTML)
    for line in (lost := [] if failed else broken(HTML)):
        print(f"a link to nothing: {line}", file=sys.stderr)
    failed = failed or int(bool(lost))
    print(f"the book: {HTML / 'index.html'}" if not failed else "the book has faults: see above")
    return failed


if __name__ == "__main__":
    sys.exit(main())
