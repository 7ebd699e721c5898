"""What the page of the explorer holds: controls, view, numbers.  Widgets only, no logic."""

from contextlib import contextmanager
from importlib.resources import files
from typing import Any

from trame.ui.vuetify3 import VAppLayout
from trame.widgets import client, html
from trame.widgets import vuetify3 as v3
from trame.widgets.vtk import VtkLocalView

from ..io import WITH_CURVES, missing
from . import choices, welcome, widgets
from .session import SAVED

FOLDER = files("inetlib.explorer")
MIME = {".svg": "image/svg+xml", ".png": "image/png"}
TOOLS = (
    ("mdi-fit-to-page-outline", "Fit the net (F)", "fit"),
    ("mdi-arrow-down-circle-outline", "From above", "from_above"),
    ("mdi-arrow-right-circle-outline", "From the side", "from_side"),
)
SMALL = {"hide_details": True, "density": "compact"}
FIELD = SMALL | {"variant": "outlined"}
SWITCH = SMALL | {"color": "primary"}
SLIDER = SWITCH | {"thumb_size": 15, "track_size": 3}
SIZES = "square root of a face's area, in the units of the net"
PLANARITY = "distance between the diagonals, in % of their mean length"
SHOWN = {  # what can be shown of a net
    "u": "u-curves",
    "v": "v-curves",
    "d1": "diagonals d\u2081",
    "d2": "diagonals d\u2082",
    "parallelograms": "inscribed parallelograms",
}


def build(server: Any, plotter: Any, given: bool = False) -> Any:
    """The page of a server, or that of a net that is given; returns the view of the plotter."""
    theme = ("dark ? 'dark' : 'light'",)
    with VAppLayout(server, theme=theme, style=("palette",)):
        for name in ("page.css", "touch.css"):
            client.Style((FOLDER / name).read_text(encoding="utf-8"))
        for name in ("client.js", "touch.js"):  # before the view is there
            client.Script((FOLDER / name).read_text(encoding="utf-8"))
        _bar(given)
        with v3.VMain(), html.Div(classes="ex"):
            with html.Div(classes="ex-side ex-left", **_named("what is shown", role="region")):
                _controls(given)
            view = _view(plotter)
            with html.Div(classes="ex-side ex-right", **_named("numbers", role="region")):
                _numbers()
        _dialogs(given)
        if not given:
            welcome.presets(server, _dialog)
        client.JSEval(ref="address", exec="utils.get('inet').link($event)")
    return view


def _controls(given):
    """What is chosen; of a given net only what is shown."""
    if not given:
        with html.Div(classes="d-flex align-center justify-space-between"):
            html.H2("Net")
            about = {"prepend_icon": "mdi-view-grid-outline", "classes": "text-none in-presets"}
            about |= {"size": "small", "variant": "tonal", "title": "Nets to begin with"}
            v3.VBtn("Presets", click="presets_open = true", **about)
        _select("kind", "made from")
        _select("map", "map", "kind == 'plane'")
        _select("surface", "surface", "kind == 'isothermal'")
        _select("source", "surface", "kind == 'cover'")
        _select("openings", "hole", "kind == 'cover' && has_one_hole")
        html.H2("Angles")
        with html.Div(classes="ex-angles"):
            _number("theta", "\u03b8", ends=(1, 179))
            _number("theta0", "\u03b8\u2080", ends=(1, 179))
        words = "lock \u03b8 = \u03b8\u2080 (\u03bb = \u03bc)"
        v3.VSwitch(v_model=("lock",), label=words, classes="in-lock", **SWITCH)
        html.H2("Size")
        _number("m", "m along u", "kind != 'cover'")
        _number("n", "n along v", "kind != 'cover'")
        _number("quads", "quads", "kind == 'cover'")
        _number("direction", "direction", "kind == 'cover'")
        trimmed = {"label": "panels to the edge", "v_show": "kind == 'cover'"}
        v3.VSwitch(v_model=("trim",), classes="in-trim", **trimmed, **SWITCH)
        bent = "kind == 'isothermal' && surface != 'sphere'"
        _number("bend", "bending", bent, (0, "surface == 'rolled' ? 350 : 90"))
        about = {"label": "M\u00f6bius image", "v_show": "kind == 'isothermal'"}
        v3.VSwitch(v_model=("moebius",), classes="in-moebius", **about, **SWITCH)
        inverted = "(kind == 'isothermal' && moebius)"
        pole = f"{inverted} || (kind == 'plane' && map == 'moebius')"
        for name, condition in (("px", pole), ("py", pole), ("pz", inverted)):
            _number(name, f"pole {name[1]}", condition)
        _profile()
    _shown(given)


