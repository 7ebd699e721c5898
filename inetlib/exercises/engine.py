"""What judges an answer: run it on instances, compare with the truth, name the mistake."""

import ctypes
import inspect
import threading
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

LEVELS = "change a number", "write a function", "prove"
KINDS = "number", "array", "expression", "function"
SECONDS = 5.0  # for all instances together
EMPTY = "there is no answer yet: put yours in the place of None."
TRUTHS = bool, np.bool_
CONSTANT = "It is the same for every instance: does it use what it is given?"


class Exercise(NamedTuple):
    """One exercise; see `inetlib.exercises` for what each part means."""

    name: str
    title: str
    level: str
    minutes: int
    task: str
    hint: str
    kind: str
    truth: Any
    mistakes: Sequence[tuple[str, Any]]
    instances: Callable = lambda rng: [()]
    fault: Callable | None = None
    tolerance: float = 1e-9


class Checked(NamedTuple):
    """What a check found."""

    right: bool
    message: str

    def _ipython_display_(self):
        """Show nothing below a cell: `check` has printed the message."""


class Raised(NamedTuple):
    """The outcome of a call that raised an error."""

    error: BaseException


@np.errstate(all="ignore")
def judge(exercise: Exercise, answer: object) -> Checked:
    """Judge an answer, silently."""
    if answer is None:
        return Checked(False, EMPTY)
    words = _misfit(exercise, answer)
    if words:
        return Checked(False, words)
    given = _function(exercise, answer) if exercise.kind == "expression" else answer
    got = _within(SECONDS, lambda: _outcomes(exercise, given))
    if got is None:
        words = f"it takes more than {SECONDS:g} seconds and was stopped: is there an endless loop?"
        return Checked(False, words)
    wanted = got if exercise.truth is None else _outcomes(exercise, exercise.truth)
    cases = _cases(exercise)
    faults = [_fault(exercise, *one) for one in zip(cases, got, wanted, strict=True)]
    bad = [k for k, words in enumerate(faults) if words]
    if not bad:
        return Checked(True, "right" + (f", on {len(got)} instances." if len(got) > 1 else "."))
    words = [_where(exercise, cases[bad[0]]) + faults[bad[0]], *_known(exercise, got)]
    if len(bad) < len(got):
        words.append(f"(Right on {len(got) - len(bad)} of {len(got)} instances.)")
    return Checked(False, "not yet: " + " ".join(words))


def told(value: object, digits: int = 6) -> str:
    """A value in a few words, numbers of an array with four digits."""
    if callable(value) and not hasattr(value, "free_symbols"):
        return getattr(value, "__name__", "a function").replace("<lambda>", "a function")
    array = numbers(value)
    if array is None or isinstance(value, TRUTHS):
        words = str(value)
        return words if len(words) < 60 else words[:57] + "..."
    if array.size > 12:
        return f"an array of shape {array.shape}"
    if array.ndim:
        return "(" + ", ".join(told(x, 4) for x in array) + ")"
    return f"{array if array.imag else array.real:.{digits}g}"


def numbers(value: object) -> np.ndarray | None:
    """The value as complex numbers, or None where it is no number and no array of them."""
    try:
        return None if isinstance(value, str | None) else np.asarray(value, dtype=complex)
    except (TypeError, ValueError, OverflowError):
        return None


def alike(one: object, two: object, tolerance: float) -> bool:
    """Whether two outcomes are the same, numbers up to a relative tolerance; errors never are."""
    if one is None or two is None or isinstance(one, Raised) or isinstance(two, Raised):
        return one is two
    if isinstance(one, TRUTHS) or isinstance(two, TRUTHS):
        return isinstance(one, TRUTHS) and isinstance(two, TRUTHS) and bool(one == two)
    a, b = numbers(one), numbers(two)
    if a is None or b is None or a.shape != b.shape:
        return a is b and bool(np.all(one == two))
    return bool(np.allclose(a, b, rtol=tolerance, atol=min(tolerance, 1e-12)))


def _misfit(exercise, answer):
    """What is wrong with the kind of an answer, or ""."""
    symbolic, names = hasattr(answer, "free_symbols"), ", ".join(_arguments(exercise))
    if exercise.kind == "function":
        fits = callable(answer) and not symbolic
        return "" if fits else f"a function of {names} is wanted, not {told(answer)}."
    if callable(answer) and not symbolic:
        return "a value is wanted, not a function: call yours, and check what it returns."
    if exercise.kind == "expression":
        if not symbolic and (numbers(answer) is None or np.ndim(answer)):
            return f"a sympy expression in {names} is wanted, not {told(answer)}."
        free = {_spelt(s) for s in getattr(answer, "free_symbols", ())} - {*_arguments(exercise)}
        return f"{sorted(free)[0]} must not be in it, only {names}." if free else ""
    return ""


