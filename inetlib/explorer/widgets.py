"""Widgets for what one does with the net that is shown (`play.Play`)."""

from collections.abc import Callable

from trame.widgets import html

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
                html.Td(
                    f"{{{{ face.{name} || numbers.{name} }}}}\u00b0", classes=f"out-face-{name}"
                )
                off = f"face.name ? 'off by ' + face.{name}_off + '\u00b0' : 'asked for'"
                html.Td(f"{{{{ {off} }}}}", classes=f"out-face-off-{name}")


def chip() -> None:
    """The same in the view, for small screens and for those who listen."""
    words = "{{ face.name }}: " + ", ".join(f"{w} {{{{ face.{n} }}}}\u00b0" for n, w in ANGLES)
    with html.Div(classes="ex-chip", raw_attrs=['aria-live="polite"']):
        html.Span(words, v_if=("face.name",))
