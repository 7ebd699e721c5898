"""What the explorer can be asked for: one record of checked values, and the same as a link.

Angles are degrees here, as on the command line and on the page.
"""

from dataclasses import dataclass, fields, replace
from math import isfinite
from typing import NamedTuple
from urllib.parse import parse_qsl, urlencode

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
        "file": "The file of the command line",
    },
}
PROFILES = {
    "vase": (0.80, 1.02, 1.00, 0.72, 0.45, 0.48, 0.66),
    "barrel": (0.70, 0.95, 1.08, 1.12, 1.08, 0.95, 0.70),
    "hourglass": (1.10, 0.88, 0.66, 0.55, 0.66, 0.88, 1.10),
    "cone": (1.20, 1.05, 0.90, 0.75, 0.60, 0.45, 0.30),
}
HEIGHTS = tuple(0.5 * k for k in range(7))  # of the radii of a profile


class Range(NamedTuple):
    """Of a number: the smallest and the largest value, the slider's step, the unit, the kind.

    open: the ends themselves are excluded; whole: whole numbers only.
    """

    low: float
    high: float
    step: float = 1.0
    unit: str = ""
    open: bool = False
    whole: bool = False


RANGES = {
    "theta": Range(0, 180, 1, "\u00b0", open=True),
    "theta0": Range(0, 180, 1, "\u00b0", open=True),
    "m": Range(3, 150, whole=True),
    "n": Range(1, 150, whole=True),
    "bend": Range(0, 90, 1, "\u00b0"),
    "px": Range(-3, 3, 0.05),
    "py": Range(-3, 3, 0.05),
    "pz": Range(-3, 3, 0.05),
    "quads": Range(10, 20000, 10, whole=True),
    "direction": Range(-90, 90, 1, "\u00b0"),
    "radius": Range(0.05, 3, 0.01),
}
WORDS = {"radius": "a radius of the profile", "px": "pole x", "py": "pole y", "pz": "pole z"}


@dataclass(frozen=True)
class Choice:
    """Everything that a net of the explorer depends on, and what is shown of it."""

    kind: str = "plane"
    map: str = "square"
    surface: str = "minimal"
    source: str = "roof"
    theta: float = 60.0
    theta0: float = 60.0
    lock: bool = False
    m: int = 20
    n: int = 32
    bend: float = 30.0
    moebius: bool = False
    px: float = -1.4
    py: float = 0.6
    pz: float = 0.3
    radii: tuple = PROFILES["vase"]
    quads: int = 800
    direction: float = 0.0
    families: tuple = ("u", "v")
    parallelograms: bool = False
    shade: bool = False


NAMES = tuple(field.name for field in fields(Choice))
USES = {  # of each kind, besides the angles and what is shown
    "plane": ("map", "m", "n", "px", "py"),
    "isothermal": ("surface", "m", "n", "bend", "moebius", "px", "py", "pz"),
    "revolution": ("m", "n", "radii"),
    "freeform": ("m", "n"),
    "cover": ("source", "quads", "direction"),
}
SHOWN = "families", "parallelograms", "shade"


def limits(choice, name):
    """The `Range` of a number: the same for all choices, but for the angle of bending."""
    rolled = name == "bend" and choice.surface == "rolled"
    return RANGES[name]._replace(high=350) if rolled else RANGES[name]


def changed(choice, **values):
    """(the choice with these values, sentences on those that are refused).

    Values may be texts, as in a link.  Refused values leave the choice as it was.  With the
    lock on, one angle takes the other along; turning it on makes theta0 equal to theta.  A
    bending that a newly chosen surface does not have is lowered to its largest.
    """
    good, problems = {}, []
    for name in sorted(values, key=lambda name: name != "surface"):  # it limits the bending
        try:
            surface = good.get("surface", choice.surface)
            good[name] = _checked(replace(choice, surface=surface), name, values[name])
        except ValueError as error:
            problems.append(str(error))
    locked = good.get("lock", choice.lock)
    if locked and "theta" not in good and "theta0" in good:
        good["theta"] = good["theta0"]
    elif locked and {"theta", "lock"} & set(good):
        good["theta0"] = good.get("theta", choice.theta)
    found = replace(choice, **good)
    top = limits(found, "bend").high
    return (replace(found, bend=float(top)) if found.bend > top else found), problems


