"""Widgets for what one does with the net that is shown (`play.Play`)."""

from collections.abc import Callable

from trame.widgets import html
from trame.widgets import vuetify3 as v3

ANGLES = (("theta", "\u03b8"), ("theta0", "\u03b8\u2080"))


def undo(button: Callable) -> None:
    """Two buttons of the bar; button(icon, words, name, ...) makes one."""
    for icon, words, call in (
        ("mdi-undo", "Undo", "undo"),
        ("mdi-redo", "Redo", "redo"),
    ):
        off = {"disabled": (f"!can_{call}",)}
        button(icon, words, f"in-{call}", click=f"trigger('{call}')", **off)


def face() -> None:
    """The angles of the face that is touched, or those asked for, below the parallelogram."""
    with html.Table(classes="ex-numbers"):
        for name, words in ANGLES:
            with html.Tr():
                html.Td(words)
                asked = f"Number(Number({name}).toPrecision(10))"
                html.Td(f"{{{{ face.{name} || {asked} }}}}\u00b0", classes=f"out-face-{name}")
                off = f"face.name ? 'off by ' + face.{name}_off + '\u00b0' : 'asked for'"
                html.Td(f"{{{{ {off} }}}}", classes=f"out-face-off-{name}")


def chip() -> None:
    """The same in the view, for small screens and for those who listen."""
    words = "{{ face.name }}: " + ", ".join(f"{w} {{{{ face.{n} }}}}\u00b0" for n, w in ANGLES)
    with html.Div(classes="ex-chip", raw_attrs=['aria-live="polite"']):
        html.Span(words, v_if=("face.name",))


def covered() -> None:
    """Rows of a table: how well the net covers its surface."""
    with html.Tr(v_show="numbers.covered"):
        html.Td("surface covered")
        html.Td("{{ numbers.covered }} %", colspan=2, classes="out-covered")
    with html.Tr(v_show="numbers.covered"):
        html.Td("off the surface*")
        for name in ("distance_mean", "distance"):
            html.Td(f"{{{{ numbers.{name} }}}} %", classes=f"out-{name}")
    with html.Tr(v_show="numbers.covered"):
        html.Td("* in % of the diagonal of its bounding box", colspan=3, classes="ex-small")


def beside(given: bool) -> None:
    """What is shown with the net: the surface that it covers, a net that is kept."""
    if not given:
        about = {"hide_details": True, "density": "compact", "color": "primary"}
        words = {"label": "surface under the net", "v_show": "kind == 'cover'"}
        v3.VCheckbox(v_model=("target",), classes="in-target", **words, **about)
        small = {"size": "x-small", "variant": "tonal"}
        with html.Div(classes="d-flex ga-1 my-2"):
            words = "{{ ghost.quads ? 'Keep this one instead' : 'Keep as a ghost' }}"
            v3.VBtn(words, classes="text-none in-keep", click="trigger('keep')", **small)
            gone = {"v_if": ("ghost.quads",), "click": "trigger('forget')"}
            v3.VBtn("Remove the ghost", classes="text-none in-forget", **gone, **small)


def compared() -> None:
    """The numbers of the net beside those of the ghost."""
    with html.Table(classes="ex-numbers mt-2 out-ghost", v_if=("ghost.quads",)):
        with html.Tr():
            for words in ("", "this net", "ghost (grey)"):
                html.Th(words)
        for words, name, unit in (
            ("\u03b8 asked for", "theta", "\u00b0"),
            ("\u03b8\u2080 asked for", "theta0", "\u00b0"),
            ("\u03b8 off at most", "theta_off", "\u00b0"),
            ("\u03b8\u2080 off at most", "theta0_off", "\u00b0"),
            ("faces", "quads", ""),
        ):
            with html.Tr():
                html.Td(words)
                for which in ("numbers", "ghost"):
                    html.Td(f"{{{{ {which}.{name} }}}}{unit}", classes=f"out-{which}-{name}")


def remedies(condition: str) -> None:
    """Buttons for changes that make a net."""
    with html.Div(classes="ex-remedies", v_if=(f"{condition} && remedies.length",)):
        html.Span("{{ problem ? 'There is a net with' : 'Better with' }}")
        about = {"size": "x-small", "variant": "tonal", "color": "primary", "key": "k"}
        with v3.VBtn(
            v_for="(way, k) in remedies",
            click="trigger('change', [way.values])",
            classes="text-none in-remedy",
            **about,
        ):
            html.Span("{{ way.words }}")


def marks() -> None:
    """A row of a table: a button that shows where flipped faces and darts are."""
    bad = "numbers.flips && (numbers.flips != '0' || numbers.darts != '0')"
    with html.Tr(v_show=bad):
        html.Td("{{ marks.length ? 'marked: ' + marks.length : '' }}", classes="out-marks")
        with html.Td(colspan=2):
            about = {"size": "x-small", "variant": "tonal", "classes": "text-none in-marks"}
            v3.VBtn(
                "{{ marking ? 'Hide them' : 'Show them' }}", click="marking = !marking", **about
            )
