"""What a newcomer meets on the explorer's page: the tour, nets to begin with, the help."""

from collections.abc import Callable
from importlib.resources import files
from typing import Any, NamedTuple

from trame.widgets import client, html
from trame.widgets import vuetify3 as v3

PICTURES = files("inetlib.explorer") / "presets"  # made by tools/presets.py


class Step(NamedTuple):
    """A step of the tour: what it says, the part of the page that it is about (CSS), and a button
    that shows it: its name and what it does."""

    title: str
    words: str
    target: str
    button: tuple[str, str] | None = None


TOUR = (
    Step(
        "One parallelogram everywhere",
        "A net is made of faces with four sides. Join the midpoints of the sides of a face: you "
        "get a parallelogram. In this net it has the same shape in every face, turned and scaled. "
        "The panel shows this shape, and the blue patches in the net are its copies. Point at a "
        "face, or tap it, to see its own.",
        ".out-parallelogram",
    ),
    Step(
        "Two angles choose the shape",
        "\u03b8 is the angle between two sides of the parallelogram, \u03b8\u2080 that between its "
        "diagonals. Turn \u03b8 by the slider or the button: the net is made anew, and every face "
        "follows.",
        ".ex-angles",
        ("Turn \u03b8", "theta = theta < 80 ? 90 : 60"),
    ),
    Step(
        "Four families of curves",
        "The sides of the faces make two families of curves, u and v; the diagonals of the faces "
        "make two more, d\u2081 and d\u2082. The sides of the parallelogram are parallel to the "
        "diagonals of its face: these cross at \u03b8. Its own diagonals join the midpoints of "
        "opposite sides of the face, and cross at \u03b8\u2080.",
        ".ex-families",
        ("Show all four", "families = ['u', 'v', 'd1', 'd2']"),
    ),
    Step(
        "Exact or optimised",
        "Some nets follow from a formula: their angles are exact, or nearly so, and nearer with "
        "smaller faces. On any other surface, also on your own, the net is searched for step by "
        "step. The line below the net says which it is.",
        ".ex-foot, .in-kind",
        ("Search for one", "kind = 'freeform'"),
    ),
    Step(
        "Keep what you find",
        "In the bar: Save writes a drawing, or a mesh for other programs. Copy link keeps the "
        "choice and the view, and Python shows three lines that make the same net. Presets has "
        "more nets to begin with; Help has this tour.",
        ".in-save, .in-link, .in-python, .in-presets",
    ),
)


class Preset(NamedTuple):
    """A net to begin with: its title, what it is, and the link that opens it."""

    title: str
    words: str
    link: str


PRESETS = {
    "square": Preset(
        "z\u00b2", "a plane net, exact, as in Fig. 3", "kind=plane&map=square&m=14&n=20"
    ),
    "fan": Preset("Fan", "exp z: spirals in the plane, exact", "kind=plane&map=exp&theta=75"),
    "sheet": Preset(
        "Rolled sheet",
        "a plane net that keeps its angles when it is rolled up, as in Fig. 7",
        "kind=isothermal&surface=rolled&theta=75&m=24&n=30&bend=300",
    ),
    "catenoid": Preset(
        "Catenoid", "a minimal surface, as in Figs. 5 and 8", "kind=isothermal&theta=75&theta0=90"
    ),
    "helicoid": Preset(
        "Helicoid",
        "the catenoid, bent to a spiral staircase, as in Fig. 9",
        "kind=isothermal&bend=90&theta=75",
    ),
    "moebius": Preset(
        "M\u00f6bius image",
        "a minimal surface, inverted in a sphere, as in Fig. 9",
        "kind=isothermal&bend=30&moebius=1",
    ),
    "sphere": Preset(
        "Sphere", "spirals towards a pole, as in Fig. 10", "kind=isothermal&surface=sphere&theta=75"
    ),
    "vase": Preset(
        "Vase", "loxodromes and parallels, exact, as in Fig. 11", "kind=revolution&theta=75"
    ),
    "hourglass": Preset(
        "Hourglass",
        "four families of curves on a surface of revolution",
        "kind=revolution&radii=hourglass&m=24&theta=80&theta0=70&families=u,v,d1,d2",
    ),
    "patch": Preset("Patch", "found by optimisation, as in Fig. 12", "kind=freeform&theta0=45"),
    "saddle": Preset(
        "Saddle", "a net that closes around a hole", "kind=cover&source=saddle&theta=75&theta0=55"
    ),
    "dome": Preset(
        "Dome",
        "panels up to the edges of five openings",
        "kind=cover&source=five_skylights&quads=500",
    ),
}
POLE = "the point that goes to infinity"
TIPS = {  # on the numbers of the page
    "theta": "angle between the diagonals of every face",
    "theta0": "angle between the lines that join midpoints of opposite sides",
    "m": "number of faces along a u-curve",
    "n": "number of faces along a v-curve",
    "quads": "about how many faces the surface gets",
    "direction": "turns the net on the surface",
    "bend": "bends the catenoid to the helicoid, or rolls the sheet",
    **dict.fromkeys(("px", "py", "pz"), POLE),
}
HELP = {
    "Two angles": "Every quad has the same angle \u03b8 between its diagonals and the same angle "
    "\u03b8\u2080 between the lines that join midpoints of opposite sides. Two ratios say the "
    "same: \u03bb of the diagonals, \u03bc of these medial lines.",
    "Mouse and touch": "Drag to turn, drag with two fingers or the middle button to move, wheel "
    "or pinch to zoom.",
    "Keyboard": "Tab reaches every control. On a slider the arrow keys change the value; on the "
    "view they turn it, + and - zoom, F fits the net.",
    "One face": "Point at a face, tap it, or press Enter and then N or P on the view: the panel "
    "shows the face, its parallelogram and its two angles. A click keeps it, Esc lets it go.",
    "Undo": "Ctrl+Z takes the last change back, Ctrl+Shift+Z or Ctrl+Y makes it again.",
    "Numbers": "Type any value that a slider has no step for, and press Enter; 60,5 and 60.5\u00b0 "
    "will do. Deviations are the largest over all faces, from the angles asked for. Lengths have "
    "no unit, or that of the file.",
    "Your own surface": "Start the explorer with a file, inet explore surface.obj: it is then the "
    "surface that is covered.",
}


