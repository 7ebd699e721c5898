"""What counts as the same: texts, numbers, arrays, drawings and pictures, within tolerances.

The last digits of computed numbers differ from one processor to the next."""

import base64
import io
import re
from decimal import Decimal

import numpy as np
import PIL.Image

POINT = 0.0101  # of an SVG, whose numbers have two decimals: one unit of the last of them
LEVELS = 5  # of the 255 of a colour, that a pixel may differ by
MEAN = 1e-4  # of the range of colours, that all pixels may differ by on average
FEW = 24, 5e-4, 5e-4  # the same of `few_tones`, and the part of all pixels that may differ more
LARGE = 600_000  # bytes of a file
TONES = 255, 96, 48  # of a picture, the first with which its file is not large
DATA = 1e-6  # of the size of a figure, that its data may differ by
WHOLE = -6  # the exponent of the last digit of claims that come out as whole numbers

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
COORDINATE = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
COLOUR = re.compile(r"#[0-9a-f]{6}\b")
HASHED = re.compile(r'\bid="([A-Za-z_]*)(?:\d+_)*[0-9a-f]{10}(?:_\d+)*"')
STEP = re.compile(r"\s*\b([MLQCz]) ?\n?(?=[-\d\"MLQCz])")
INSIDE = re.compile(r'(?<="data:image/png;base64,)[^"]*')
ROUNDED = re.compile(r'(\b(?:d|x|y|width|height|points)="|translate\()([^")]*)')


def text(one: str, two: str) -> bool:
    """Whether two texts are equal, decimals within one unit of their last digits.

    0.25 and 0.26 are the same, 0.25 and 0.27 are not, nor are 7 and 8: whole numbers are words."""
    numbers = NUMBER.findall(one), NUMBER.findall(two)
    return NUMBER.split(one) == NUMBER.split(two) and all(map(_near, *numbers))


def _near(a, b):
    whole = not all(re.search(r"[.eE]", x) for x in (a, b))
    if a == b or whole:
        return a == b
    a, b = Decimal(a), Decimal(b)
    return abs(a - b) <= Decimal(10) ** max(x.as_tuple().exponent for x in (a, b))


def claims(one, two) -> bool:
    """Whether claims (numbers, words, lists, dicts) are the same, decimals to their last digit."""
    if isinstance(one, dict) and isinstance(two, dict):
        return one.keys() == two.keys() and all(claims(one[k], two[k]) for k in one)
    if isinstance(one, (list, tuple)) and isinstance(two, (list, tuple)):
        return len(one) == len(two) and all(map(claims, one, two))
    if isinstance(one, float) and isinstance(two, float):
        exponents = (Decimal(repr(x)).as_tuple().exponent for x in (one, two) if x % 1)
        unit = Decimal(10) ** min(exponents, default=WHOLE)
        return abs(Decimal(repr(one)) - Decimal(repr(two))) <= unit
    return type(one) is type(two) and one == two


def data(one: dict, two: dict) -> list:
    """The names of the arrays that differ, or are in one of two dicts of real arrays only."""
    most = DATA * max((float(np.ptp(x)) for x in one.values() if np.size(x)), default=0.0)
    differ = sorted(one.keys() ^ two.keys())
    for name in sorted(one.keys() & two.keys()):
        a, b = one[name], two[name]
        if np.shape(a) != np.shape(b) or not np.allclose(a, b, rtol=0, atol=most, equal_nan=True):
            differ.append(name)
    return differ


def plain_svg(svg: str, part: float = 0.3) -> str:
    """An SVG by matplotlib with two decimals and with numbers for the hashes in its names.

    Pictures inside are `few_tones`, together this part of a large file."""
    most = part * LARGE / max(1, len(INSIDE.findall(svg)))
    svg = INSIDE.sub(lambda found: _inside(few_tones(base64.b64decode(found[0]), most)), svg)
    names = {}
    for match in HASHED.finditer(svg):
        names.setdefault(match[0][len('id="') : -1], f"{match[1]}-{len(names) + 1}")
    svg = re.sub(r'(?<=["#])[\w-]+(?=[")])', lambda match: names.get(match[0], match[0]), svg)
    svg = ROUNDED.sub(lambda match: match[1] + COORDINATE.sub(_short, match[2]), svg)
    return STEP.sub(r"\1", svg)


def _inside(png):
    return base64.b64encode(png).decode()


def few_tones(picture, most: int = LARGE, tones: tuple = TONES) -> bytes:
    """A picture on white paper with few colours, the bytes of a PNG.

    picture: those of a PNG, or an array as of PIL; tones: numbers of colours, the first is taken
    with which the file has `most` bytes, or else the last."""
    array = isinstance(picture, np.ndarray)
    image = PIL.Image.fromarray(picture) if array else PIL.Image.open(io.BytesIO(picture))
    image = image.convert("RGBA")
    paper = PIL.Image.new("RGBA", image.size, "white")
    image = PIL.Image.alpha_composite(paper, image).convert("RGB")
    for count in tones:
        out, method = io.BytesIO(), PIL.Image.Quantize.MEDIANCUT
        few = image.quantize(count, method, dither=PIL.Image.Dither.NONE)
        few.save(out, "png", optimize=True)
        if out.tell() <= most:
            break
    return out.getvalue()


def _short(match):
    digits = f"{float(match[0]):.2f}".rstrip("0").rstrip(".")
    return "0" if digits == "-0" else digits


def svg(one: str, two: str) -> bool:
    """Whether two texts of `plain_svg` show the same: coordinates and colours within tolerance."""
    if one == two:
        return True
    pictures = zip(*(map(base64.b64decode, INSIDE.findall(s)) for s in (one, two)), strict=False)
    if not all(picture(a, b, *FEW) for a, b in pictures):
        return False
    one, two = (INSIDE.sub("", s) for s in (one, two))
    colours = [[list(bytes.fromhex(x[1:])) for x in COLOUR.findall(s)] for s in (one, two)]
    plain = [COLOUR.sub("#", s) for s in (one, two)]
    if COORDINATE.split(plain[0]) != COORDINATE.split(plain[1]):
        return False
    numbers = [np.array(COORDINATE.findall(s), float) for s in plain]
    return _within(colours, LEVELS) and _within(numbers, POINT)


def _within(pair, most):
    return bool(np.abs(np.subtract(*pair)).max(initial=0) <= most)


def picture(
    one: bytes, two: bytes, levels: float = LEVELS, mean: float = MEAN, part: float = 0.0
) -> bool:
    """Whether two PNG files look the same.

    levels: of 255, for a pixel, but for a `part` of all; mean: of 1, for all."""
    if one == two:
        return True
    a, b = (np.asarray(PIL.Image.open(io.BytesIO(x)).convert("RGBA"), float) for x in (one, two))
    if a.shape != b.shape:
        return False
    off = np.abs(a - b)
    return bool(np.mean(off.max(axis=2) > levels) <= part and off.mean() <= 255 * mean)
