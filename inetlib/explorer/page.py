"""What the page of the explorer holds: controls, view, numbers.  Widgets only, no logic.

Paper: Sec. 3-6 (explorer; beyond the paper).
"""

from contextlib import contextmanager
from importlib.resources import files

from trame.ui.vuetify3 import VAppLayout
from trame.widgets import client, html
from trame.widgets import vuetify3 as v3
from trame.widgets.vtk import VtkLocalView

from . import choices, look
from .session import SAVED, missing

FOLDER = files("inetlib.explorer")
MIME = {".svg": "image/svg+xml", ".png": "image/png"}
COMPACT = {"hide_details": True, "density": "compact", "variant": "outlined"}
FAMILIES = {
    "u": "u-curves",
    "v": "v-curves",
    "d1": "diagonals d\u2081",
    "d2": "diagonals d\u2082",
}
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
LAM = "\u03bb = |d\u2082|/|d\u2081| = {{ numbers.lam }}"
MU = "\u03bc = |m\u2081\u2083|/|m\u2082\u2084| = {{ numbers.mu }}"
STALE = "these numbers belong to \u03b8 = {{ numbers.theta }}\u00b0, "
STALE += "\u03b8\u2080 = {{ numbers.theta0 }}\u00b0"


def build(server, plotter, given=False):
    """The page of a server: its layout is stored there; returns the view of the plotter.

    given: the net came from Python, so that nothing is chosen but what is shown.

    Paper: Sec. 3-6 (explorer).
    """
    theme = ("dark ? 'dark' : 'light'",)
    with VAppLayout(server, theme=theme, style=("palette",)):
        client.Style((FOLDER / "page.css").read_text(encoding="utf-8"))
        _bar(given)
        with v3.VMain(style="height: 100vh; height: 100dvh"), html.Div(classes="ex"):
            with html.Div(classes="ex-side ex-left"):
                if not given:
                    _kind()
                    _angles()
                    _sizes()
                    _own()
                _shown()
            view = _view(plotter)
            with html.Div(classes="ex-side ex-right"):
                _plates()
        _dialogs()
        client.JSEval(ref="address", exec="utils.get('inet').link($event)")
        client.Script((FOLDER / "client.js").read_text(encoding="utf-8"))
    return view


# --- the bar ------------------------------------------------------------------------------


def _bar(given):
    with v3.VAppBar(density="compact", elevation=1, height=46):
        v3.VAppBarTitle("Isogonal nets")
        v3.VSpacer()
        with v3.VMenu():
            with v3.Template(v_slot_activator="{ props }"):
                _button("mdi-download", "Save", v_bind="props", classes="in-save")
            _save_items()
        if not given:
            _button("mdi-link-variant", "Copy link", click="utils.get('inet').copy(link, 'link')")
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
            v3.VListItem(
                title=f"{suffix[1:].upper()}, {words}",
                subtitle=f"needs the package {package}" if package else None,
                disabled=bool(package),
                click=f"utils.get('inet').save('{suffix}', '{mime}')",
            )


# --- controls -----------------------------------------------------------------------------


def _select(name, label, condition=None):
    items = [{"title": words, "value": key} for key, words in choices.OPTIONS[name].items()]
    extra = {"v_show": condition} if condition else {}
    v3.VSelect(
        v_model=(name,),
        items=(f"{name}_items", items),
        label=label,
        classes=f"my-2 in-{name}",
        **COMPACT,
        **extra,
    )


def _number(name, label, low=None, high=None, condition=None, disabled=None):
    """A label, a slider and a field for the same value."""
    bounds = choices.RANGES[name]
    low, high = bounds.low if low is None else low, bounds.high if high is None else high
    off = {"disabled": (disabled,)} if disabled else {}
    with html.Div(classes=f"ex-row in-{name}", **({"v_show": condition} if condition else {})):
        html.Label(label, v_pre=True)
        _slider(f"{name}", label, low, high, bounds.step, v_model=(name,), **off)
        v3.VTextField(
            model_value=(f"Number({name}.toPrecision(10))",),
            change=f"{name} = $event.target.value",
            suffix=bounds.unit or None,
            inputmode="decimal",
            aria_label=f"{label}, value",
            **COMPACT,
            **off,
        )


