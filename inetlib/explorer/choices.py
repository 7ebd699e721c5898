"""What the explorer can be asked for: checked values, angles in degrees; the same as a link."""

from dataclasses import dataclass, field, fields, replace
from typing import NamedTuple
from urllib.parse import parse_qsl, urlencode

import numpy as np

from .. import surfaces

FAMILIES = "u", "v", "d1", "d2"
OPTIONS = {
    "kind": {
        "plane": "Planar conformal map",
        "isothermal": "Isothermal surface",
        "revolution": "Surface of revolution",
        "freeform": "Freeform patch",
        "cover": "Surface of triangles",
    },
    "map": {
        "square": "z\u00b2",
        "inverse": "1/z",
        "exp": "exp z",
        "moebius": "M\u00f6bius, 1/(z - p)",
        "identity": "z (the grid itself)",
    },
    "surface": {
        "minimal": "Catenoid bent to helicoid",
        "sphere": "Sphere",
        "rolled": "Rolled sheet",
    },
    "source": {
        "roof": "Roof (example)",
        "saddle": "Saddle with a hole (example)",
        "shell": "Hanging shell (example)",
        "skylight": "Roof with a hole (example)",
        "two_skylights": "Vault with two openings (example)",
        "five_skylights": "Dome with five openings (example)",
        "file": "The file of the command line",
    },
    "openings": {  # of a surface with one hole; more are openings by themselves
        "ring": "Ring, closed around it",
        "fill": "Opening, curves go across",
    },
    "shade": {
        "none": "nothing",
        "deviation": "deviation of the angles",
        "size": "size",
        "planarity": "planarity",
    },
}
HEIGHTS = tuple(0.5 * k for k in range(7))  # of the radii of a profile


def _radii(profile):
    """The radii at HEIGHTS of a meridian that goes up, brought to their height; None of another."""
    t = np.linspace(profile.start, profile.stop, 1001)
    radius, height = profile.radius(t), profile.height(t)
    if (np.diff(height) <= 0).any():
        return None
    scale = HEIGHTS[-1] / (height[-1] - height[0])
    found = np.interp(HEIGHTS, scale * (height - height[0]), scale * radius)
    return tuple(round(float(x), 2) for x in found)


PROFILES = {name: radii for name, make in surfaces.PROFILES.items() if (radii := _radii(make()))}


EDGE = 0.01  # degrees: angles closer to 0 and 180 are refused like these


class Range(NamedTuple):
    """Of a number: both ends, the slider's step, the unit; open: without the ends."""

    low: float
    high: float
    step: float = 1.0
    unit: str = ""
    open: bool = False
    whole: bool = False

    def read(self, value):
        """The number that a value or a text is, None where it is none of the range.

        A text may have a comma for the point, and an angle its unit: "60,5 deg"."""
        text = str(value).strip().replace(",", ".")
        for word in ("\u00b0", "degrees", "deg") if self.unit == "\u00b0" else ():
            text = text.removesuffix(word).rstrip()
        try:
            number = float(text if isinstance(value, str) else value)
        except (TypeError, ValueError, OverflowError):
            return None
        edge = EDGE if self.open else 0
        within = self.low + edge <= number <= self.high - edge
        if not within or (self.whole and not number.is_integer()):
            return None
        return int(number) if self.whole else number

    def wanted(self):
        """The range in words."""
        between = "above {:g} and below {:g}" if self.open else "from {:g} to {:g}"
        kind = "whole number" if self.whole else "number"
        return f"a {kind} {between.format(self.low, self.high)}{self.unit}"


ANGLE = Range(0, 180, 1, "\u00b0", open=True)
BEND = Range(0, 90, 1, "\u00b0")
BEND_ROLLED = BEND._replace(high=350)
POLE, RADIUS = Range(-3, 3, 0.05), Range(0.05, 3, 0.01)
SHADE_SWITCH = {True: "deviation", False: "none"}  # what links said at first
SWITCH = {"1": True, "0": False, "true": True, "false": False}
WORDS = {"px": "pole x", "py": "pole y", "pz": "pole z", "radii": "a radius of the profile"}


