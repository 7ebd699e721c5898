"""The settings of the book for Sphinx; `build.py` writes the pages and calls it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

project = "Discrete isogonal nets"
author = "The inetlib developers"
project_copyright = "the inetlib developers; the paper is by Wang, Li, Li and Wang"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.viewcode", "sphinx.ext.mathjax"]
exclude_patterns = []

html_theme = "sphinx_book_theme"
html_title = "Discrete isogonal nets"
html_static_path = ["_build/source/_static"]
html_css_files = ["book.css", "scenes.css"]
html_js_files = [("viewer.js", {"defer": "defer"})]
html_theme_options = {
    "use_download_button": False,
    "use_fullscreen_button": False,
    "show_toc_level": 2,
    "home_page_in_toc": True,
    "show_navbar_depth": 1,
}
smartquotes = False
html_show_search_summary = False  # it would fetch, which a page from a file may not
html_context = {"default_mode": "auto"}
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False

mathjax_path = "mathjax/tex-svg.js"
mathjax3_config = {"options": {"enableMenu": False}}  # its menu would ask other hosts

nb_execution_mode = "off"  # the notebooks are shown as they are stored
nb_merge_streams = True
nb_code_prompt_show = "{type}"
myst_enable_extensions = [
    "amsmath",
    "dollarmath",
    "attrs_inline",
    "attrs_block",
    "colon_fence",
    "html_image",
]
myst_heading_anchors = 4
myst_heading_slug_func = "wording.slug"

nitpicky = True  # what is linked must be there
autodoc_member_order = "bysource"
autodoc_inherit_docstrings = False
autodoc_typehints = "none"


def setup(app):
    """Docstrings are the library's own plain words, not reStructuredText."""
    import pages
    import wording

    def words(app, what, name, obj, options, lines):
        lines[:] = wording.restructured(lines, lambda item: pages.address(item, 1, "html"))

    def unsaid(app, what, name, obj, skip, options):  # fields are told of in their class
        return skip or (getattr(obj, "__doc__", "") or "").startswith("Alias for field number")

    app.connect("autodoc-process-docstring", words)
    app.connect("autodoc-skip-member", unsaid)