def _slider(name, label, low, high, step, **options):
    v3.VSlider(
        min=(f"{low}",) if not isinstance(low, str) else (low,),
        max=(f"{high}",) if not isinstance(high, str) else (high,),
        step=step,
        hide_details=True,
        density="compact",
        thumb_size=15,
        track_size=3,
        color="primary",
        aria_label=label,
        **options,
    )


def _kind():
    html.H2("Net")
    _select("kind", "made from")
    _select("map", "map", "kind == 'plane'")
    _select("surface", "surface", "kind == 'isothermal'")
    _select("source", "surface", "kind == 'cover'")


def _angles():
    html.H2("Angles")
    _number("theta", "\u03b8", 1, 179)
    _number("theta0", "\u03b8\u2080", 1, 179)
    v3.VSwitch(
        v_model=("lock",),
        label="lock \u03b8 = \u03b8\u2080 (\u03bb = \u03bc)",
        color="primary",
        classes="in-lock",
        hide_details=True,
        density="compact",
    )


def _sizes():
    html.H2("Size")
    _number("m", "m along u", condition="kind != 'cover'")
    _number("n", "n along v", condition="kind != 'cover'")
    _number("quads", "quads", condition="kind == 'cover'")
    _number("direction", "direction", condition="kind == 'cover'")


def _own():
    """What one kind alone has: bending, the pole, the profile."""
    bent = "kind == 'isothermal' && surface != 'sphere'"
    _number("bend", "bending", high="surface == 'rolled' ? 350 : 90", condition=bent)
    v3.VSwitch(
        v_model=("moebius",),
        v_show="kind == 'isothermal'",
        label="M\u00f6bius image",
        color="primary",
        classes="in-moebius",
        hide_details=True,
        density="compact",
    )
    inverted = "(kind == 'isothermal' && moebius)"
    pole = f"{inverted} || (kind == 'plane' && map == 'moebius')"
    for name, condition in (("px", pole), ("py", pole), ("pz", inverted)):
        _number(name, f"pole {name[1]}", condition=condition)
    with html.Div(v_show="kind == 'revolution'"):
        html.H2("Profile")
        with html.Div(classes="d-flex ga-1 mb-1"):
            for name, radii in choices.PROFILES.items():
                v3.VBtn(
                    name,
                    size="x-small",
                    variant="tonal",
                    classes="text-none px-1 flex-grow-1",
                    click=f"radii = {list(radii)}",
                )
        with html.Div(classes="ex-profile"):
            html.Div(v_html="profile_svg", classes="ex-plate")
            with html.Div():
                for k in reversed(range(len(choices.HEIGHTS))):
                    _radius(k)


def _radius(k):
    """One radius of the profile: a slider and a field, the topmost first."""
    new = f"radii = radii.map((r, i) => i == {k} ? %s : r)"
    bounds = choices.RANGES["radius"]
    label = f"radius at height {choices.HEIGHTS[k]:g}"
    with html.Div(classes=f"ex-row in-radius{k}"):
        _slider(
            "radius",
            label,
            bounds.low,
            1.6,
            bounds.step,
            model_value=(f"radii[{k}]",),
            update_modelValue=new % "$event",
        )
        v3.VTextField(
            model_value=(f"radii[{k}]",),
            change=new % "$event.target.value",
            inputmode="decimal",
            aria_label=f"{label}, value",
            **COMPACT,
        )


def _shown():
    html.H2("Show")
    with html.Div(style="display: grid; grid-template-columns: 1fr 1fr"):
        for name, words in FAMILIES.items():
            v3.VCheckbox(
                v_model=("families",),
                value=name,
                label=words,
                color=(f"colours.{name}",),
                base_color=(f"colours.{name}",),
                hide_details=True,
                density="compact",
                classes=f"in-{name}",
            )
    for name, words in (
        ("parallelograms", "inscribed parallelograms"),
        ("shade", "shade faces by their deviation"),
    ):
        v3.VCheckbox(
            v_model=(name,),
            label=words,
            color="primary",
            hide_details=True,
            density="compact",
            classes=f"in-{name}",
        )
    with html.Div(v_show="shade", classes="ex-scale"):
        for colour, words in look.scale():
            with html.Div():
                html.I(style=f"background: {colour}")
                html.Span(words)