def _select(name, label, condition="true"):
    items = [{"title": words, "value": key} for key, words in choices.OPTIONS[name].items()]
    about = {"label": label, "v_show": condition, "classes": f"my-2 in-{name}"}
    v3.VSelect(v_model=(name,), items=(f"{name}_items", items), **about, **FIELD)


def _number(name, label, condition="true", ends=None):
    """A label, a slider and a field for the same value."""
    low, high, step, unit = choices.ALLOWED[name][:4]
    low, high = ends or (low, high)
    value = {"model_value": (f"Number(Number({name}).toPrecision(10))",), "suffix": unit or None}
    about = {"v_show": condition, "title": welcome.TIPS[name]}
    with html.Div(classes=f"ex-row in-{name}", **about):
        html.Label(label, v_pre=True)
        _slider(label, low, high, step, v_model=(name,))
        _field(label, change=f"{name} = $event.target.value", **value)


def _slider(label, low, high, step, **value):
    ends = {"min": (f"{low}",), "max": (f"{high}",), "step": step}
    v3.VSlider(name=label, **value, **ends, **SLIDER)  # the thumb's name for screen readers


def _field(label, **value):
    v3.VTextField(inputmode="decimal", **_named(f"{label}, value"), **value, **FIELD)


def _named(words, **more):
    """A name for screen readers, and other attributes that trame drops unless they are raw."""
    given = {"aria-label": words} | {name.replace("_", "-"): x for name, x in more.items()}
    return {"raw_attrs": [f'{name}="{x}"' for name, x in given.items() if x]}


def _profile():
    """The radii, each with a slider and a field, the topmost first."""
    low, _, step = choices.RADIUS[:3]
    with html.Div(v_show="kind == 'revolution'"):
        html.H2("Profile")
        with html.Div(classes="d-flex flex-wrap ga-1 mb-1"):
            for name, radii in choices.PROFILES.items():
                about = {"classes": "text-none px-1 flex-grow-1", "click": f"radii = {list(radii)}"}
                v3.VBtn(name, size="x-small", variant="tonal", **about)
        with html.Div(classes="ex-profile"):
            html.Div(v_html="profile_svg", classes="ex-plate")
            with html.Div():
                for k, height in reversed(list(enumerate(choices.HEIGHTS))):
                    new = f"radii = radii.map((r, i) => i == {k} ? %s : r)"
                    label, value = f"radius at height {height:g}", {"model_value": (f"radii[{k}]",)}
                    with html.Div(classes=f"ex-row in-radius{k}"):
                        _slider(label, low, 2.4, step, update_modelValue=new % "$event", **value)
                        _field(label, change=new % "$event.target.value", **value)


