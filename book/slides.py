"""Slides of the lectures, by reveal.js: one page each, to be opened without a network.

A file of `slides/` is Markdown; a line of three dashes ends a slide, `NOTE:` begins what is said
(key S shows it in a window of its own)."""

import re
from html import escape
from importlib import resources
from pathlib import Path

from markdown_it import MarkdownIt
from mdit_py_plugins.attrs import attrs_plugin
from mdit_py_plugins.dollarmath import dollarmath_plugin

HERE = Path(__file__).resolve().parent
# reveal.js itself: (file of the package, name in _static/reveal)
PARTS = [
    ("dist/reveal.css", "reveal.css"),
    ("dist/reveal.js", "reveal.js"),
    ("plugin/notes/notes.js", "notes.js"),
    ("LICENSE", "LICENSE"),
]
PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<link rel="stylesheet" href="../_static/reveal/reveal.css">
<link rel="stylesheet" href="../_static/scenes.css">
<link rel="stylesheet" href="../_static/slides.css">
<script>window.MathJax = {{options: {{enableMenu: false}}}};</script>
<script defer src="../_static/mathjax/tex-svg.js"></script>
<script defer src="../_static/reveal/reveal.js"></script>
<script defer src="../_static/reveal/notes.js"></script>
<script defer src="../_static/viewer.js"></script>
<script defer src="../_static/slides.js"></script>
</head>
<body>
<div class="reveal"><main class="slides">
{slides}
</main></div>
</body>
</html>
"""


def _mathematics(content, options):
    """A formula as MathJax finds it."""
    ends = r"\[{}\]" if options["display_mode"] else r"\({}\)"
    return ends.format(escape(content))


def slides(text: str) -> list[str]:
    """The slides of a file, each an HTML section."""
    markdown = MarkdownIt("commonmark").enable("table").use(attrs_plugin)
    markdown.use(dollarmath_plugin, renderer=_mathematics)
    found = []
    for slide in re.split(r"(?m)^---\n", text):
        shown, _, said = slide.partition("NOTE:")
        notes = f'<aside class="notes">{escape(said.strip())}</aside>' if said else ""
        found.append(f"<section>\n{markdown.render(shown)}{notes}</section>")
    return found


def write(html: Path):
    """Write the slides into the built book, and what they load."""
    static = html / "_static" / "reveal"
    static.mkdir(parents=True)
    source = resources.files("sphinx_revealjs") / "_static" / "revealjs"
    for file, name in PARTS:
        (static / name).write_bytes((source / file).read_bytes())
    (html / "slides").mkdir()
    for path in sorted((HERE / "slides").glob("*.md")):
        text = path.read_text(encoding="utf-8")
        page = PAGE.format(
            title=text.partition("\n")[0].lstrip("# "), slides="\n".join(slides(text))
        )
        (html / "slides" / f"{path.stem}.html").write_text(page, encoding="utf-8")
