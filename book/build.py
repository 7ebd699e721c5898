"""The book: `make book` writes book/_build/html, to be read in a browser, online or not.

    python book/build.py

The notebooks are shown as they are stored: nothing is run again.  All warnings are errors."""

import shutil
import sys
from importlib import resources
from pathlib import Path

import pages
import scenes
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


def main():
    """Exit code 0 when the book is there without a warning."""
    assemble()
    shutil.rmtree(HTML, ignore_errors=True)
    options = ["--fail-on-warning", "--keep-going", "--quiet", "--jobs", "auto"]
    doctrees = ["--doctree-dir", str(BUILT / "doctrees"), "--conf-dir", str(HERE)]
    failed = build_main([*options, "--builder", "html", *doctrees, str(SOURCE), str(HTML)])
    print(f"the book: {HTML / 'index.html'}" if not failed else "the book has faults: see above")
    return failed


if __name__ == "__main__":
    sys.exit(main())