def _shown(given):
    html.H2("Show")
    with html.Div(classes="ex-families"):
        for name in choices.FAMILIES:
            colour = {"color": (f"colours.{name}",), "base_color": (f"colours.{name}",)}
            about = {"value": name, "label": SHOWN[name], "classes": f"in-{name}"}
            v3.VCheckbox(v_model=("families",), **about, **colour, **SMALL)
    name = "parallelograms"
    v3.VCheckbox(v_model=(name,), label=SHOWN[name], classes=f"in-{name}", **SWITCH)
    _select("shade", "shade faces by")
    with (
        html.Div(v_show="legend.length", classes="ex-scale out-legend"),
        html.Div(v_for="(step, k) in legend", key="k"),
    ):
        html.I(style=("{ background: step[0] }",))
        html.Span("{{ step[1] }}")
    html.Div(SIZES, v_show="shade == 'size'", classes="ex-note")
    html.Div(PLANARITY, v_show="shade == 'planarity'", classes="ex-note")
    widgets.beside(given)


def _numbers():
    """The parallelogram, and what there is to say of the net."""
    html.H2("{{ face.name || 'Parallelogram' }}", classes="out-face")
    html.Div(v_html="parallelogram_svg", classes="ex-plate out-parallelogram")
    with html.Div(classes="ex-note ex-ratios out-ratios"):
        html.Span("\u03bb = |d\u2082|/|d\u2081| = {{ face.lam || numbers.lam }}")
        html.Span("\u03bc = |m\u2081\u2083|/|m\u2082\u2084| = {{ face.mu || numbers.mu }}")
    widgets.face()
    html.H2("Over all {{ numbers.quads }} {{ numbers.faces }}")
    with html.Table(classes="ex-numbers"):
        with html.Tr():
            for words in ("", "mean", "off at most"):
                html.Th(words)
        for name, words in (("theta", "\u03b8"), ("theta0", "\u03b8\u2080")):
            with html.Tr():
                html.Td(words)
                html.Td(f"{{{{ numbers.mean_{name} }}}}\u00b0", classes=f"out-mean-{name}")
                html.Td(f"{{{{ numbers.{name}_off }}}}\u00b0", classes=f"out-off-{name}")
        with html.Tr(v_show="numbers.others"):
            html.Td("{{ numbers.others }}")
            html.Td("{{ numbers.cut }}", colspan=2, classes="out-cut")
        with html.Tr():
            html.Td("flipped faces")
            html.Td("{{ numbers.flips }}", colspan=2, classes="out-flips")
        with html.Tr():
            html.Td("darts (not convex)")
            html.Td("{{ numbers.darts }}", colspan=2, classes="out-darts")
        widgets.marks()
        with html.Tr():
            html.Td("medial lines")
            html.Td("{{ numbers.size_low }} to {{ numbers.size_high }}", colspan=2)
        with html.Tr():
            html.Td("{{ unit }}", colspan=3, classes="ex-small out-unit")
        widgets.covered()
    widgets.compared()
    words = "these numbers belong to \u03b8 = {{ numbers.theta }}\u00b0, "
    words += "\u03b8\u2080 = {{ numbers.theta0 }}\u00b0"
    html.Div(words, v_show="problem", classes="ex-note ex-warning")
    html.H2("Deviations, face by face")
    html.Div(v_html="histogram_svg", classes="ex-plate out-histogram")


def _bar(given):
    with v3.VAppBar(density="compact", elevation=1, height=46):
        v3.VAppBarTitle("Isogonal nets")
        v3.VSpacer()
        with v3.VMenu():
            with v3.Template(v_slot_activator="{ props }"):
                _button("mdi-download", "Save", "in-save", v_bind="props")
            with v3.VList(density="compact"):
                v3.VListSubheader("{{ stem }}. {{ unit }}")
                for suffix in SAVED:
                    _saved(suffix, missing(suffix))
        if not given:
            widgets.undo(_button)
            _button(
                "mdi-link-variant", "Copy link", "in-link", click="utils.get('inet').copyLink(link)"
            )
            _button("mdi-language-python", "Python", "in-python", click="code_open = true")
        _button("mdi-theme-light-dark", "Light or dark", click="dark = !dark")
        _button("mdi-help-circle-outline", "Help", click="help_open = true")


