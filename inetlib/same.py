"""What counts as the same: texts, numbers, arrays, drawings and pictures, within tolerances.

The last digits of computed numbers differ from one processor to the next.  What is stored,
figures and the outputs of notebooks, is therefore replaced only when something new differs
from it by more than that.

Paper: Figs. 1-13 (files).
"""

import io
import re
from decimal import Decimal

import numpy as np
import PIL.Image

POINT = 0.0101  # of an SVG, whose numbers have two decimals: one unit of the last of them
LEVELS = 5  # of the 255 of a colour, that a pixel may differ by
MEAN = 1e-4  # of the range of colours, that all pixels may differ by on average
DATA = 1e-6  # of the size of a figure, that its data may differ by
WHOLE = -6  # the exponent of the last digit of claims that come out as whole numbers

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
COORDINATE = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
COLOUR = re.compile(r"#[0-9a-f]{6}\b")
HASHED = re.compile(r'\bid="([A-Za-z_]*)(?:\d+_)*[0-9a-f]{10}(?:_\d+)*"')
ROUNDED = re.compile(r'(\b(?:d|x|y|width|height|points)="|translate\()([^")]*)')


def text(one, two):
    """Whether two texts are equal, decimals within one unit of their last digits.

    What a text shows is what it promises: 0.25 and 0.26 are the same, 0.25 and 0.27 are not,
    and nor are 7 and 8: whole numbers count as words.
    """
    if one == two:
        return True
    (words, numbers), (others, found) = (_parts(t, NUMBER) for t in (one, two))
    pairs = zip(numbers, found, strict=False)
    return words == others and all(a == b or _near(a, b) for a, b in pairs)


def _parts(text, pattern):
    """The text between the matches of a pattern, and the matches."""
    return pattern.split(text), pattern.findall(text)


def _near(a, b):
    if not all(re.search(r"[.eE]", x) for x in (a, b)):
        return False
    a, b = Decimal(a), Decimal(b)
    return abs(a - b) <= Decimal(10) ** max(x.as_tuple().exponent for x in (a, b))


def claims(one, two):
    """Whether two claims of a figure, numbers, words, lists or dicts of them, are the same.

    Decimals are so within one unit of the last digit that either of them states.
    """
    if isinstance(one, dict) and isinstance(two, dict):
        return one.keys() == two.keys() and all(claims(one[k], two[k]) for k in one)
    if isinstance(one, (list, tuple)) and isinstance(two, (list, tuple)):
        return len(one) == len(two) and all(map(claims, one, two))
    if isinstance(one, float) and isinstance(two, float):
        exponents = (Decimal(repr(x)).as_tuple().exponent for x in (one, two) if x % 1)
        unit = Decimal(10) ** min(exponents, default=WHOLE)
        return abs(Decimal(repr(one)) - Decimal(repr(two))) <= unit
    return type(one) is type(two) and one == two


def data(one, two):
    """The names of the arrays that differ, or are in one of two dicts of real arrays only."""
    size = max((float(np.ptp(x)) for x in one.values() if np.size(x)), default=0.0)
    differ = sorted(one.keys() ^ two.keys())
    for name in sorted(one.keys() & two.keys()):
        a, b = np.asarray(one[name]), np.asarray(two[name])
        if a.shape != b.shape or not np.allclose(a, b, rtol=0, atol=DATA * size, equal_nan=True):
            differ.append(name)
    return differ


def plain_svg(svg):
    """The text of an SVG by matplotlib with names in order of appearance and two decimals.

    matplotlib names clips and markers by a hash of numbers with all their digits.
    """
    names = {}
    for match in HASHED.finditer(svg):
        full = match[0][len('id="') : -1]
        names.setdefault(full, f"{match[1]}-{len(names) + 1}")
    pattern = "|".join(sorted(map(re.escape, names), key=len, reverse=True))
    if names:
        svg = re.sub(rf'(?<=["#])(?:{pattern})(?=[")])', lambda match: names[match[0]], svg)
    return ROUNDED.sub(lambda match: match[1] + COORDINATE.sub(_short, match[2]), svg)


def _short(match):
    digits = f"{float(match[0]):.2f}".rstrip("0").rstrip(".")
    return "0" if digits == "-0" else digits


def svg(one, two):
    """Whether two texts of `plain_svg` show the same: coordinates and colours within tolerance."""
    if one == two:
        return True
    (words, colours), (others, found) = (_parts(t, COLOUR) for t in (one, two))
    if len(words) != len(others):
        return False
    levels = (np.array([list(bytes.fromhex(c[1:])) for c in x]) for x in (colours, found))
    if colours != found and np.abs(np.subtract(*levels)).max() > LEVELS:
        return False
    (words, numbers), (others, found) = (_parts("#".join(t), COORDINATE) for t in (words, others))
    if words != others:
        return False
    return bool(np.abs(np.array(numbers, float) - np.array(found, float)).max() <= POINT)


def picture(one, two, levels=LEVELS, mean=MEAN):
    """Whether two PNG files, as bytes, look the same.

    levels: by which one pixel may differ, of 255; mean: of all pixels, as a part of 1.
    """
    if one == two:
        return True
    one, two = (
        np.asarray(PIL.Image.open(io.BytesIO(x)).convert("RGBA"), float) for x in (one, two)
    )
    if one.shape != two.shape:
        return False
    apart = np.abs(one - two)
    return bool(apart.max() <= levels and apart.mean() <= 255 * mean)