def _of(allowed, default):
    """A field, and what is allowed for it, or for each part: a `Range`, names, or a switch."""
    return field(default=default, metadata={"allowed": allowed})


@dataclass(frozen=True)
class Choice:
    """Everything that a net of the explorer depends on, and what is shown of it."""

    kind: str = _of(OPTIONS["kind"], "plane")
    map: str = _of(OPTIONS["map"], "exp")
    surface: str = _of(OPTIONS["surface"], "minimal")
    source: str = _of(OPTIONS["source"], "roof")
    theta: float = _of(ANGLE, 60.0)
    theta0: float = _of(ANGLE, 60.0)
    lock: bool = _of(SWITCH, False)
    m: int = _of(Range(3, 150, whole=True), 20)
    n: int = _of(Range(1, 150, whole=True), 30)
    bend: float = _of(BEND, 0.0)
    moebius: bool = _of(SWITCH, False)
    px: float = _of(POLE, -1.4)
    py: float = _of(POLE, 0.6)
    pz: float = _of(POLE, 0.3)
    radii: tuple = _of(RADIUS, PROFILES["vase"])
    quads: int = _of(Range(10, 20000, 10, whole=True), 700)
    direction: float = _of(Range(-90, 90, 1, "\u00b0"), 0.0)
    openings: str = _of(OPTIONS["openings"], "ring")
    trim: bool = _of(SWITCH, True)
    families: tuple = _of(FAMILIES, ("u", "v"))
    parallelograms: bool = _of(SWITCH, True)
    shade: str = _of(OPTIONS["shade"], "none")
    target: bool = _of(SWITCH, True)


ALLOWED = {f.name: f.metadata["allowed"] for f in fields(Choice)}
NAMES = tuple(ALLOWED)
USES = {  # of each kind, besides the angles and what is shown
    "plane": ("map", "m", "n", "px", "py"),
    "isothermal": ("surface", "m", "n", "bend", "moebius", "px", "py", "pz"),
    "revolution": ("m", "n", "radii"),
    "freeform": ("m", "n"),
    "cover": ("source", "quads", "direction", "openings", "trim"),
}
SHOWN = "families", "parallelograms", "shade", "target"
VIEW = "dark", "camera"  # of a link that was copied: how the page looked
OPENING = {  # what kinds and surfaces open with, where it is not what `Choice` has
    "isothermal": {"m": 28, "n": 40},
    "revolution": {"m": 36},
    "freeform": {"m": 26, "n": 22},
    "rolled": {"bend": 220.0},
}
PLAIN = {name: getattr(Choice(), name) for name in ("m", "n", "bend")}


def changed(choice: Choice, /, **values: object) -> tuple[Choice, list[str]]:
    """(the choice with these values, sentences on those that are refused).

    Values may be texts, as in a link.  With the lock on, one angle takes the other along; turning
    it on makes theta0 equal to theta.  A new surface lowers the bending to the largest it has.
    A new kind or surface opens with values of its own in the place of those that are as the
    former one opened with."""
    good: dict = {}
    problems = []
    for name in sorted(values, key=lambda name: name != "surface"):  # it limits the bending
        try:
            good[name] = _checked(name, values[name], good.get("surface", choice.surface))
        except ValueError as error:
            problems.append(str(error))
    if good.get("lock", choice.lock) and {"lock", "theta", "theta0"} & set(good):
        angle = good.get("theta", good.get("theta0", choice.theta))
        good |= {"theta": angle, "theta0": angle}
    found = replace(choice, **good)
    before, after = _opening(choice), _opening(found)
    moved = {x for x in after if x not in good and getattr(choice, x) == before[x]}
    found = replace(found, **{x: after[x] for x in moved})
    most = float(_allowed("bend", found.surface).high)
    return replace(found, bend=min(found.bend, most)), problems


