"""A figure with sliders in JupyterLab; still where a tool runs the notebook."""

import io
from collections.abc import Callable
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from .drawings import same
from .explorer.notebook import person


def slide(draw: Callable, live: bool | None = None, **ranges: tuple) -> Any:
    """The figure that `draw` returns, with a slider for each of its named parameters.

    ranges: (lowest, highest, first value), whole numbers for a whole parameter; those of
    parameters that begin with "theta" are degrees, and `draw` gets radians.  live: by default
    where there is a person; else an IPython Image of the first values.  What `draw` refuses with
    a ValueError is said below the picture.

    >>> from inetlib.drawings import ideas
    >>> slide(ideas.star, live=False, theta=(20, 160, 70)).format
    'png'"""
    values = {name: first for name, (_, _, first) in ranges.items()}
    if not (person() if live is None else live):
        from IPython.display import Image

        return Image(data=_drawn(draw, values), format="png")
    import ipywidgets

    bars = {}
    for name, (low, high, first) in ranges.items():
        whole = all(isinstance(x, int) for x in (low, high, first))
        kind = ipywidgets.IntSlider if whole else ipywidgets.FloatSlider
        step = 1 if whole else (high - low) / 100
        bars[name] = kind(first, min=low, max=high, step=step, description=name)
    picture, words = ipywidgets.Image(value=_drawn(draw, values)), ipywidgets.Label()

    def moved(_):
        try:
            picture.value = _drawn(draw, {name: bar.value for name, bar in bars.items()})
            words.value = ""
        except ValueError as error:
            words.value = str(error)

    for bar in bars.values():
        bar.observe(moved, "value")
    return ipywidgets.VBox([*bars.values(), picture, words])


def _drawn(draw, values):
    """The figure of these values as the bytes of a small PNG."""
    angles = {name: np.radians(x) for name, x in values.items() if name.startswith("theta")}
    figure, out = draw(**values | angles), io.BytesIO()
    figure.savefig(out, format="png", dpi=figure.dpi)
    plt.close(figure)
    return same.few_tones(out.getvalue())