# --- the view -----------------------------------------------------------------------------


def _view(plotter):
    with html.Div(classes="ex-middle"):
        with html.Div(
            classes="ex-view",
            tabindex="0",
            aria_label="the net; arrow keys turn it, plus and minus zoom, F fits it",
            keydown="utils.get('inet').keys($event)",
        ):
            view = VtkLocalView(plotter.render_window, ref="view")
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
            v3.VBtn(
                icon=icon,
                size="x-small",
                title=words,
                aria_label=words,
                classes=f"in-{call}",
                click=f"trigger('{call}', [utils.get('inet').place()])",
            )


def _status():
    """One line below the view: why there is no net, or how far the search is, or on the net."""
    button = {"size": "x-small", "color": "primary", "classes": "text-none ml-2"}
    with html.Div(classes="ex-status", role="status"):
        html.Div(
            "{{ problem }}", v_if=("problem && !searching",), classes="text-warning out-problem"
        )
        with html.Div(v_if=("searching",)):
            v3.VProgressCircular(indeterminate=True, size=16, width=2, color="primary")
            html.Span("{{ progress }}", classes="out-progress ml-2")
            v3.VBtn("Stop", click="trigger('stop')", **_with(button, "in-stop"))
        with html.Div(v_if=("!searching && (message || can_search)",)):
            html.Span("{{ message }}", v_if=("!problem",), classes="out-message")
            v3.VBtn(
                "Run again", v_if=("can_search",), click="trigger('run')", **_with(button, "in-run")
            )


def _with(options, name):
    return options | {"classes": f"{options['classes']} {name}"}


# --- the numbers --------------------------------------------------------------------------


def _plates():
    html.H2("Parallelogram")
    html.Div(v_html="parallelogram_svg", classes="ex-plate")
    html.Div(
        f"{LAM}&emsp; {MU}",
        classes="ex-note text-center out-ratios",
    )
    html.H2("Over all {{ numbers.quads }} faces")
    with html.Table(classes="ex-numbers"):
        with html.Tr():
            for words in ("", "mean", "off at most"):
                html.Th(words)
        for name, words in (("theta", "\u03b8"), ("theta0", "\u03b8\u2080")):
            with html.Tr():
                html.Td(words)
                html.Td(f"{{{{ numbers.mean_{name} }}}}\u00b0", classes=f"out-mean-{name}")
                html.Td(f"{{{{ numbers.{name}_off }}}}\u00b0", classes=f"out-off-{name}")
        with html.Tr():
            html.Td("flipped faces")
            html.Td("{{ numbers.flips }}", colspan=2, classes="out-flips")
        with html.Tr():
            html.Td("medial lines")
            html.Td("{{ numbers.size_low }} to {{ numbers.size_high }}", colspan=2)
    html.Div(
        STALE,
        v_show="problem",
        classes="ex-note text-warning",
    )
    html.H2("Deviations, face by face")
    html.Div(v_html="histogram_svg", classes="ex-plate out-histogram")


def _dialogs():
    with _dialog("code_open", "The same net in Python"):
        html.Pre("{{ code }}", classes="ex-code")
        html.Div("V: vertices, Q: quads; angles are radians in Python.", classes="ex-note mt-2")
        v3.VBtn(
            "Copy",
            size="small",
            classes="mt-3",
            color="primary",
            click="utils.get('inet').copy(code, 'code')",
        )
    with _dialog("help_open", "How to use this page"):
        for title, words in HELP.items():
            html.H4(title, classes="mt-2")
            html.P(words, classes="text-body-2")
    v3.VSnackbar(
        "{{ alert }}",
        model_value=("!!alert",),
        update_modelValue="alert = $event ? alert : ''",
        timeout=7000,
        location="top",
        classes="out-alert",
    )


@contextmanager
def _dialog(name, title):
    with v3.VDialog(v_model=(name,), max_width=760), v3.VCard(title=title):
        v3.VBtn(
            icon="mdi-close",
            variant="text",
            size="small",
            aria_label="close",
            style="position: absolute; right: 0.5rem; top: 0.5rem",
            click=f"{name} = false",
        )
        with v3.VCardText():
            yield