def tour() -> None:
    """The tour, below the net: one step at a time, with the part of the page that it is about."""
    lit = [f"[data-tour='{k}'] :is({step.target})" for k, step in enumerate(TOUR, 1)]
    ring = "outline: 3px solid #4a86d8; border-radius: 4px;"
    client.Style(f"{', '.join(lit)} {{ {ring} }}")
    # A field has a ring of its own, with a gap for its label.
    client.Style(f"{', '.join(f'{one}.v-select' for one in lit)} {{ outline: none; }}")
    ring = "--v-field-border-width: 3px; --v-field-border-opacity: 1; color: #4a86d8;"
    fields = ", ".join(f"{one}.v-select .v-field__outline" for one in lit)
    client.Style(f"{fields} {{ {ring} }}")
    about = {"raw_attrs": ['role="region"', 'aria-label="tour"', 'tabindex="-1"']}
    with html.Div(v_if=("tour", 0), classes="ex-tour", **about):
        for k, step in enumerate(TOUR, 1):
            said = ['aria-live="polite"', f'data-target="{step.target}"']
            with html.Div(v_if=(f"tour == {k}",), raw_attrs=said):
                html.H2(step.title)
                html.P(step.words)
        with html.Div(classes="ex-steps"):
            html.Span(f"{{{{ tour }}}} of {len(TOUR)}", classes="mr-auto")
            for k, step in enumerate(TOUR, 1):
                if step.button:
                    words, does = step.button
                    _step(words, does, variant="tonal", v_if=(f"tour == {k}",))
            go = "utils.get('inet').tour({})".format
            _step("Skip", go(0), "in-skip", v_if=(f"tour < {len(TOUR)}",))
            _step("Back", go("tour - 1"), "in-back", v_if=("tour > 1",))
            last = f"tour == {len(TOUR)}"
            words, primary = f"{{{{ {last} ? 'Done' : 'Next' }}}}", {"color": "primary"}
            _step(words, go(f"{last} ? 0 : tour + 1"), "in-next", variant="flat", **primary)


def _step(words, does, name="", variant="text", **about):
    about |= {"classes": f"text-none {name}", "size": "small", "variant": variant}
    v3.VBtn(words, click=does, **about)


def presets(server: Any, dialog: Callable) -> None:
    """The dialog with the nets to begin with; dialog(name, title): of the page."""
    server.enable_module({"serve": {"presets": str(PICTURES)}})
    with dialog("presets_open", "Nets to begin with"), html.Div(classes="ex-cards"):
        for name, preset in PRESETS.items():
            does = f"presets_open = false; trigger('preset', ['{name}'])"
            with html.Button(classes=f"ex-card in-preset-{name}", click=does, type="button"):
                about = {"loading": "lazy", "width": 288, "height": 216, "raw_attrs": ['alt=""']}
                html.Img(src=f"presets/{name}.png", **about)
                html.Strong(preset.title)
                html.Span(preset.words)


def advice(dialog: Callable, given: bool) -> None:
    """The dialog that says how the page is used; dialog(name, title): of the page; given: whether
    it shows a net from elsewhere, of which there is no tour."""
    with dialog("help_open", "How to use this page"):
        does = "help_open = false; utils.get('inet').tour(1)"
        if not given:
            _step("Show the tour", does, "in-tour", variant="tonal")
        for title, words in HELP.items():
            html.H3(title, classes="mt-2 text-subtitle-2")
            html.P(words, classes="text-body-2")