def _checked(choice, name, value):
    if name not in NAMES:
        raise ValueError(f"{name}: there is no such value")
    if name in OPTIONS:
        if not (isinstance(value, str) and value in OPTIONS[name]):
            known = ", ".join(OPTIONS[name])
            raise ValueError(f"{name} = {_short(value)}: one of {known} is wanted")
        return value
    if name in RANGES:
        return _number(value, name, limits(choice, name))
    if name == "radii":
        return _radii(value)
    if name == "families":
        return _families(value)
    return _switch(name, value)


def _short(value):
    text = str(value)
    return repr(text if len(text) < 24 else text[:20] + " ...")


def _number(value, name, bounds):
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        number = float("nan")
    inside = bounds.low < number < bounds.high if bounds.open else True
    whole = number == int(number) if bounds.whole and isfinite(number) else True
    if not (isfinite(number) and bounds.low <= number <= bounds.high and inside and whole):
        kind = "a whole number" if bounds.whole else "a number"
        between = "above {} and below {}" if bounds.open else "from {} to {}"
        wanted = between.format(f"{bounds.low:g}", f"{bounds.high:g}")
        raise ValueError(
            f"{WORDS.get(name, name)} = {_short(value)}: {kind} {wanted}{bounds.unit} is wanted"
        )
    return int(number) if bounds.whole else number


def _radii(value):
    if isinstance(value, str) and value in PROFILES:
        return PROFILES[value]
    parts = _parts(value)
    if len(parts) != len(HEIGHTS):
        raise ValueError(
            f"radii: {len(HEIGHTS)} numbers, or one of {', '.join(PROFILES)}, are wanted"
        )
    return tuple(_number(part, "radius", RANGES["radius"]) for part in parts)


def _parts(value, otherwise=()):
    """The parts of a text with commas or of a sequence; of anything else, `otherwise`."""
    if isinstance(value, str):
        return value.split(",")
    return list(value) if isinstance(value, (list, tuple, set, dict)) else list(otherwise)


def _families(value):
    given = {str(part) for part in _parts(value, (None,)) if part != ""}
    if unknown := given - set(FAMILIES):
        raise ValueError(f"families = {_short(sorted(unknown)[0])}: u, v, d1, d2 are wanted")
    return tuple(name for name in FAMILIES if name in given)


def _switch(name, value):
    known = {"1": True, "0": False, "true": True, "false": False}
    text = str(value).lower()
    if text not in known:
        raise ValueError(f"{name} = {_short(value)}: 1 or 0 is wanted")
    return known[text]


# --- links --------------------------------------------------------------------------------


def link(choice):
    """The choice as URL parameters: what its kind uses, and what is shown."""
    names = ("kind", "theta", "theta0", "lock", *USES[choice.kind], *SHOWN)
    return urlencode([(name, _text(getattr(choice, name))) for name in names], safe=",")


def _text(value):
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, tuple):
        return ",".join(_text(x) for x in value)
    return repr(value).removesuffix(".0") if isinstance(value, float) else str(value)


def parse(query, choice=None):
    """(a choice, sentences on what is wrong) of URL parameters, with or without the `?`."""
    pairs, problems = parse_qsl(query.removeprefix("?")[:4000], keep_blank_values=True), []
    values = dict(pairs)
    problems += [f"{_short(name)} is no parameter" for name in values if name not in NAMES]
    known = {name: value for name, value in values.items() if name in NAMES}
    found, wrong = changed(choice or Choice(), **known)
    return found, problems + wrong
