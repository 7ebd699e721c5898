"""What the page of the explorer holds: controls, view, numbers.  Widgets only, no logic."""

from contextlib import contextmanager
from importlib.resources import files

from trame.ui.vuetify3 import VAppLayout
from trame.widgets import client, html
from trame.widgets import vuetify3 as v3
from trame.widgets.vtk import VtkLocalView

from . import panels
from .session import SAVED, missing

FOLDER = files("inetlib.explorer")
MIME = {".svg": "image/svg+xml", ".png": "image/png"}
HELP = {
    "Two angles": "Every quad has the same angle \u03b8 between its diagonals and the same angle "
    "\u03b8\u2080 between the lines that join midpoints of opposite sides. Two ratios say the "
    "same: \u03bb of the diagonals, \u03bc of these medial lines.",
    "Mouse and touch": "Drag to turn, drag with two fingers or the middle button to move, wheel "
    "or pinch to zoom.",
    "Keyboard": "Tab reaches every control. On a slider the arrow keys change the value; on the "
    "view they turn it, + and - zoom, F fits the net.",
    "Numbers": "Type any value that a slider has no step for, and press Enter. Deviations are "
    "the largest over all faces, from the angles asked for.",
}


def build(server, plotter, given=False):
    """The page of a server: its layout is stored there; returns the view of the plotter.

    given: the net came from Python, so that nothing is chosen but what is shown.
    """
    theme = ("dark ? 'dark' : 'light'",)
    with VAppLayout(server, theme=theme, style=("palette",)):
        client.Style((FOLDER / "page.css").read_text(encoding="utf-8"))
        _bar(given)
        with v3.VMain(style="height: 100vh; height: 100dvh"), html.Div(classes="ex"):
            with html.Div(classes="ex-side ex-left"):
                panels.controls(given)
            view = _view(plotter)
            with html.Div(classes="ex-side ex-right"):
                panels.numbers()
        _dialogs()
        client.JSEval(ref="address", exec="utils.get('inet').link($event)")
        client.Script((FOLDER / "client.js").read_text(encoding="utf-8"))
    return view


def _bar(given):
    with v3.VAppBar(density="compact", elevation=1, height=46):
        v3.VAppBarTitle("Isogonal nets")
        v3.VSpacer()
        with v3.VMenu():
            with v3.Template(v_slot_activator="{ props }"):
                _button("mdi-download", "Save", v_bind="props", classes="in-save")
            _save_items()
        if not given:
            _button("mdi-link-variant", "Copy link", click="utils.get('inet').copyLink(link)")
            _button("mdi-language-python", "Python", click="code_open = true")
        _button("mdi-theme-light-dark", "Light or dark", click="dark = !dark")
        _button("mdi-help-circle-outline", "Help", click="help_open = true")


def _button(icon, words, **options):
    classes = f"text-none {options.pop('classes', '')}"
    with v3.VBtn(size="small", variant="text", classes=classes, title=words, **options):
        v3.VIcon(icon, start=True)
        html.Span(words, classes="d-none d-md-inline")


def _save_items():
    with v3.VList(density="compact"):
        for suffix in SAVED:
            package = missing(suffix)
            words = "picture" if suffix in MIME else "net with its curves"
            words = "net" if suffix in (".ply", ".off") else words
            mime = MIME.get(suffix, "application/octet-stream")
            about = {"title": f"{suffix[1:].upper()}, {words}", "disabled": bool(package)}
            if package:
                about["subtitle"] = f"needs the package {package}"
            v3.VListItem(click=f"utils.get('inet').save('{suffix}', '{mime}')", **about)


def _view(plotter):
    with html.Div(classes="ex-middle"):
        words = "the net; arrow keys turn it, plus and minus zoom, F fits it"
        keys = {"tabindex": "0", "keydown": "utils.get('inet').keys($event)"}
        with html.Div(classes="ex-view", aria_label=words, **keys):
            loaded = "utils.get('inet')?.loaded()"
            view = VtkLocalView(plotter.render_window, ref="view", after_scene_loaded=loaded)
            _tools()
        _status()
    return view


def _tools():
    with html.Div(classes="ex-tools"):
        for icon, words, call in (
            ("mdi-fit-to-page-outline", "Fit the net (F)", "fit"),
            ("mdi-arrow-down-circle-outline", "From above", "from_above"),
            ("mdi-arrow-right-circle-outline", "From the side", "from_side"),
        ):
            about = {"title": words, "aria_label": words, "classes": f"in-{call}"}
            click = f"trigger('{call}', [utils.get('inet').place()])"
            v3.VBtn(icon=icon, size="x-small", click=click, **about)


def _status():
    """One line below the view: why there is no net, or how far the search is, or on the net."""
    small = {"size": "x-small", "color": "primary"}
    with html.Div(classes="ex-status", role="status"):
        shown = {"v_if": ("problem && !searching",), "classes": "text-warning out-problem"}
        html.Div("{{ problem }}", **shown)
        with html.Div(v_if=("searching",)):
            v3.VProgressCircular(indeterminate=True, size=16, width=2, color="primary")
            html.Span("{{ progress }}", classes="out-progress ml-2")
            v3.VBtn("Stop", click="trigger('stop')", classes="text-none ml-2 in-stop", **small)
        with html.Div(v_if=("!searching && (message || can_search)",)):
            html.Span("{{ message }}", v_if=("!problem",), classes="out-message")
            again = {"v_if": ("can_search",), "classes": "text-none ml-2 in-run"}
            v3.VBtn("Run again", click="trigger('run')", **again, **small)


def _dialogs():
    with _dialog("code_open", "The same net in Python"):
        html.Pre("{{ code }}", classes="ex-code")
        html.Div("V: vertices, Q: quads; angles are radians in Python.", classes="ex-note mt-2")
        click = "utils.get('inet').copy(code, 'code')"
        v3.VBtn("Copy", size="small", classes="mt-3", color="primary", click=click)
    with _dialog("help_open", "How to use this page"):
        for title, words in HELP.items():
            html.H4(title, classes="mt-2")
            html.P(words, classes="text-body-2")
    gone = {"model_value": ("!!alert",), "update_modelValue": "alert = $event ? alert : ''"}
    v3.VSnackbar("{{ alert }}", timeout=7000, location="top", classes="out-alert", **gone)


@contextmanager
def _dialog(name, title):
    with v3.VDialog(v_model=(name,), max_width=760), v3.VCard(title=title):
        about = {"icon": "mdi-close", "variant": "text", "size": "small", "aria_label": "close"}
        place = "position: absolute; right: 0.5rem; top: 0.5rem"
        v3.VBtn(style=place, click=f"{name} = false", **about)
        with v3.VCardText():
            yield
