"""The two sides of the explorer's page: what is chosen, and what is said of the net."""

from trame.widgets import html
from trame.widgets import vuetify3 as v3

from . import choices, look

SMALL = {"hide_details": True, "density": "compact"}
FIELD = SMALL | {"variant": "outlined"}
SWITCH = SMALL | {"color": "primary"}
SLIDER = SWITCH | {"thumb_size": 15, "track_size": 3}
FAMILIES = {"u": "u-curves", "v": "v-curves"}
FAMILIES |= {"d1": "diagonals d\u2081", "d2": "diagonals d\u2082"}
LOOKS = {
    "parallelograms": "inscribed parallelograms",
    "shade": "shade faces by their deviation",
}
LAM = "\u03bb = |d\u2082|/|d\u2081| = {{ numbers.lam }}"
MU = "\u03bc = |m\u2081\u2083|/|m\u2082\u2084| = {{ numbers.mu }}"
STALE = "these numbers belong to \u03b8 = {{ numbers.theta }}\u00b0, "
STALE += "\u03b8\u2080 = {{ numbers.theta0 }}\u00b0"


def controls(given=False):
    """What is chosen; of a given net only what is shown."""
    if not given:
        _kind()
        _angles()
        _sizes()
        _bent()
        _profile()
    _shown()


def _select(name, label, condition="true"):
    items = [{"title": words, "value": key} for key, words in choices.OPTIONS[name].items()]
    about = {"label": label, "v_show": condition, "classes": f"my-2 in-{name}"}
    v3.VSelect(v_model=(name,), items=(f"{name}_items", items), **about, **FIELD)


def _number(name, label, low=None, high=None, condition="true"):
    """A label, a slider and a field for the same value."""
    bounds = choices.ALLOWED[name]
    ends = {"min": (f"{bounds.low if low is None else low}",)}
    ends |= {"max": (f"{bounds.high if high is None else high}",), "step": bounds.step}
    field = {"model_value": (f"Number(Number({name}).toPrecision(10))",)}
    field |= {"change": f"{name} = $event.target.value", "suffix": bounds.unit or None}
    with html.Div(classes=f"ex-row in-{name}", v_show=condition):
        html.Label(label, v_pre=True)
        v3.VSlider(v_model=(name,), aria_label=label, **ends, **SLIDER)
        v3.VTextField(inputmode="decimal", aria_label=f"{label}, value", **field, **FIELD)


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
    words = "lock \u03b8 = \u03b8\u2080 (\u03bb = \u03bc)"
    v3.VSwitch(v_model=("lock",), label=words, classes="in-lock", **SWITCH)


def _sizes():
    html.H2("Size")
    _number("m", "m along u", condition="kind != 'cover'")
    _number("n", "n along v", condition="kind != 'cover'")
    _number("quads", "quads", condition="kind == 'cover'")
    _number("direction", "direction", condition="kind == 'cover'")


def _bent():
    """The angle of bending, and the pole of a Moebius transformation."""
    bent = "kind == 'isothermal' && surface != 'sphere'"
    _number("bend", "bending", high="surface == 'rolled' ? 350 : 90", condition=bent)
    about = {"label": "M\u00f6bius image", "v_show": "kind == 'isothermal'"}
    v3.VSwitch(v_model=("moebius",), classes="in-moebius", **about, **SWITCH)
    inverted = "(kind == 'isothermal' && moebius)"
    pole = f"{inverted} || (kind == 'plane' && map == 'moebius')"
    for name, condition in (("px", pole), ("py", pole), ("pz", inverted)):
        _number(name, f"pole {name[1]}", condition=condition)


def _profile():
    with html.Div(v_show="kind == 'revolution'"):
        html.H2("Profile")
        with html.Div(classes="d-flex ga-1 mb-1"):
            for name, radii in choices.PROFILES.items():
                about = {"classes": "text-none px-1 flex-grow-1", "click": f"radii = {list(radii)}"}
                v3.VBtn(name, size="x-small", variant="tonal", **about)
        with html.Div(classes="ex-profile"):
            html.Div(v_html="profile_svg", classes="ex-plate")
            with html.Div():
                for k in reversed(range(len(choices.HEIGHTS))):
                    _radius(k)


def _radius(k):
    """One radius of the profile: a slider and a field, the topmost first."""
    new = f"radii = radii.map((r, i) => i == {k} ? %s : r)"
    low, _, step = choices.RADIUS[:3]
    label = f"radius at height {choices.HEIGHTS[k]:g}"
    ends = {"min": (f"{low}",), "max": ("1.6",), "step": step, "aria_label": label}
    field = {"inputmode": "decimal", "aria_label": f"{label}, value"}
    value = (f"radii[{k}]",)
    with html.Div(classes=f"ex-row in-radius{k}"):
        v3.VSlider(model_value=value, update_modelValue=new % "$event", **ends, **SLIDER)
        v3.VTextField(model_value=value, change=new % "$event.target.value", **field, **FIELD)


def _shown():
    html.H2("Show")
    with html.Div(style="display: grid; grid-template-columns: 1fr 1fr"):
        for name, words in FAMILIES.items():
            colour = {"color": (f"colours.{name}",), "base_color": (f"colours.{name}",)}
            about = {"value": name, "label": words, "classes": f"in-{name}"}
            v3.VCheckbox(v_model=("families",), **about, **colour, **SMALL)
    for name, words in LOOKS.items():
        v3.VCheckbox(v_model=(name,), label=words, classes=f"in-{name}", **SWITCH)
    with html.Div(v_show="shade", classes="ex-scale"):
        for colour, words in look.scale():
            with html.Div():
                html.I(style=f"background: {colour}")
                html.Span(words)


def numbers():
    """The parallelogram, and what there is to say of the net."""
    html.H2("Parallelogram")
    html.Div(v_html="parallelogram_svg", classes="ex-plate")
    with html.Div(classes="ex-note ex-ratios out-ratios"):
        html.Span(LAM)
        html.Span(MU)
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
    html.Div(STALE, v_show="problem", classes="ex-note text-warning")
    html.H2("Deviations, face by face")
    html.Div(v_html="histogram_svg", classes="ex-plate out-histogram")