def _button(icon, words, name="", **does):
    about = {"classes": f"text-none {name}", "title": words, **_named(words)}
    with v3.VBtn(size="small", variant="text", **about, **does):
        v3.VIcon(icon, start=True)
        html.Span(words, classes="d-none d-md-inline")


def _saved(suffix, package):
    """One format that the net can be saved in, if the package that it needs is there."""
    words = "picture" if suffix in MIME else "net" + " with its curves" * (suffix in WITH_CURVES)
    mime = MIME.get(suffix, "application/octet-stream")
    about = {"title": f"{suffix[1:].upper()}, {words}", "disabled": bool(package)}
    about["subtitle"] = f"needs the package {package}" if package else None
    v3.VListItem(click=f"utils.get('inet').save('{suffix}', '{mime}')", **about)


def _view(plotter):
    """The net, and one line below: why there is none, how far the search is, or on the net."""
    words = "the net; arrow keys turn it, plus and minus zoom, F fits it"
    keys = {"tabindex": "0", "keydown": "utils.get('inet').keys($event)"}
    small = {"size": "x-small", "variant": "tonal", "color": "primary"}
    with html.Div(classes="ex-middle"):
        stale = ("problem && !searching ? 'ex-view ex-stale' : 'ex-view'",)
        with html.Div(classes=stale, **_named(words, role="application"), **keys):
            about = {"before_scene_loaded": "utils.get('inet')?.sharpen(0)"}
            about["after_scene_loaded"] = "utils.get('inet')?.loaded()"
            view = VtkLocalView(plotter.render_window, ref="view", **about)
            widgets.chip()
            with html.Div(
                classes="ex-why", v_if=("problem && !searching",), **_named("", role="alert")
            ):
                html.Div("{{ problem }}", classes="out-problem")
                widgets.remedies("true")
        welcome.tour()
        with html.Div(classes="ex-foot"):
            with html.Div(classes="ex-status", **_named("", role="status", aria_live="polite")):
                with html.Div(v_if=("searching",)):
                    v3.VProgressCircular(indeterminate=True, size=16, width=2, color="primary")
                    html.Span("{{ progress }}", classes="out-progress mx-2")
                    v3.VBtn("Stop", click="trigger('stop')", classes="text-none in-stop", **small)
                with html.Div(v_if=("!searching && (message || can_search)",)):
                    html.Span("{{ message }}", v_if=("!problem",), classes="out-message mr-2")
                    again = {"v_if": ("can_search",), "classes": "text-none in-run"}
                    v3.VBtn("Run again", click="trigger('run')", **again, **small)
                widgets.remedies("!problem && !searching")
            with html.Div(classes="ex-tools", **_named("view", role="group")):
                for icon, words, call in TOOLS:
                    about = {"title": words, "classes": f"in-{call}", **_named(words)}
                    click = f"trigger('{call}', [utils.get('inet').place()])"
                    v3.VBtn(icon=icon, size="small", variant="text", click=click, **about)
    return view


def _dialogs(given):
    with _dialog("code_open", "The same net in Python"):
        html.Pre("{{ code }}", classes="ex-code")
        html.Div("V: vertices, Q: quads; angles are radians in Python.", classes="ex-note mt-2")
        click = "utils.get('inet').copy(code, 'code')"
        v3.VBtn("Copy", size="small", classes="mt-3", color="primary", click=click)
    welcome.advice(_dialog, given)
    gone = {"model_value": ("!!alert",), "update_modelValue": "alert = $event ? alert : ''"}
    v3.VSnackbar("{{ alert }}", timeout=7000, location="top", classes="out-alert", **gone)


@contextmanager
def _dialog(name, title):
    with v3.VDialog(v_model=(name,), max_width=760), v3.VCard(title=title):
        about = {"icon": "mdi-close", "variant": "text", "size": "small", **_named("close")}
        place = "position: absolute; right: 0.5rem; top: 0.5rem"
        v3.VBtn(style=place, click=f"{name} = false", **about)
        with v3.VCardText():
            yield