def _opening(choice):
    return PLAIN | OPENING.get(choice.kind, {}) | OPENING.get(choice.surface, {})


def _allowed(name, surface):
    return BEND_ROLLED if (name, surface) == ("bend", "rolled") else ALLOWED[name]


def _checked(name, value, surface):
    if name not in NAMES:
        raise ValueError(f"{_short(name)} is no parameter")
    allowed = _allowed(name, surface)
    if name == "families":
        given = {_read(name, part, allowed) for part in _parts(value) if part != ""}
        return tuple(family for family in FAMILIES if family in given)
    if name == "radii":
        parts = PROFILES.get(str(value)) or _parts(value)
        if len(parts) != len(HEIGHTS):
            names = ", ".join(PROFILES)
            raise ValueError(f"radii: {len(HEIGHTS)} numbers, or one of {names}, are wanted")
        return tuple(_read(name, part, allowed) for part in parts)
    if name == "shade":
        value = SHADE_SWITCH.get(SWITCH.get(str(value).lower()), value)
    return _read(name, value, allowed)


def _read(name, value, allowed):
    """The value, or one part of it, as it is allowed; ValueError where it is not."""
    if isinstance(allowed, Range):
        found, wanted = allowed.read(value), allowed.wanted()
    elif allowed is SWITCH:
        found, wanted = SWITCH.get(str(value).lower()), "1 or 0"
    else:
        found = str(value) if str(value) in allowed else None
        wanted = f"one of {', '.join(allowed)}"
    if found is None:
        raise ValueError(f"{WORDS.get(name, name)} = {_short(value)}: {wanted} is wanted")
    return found


def _short(value):
    text = str(value)
    return repr(text if len(text) < 24 else text[:20] + " ...")


def _parts(value):
    """The parts of a text with commas, or of a sequence."""
    if isinstance(value, str):
        return value.split(",")
    return list(value) if isinstance(value, (list, tuple, set, dict)) else [value]


def name(choice: Choice) -> str:
    """What the net of a choice is called, in a word that a file's name may have."""
    if choice.kind == "isothermal":
        minimal = {0: "catenoid", 90: "helicoid"}.get(choice.bend, "minimal")
        found = minimal if choice.surface == "minimal" else choice.surface
        return found + "_image" * choice.moebius
    known = {radii: word for word, radii in PROFILES.items()}
    words = {"plane": choice.map, "revolution": known.get(choice.radii, "revolution")}
    return words.get(choice.kind, "patch" if choice.kind == "freeform" else choice.source)


def link(choice: Choice) -> str:
    """The choice as URL parameters: what its kind uses, and what is shown."""
    names = ("kind", "theta", "theta0", "lock", *USES[choice.kind], *SHOWN)
    return urlencode([(name, _text(getattr(choice, name))) for name in names], safe=",")


def _text(value):
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, tuple):
        return ",".join(_text(x) for x in value)
    return repr(value).removesuffix(".0") if isinstance(value, float) else str(value)


def parse(query: str, choice: Choice | None = None) -> tuple[Choice, list[str]]:
    """(a choice, sentences on what is wrong) of URL parameters, with or without the `?`."""
    pairs = _pairs(query)
    return changed(choice or Choice(), **{k: x for k, x in pairs.items() if k not in VIEW})


def seen(query: str) -> tuple[bool | None, list[float]]:
    """(whether the page is dark, its camera: seven numbers) of URL parameters; None and nothing
    where they do not say so.  The numbers are those of `Scene.place`."""
    pairs = _pairs(query)
    numbers = [Range(-1e6, 1e6).read(part) for part in pairs.get("camera", "").split(",")]
    whole = len(numbers) == 7 and None not in numbers and numbers[3] > 0
    return SWITCH.get(pairs.get("dark")), numbers if whole else []


def _pairs(query):
    return dict(parse_qsl(query.removeprefix("?")[:4000], keep_blank_values=True))