def _arguments(exercise):
    """The names of what a function is given, or of the symbols of an expression."""
    decides = exercise.truth if callable(exercise.truth) else exercise.fault
    found = list(inspect.signature(decides).parameters) if decides else []
    return found if decides is exercise.truth else found[1:]


def _spelt(symbol):
    """The name of a symbol: lambda is a word of Python."""
    return str(symbol).replace("lambda", "lam")


def _function(exercise, expression):
    """A sympy expression as a function of its symbols, whatever is assumed about them."""
    import sympy

    expression, names = sympy.sympify(expression), _arguments(exercise)
    given = {_spelt(s): s for s in expression.free_symbols}

    def value(*values):
        places = {
            given[n]: sympy.Float(x) for n, x in zip(names, values, strict=True) if n in given
        }
        return complex(expression.subs(places))

    return value


def _cases(exercise):
    """The instances, made anew for whoever may change them."""
    return exercise.instances(np.random.default_rng(17))


def _outcomes(exercise, answer):
    """What a function returns on each instance, or `Raised`; a value counts as a constant one."""
    found, cases = [], _cases(exercise)
    with np.errstate(all="ignore"):
        for case in cases:
            try:
                found.append(answer(*case) if callable(answer) else answer)
            except BaseException as error:
                found.append(Raised(error))
                if not isinstance(error, Exception):  # told to end
                    break
    return found + found[-1:] * (len(cases) - len(found))


def _within(seconds, work):
    """What `work` returns, in a thread of its own; None if that takes longer."""
    found = []
    thread = threading.Thread(target=lambda: found.append(work()), daemon=True)
    thread.start()
    thread.join(seconds)
    if thread.is_alive():  # Python code ends by this; what waits for something else is left alone
        ctypes.pythonapi.PyThreadState_SetAsyncExc(
            ctypes.c_ulong(thread.ident), ctypes.py_object(SystemExit)
        )
        return None
    return found[0]


def _fault(exercise, case, got, wanted):
    """What is wrong with an outcome, in words that follow "for x = 1 ", or ""."""
    if isinstance(got, Raised):
        return f"it raised {type(got.error).__name__}: {got.error}".strip(": ") + "."
    if got is None and (wanted is not None or exercise.truth is None):
        return "it gives None: is a return missing?"
    start = {"function": "it gives ", "expression": "it is "}.get(exercise.kind, "")
    words, a, b = start + told(got), numbers(got), numbers(wanted)
    if isinstance(wanted, TRUTHS) and not isinstance(got, TRUTHS):
        return f"{words}, where True or False is wanted."
    if a is not None and not np.isfinite(a).all():
        return f"{words}: not all of it is a finite number."
    if b is not None and (a is None or a.shape != b.shape):
        shape = f"an array of shape {b.shape}" if b.ndim else "a number"
        return f"{words}, where {shape} is wanted."
    if exercise.truth is not None and alike(got, wanted, exercise.tolerance):
        return ""
    try:
        about = exercise.fault(got, *case) if exercise.fault else ""
    except Exception:  # the answer is nothing that `fault` could measure
        about = "This has not the form that is wanted."
    if exercise.truth is None:
        return f"{words}. {about}" if about else ""
    off = ", which is wrong." if start else " is not it."
    if start and a is not None and b is not None and not isinstance(got, TRUTHS):
        off = f", which is off by {np.abs(a - b).max():.3g}."
    return f"{words}{off} {about}".strip()


def _where(exercise, case):
    """The instance in words."""
    if not case:
        return ""
    pairs = zip(_arguments(exercise), case, strict=True)
    return "for " + ", ".join(f"{name} = {told(value)}" for name, value in pairs) + " "


def _known(exercise, got):
    """The sentences of the mistake that an answer agrees with, if any."""
    fine = [k for k, x in enumerate(got) if _finite(x)]
    if not fine or 2 * len(fine) < len(got):
        return []
    for sentence, wrong in exercise.mistakes:
        theirs = _outcomes(exercise, wrong)
        if all(alike(got[k], theirs[k], exercise.tolerance) for k in fine):
            return [sentence]
    same = numbers(got[0]) is not None and all(alike(got[0], x, exercise.tolerance) for x in got)
    return [CONSTANT] if same and len(got) > 1 else []


def _finite(value):
    array = numbers(value)
    return not isinstance(value, Raised) and (array is None or bool(np.isfinite(array).all()))
