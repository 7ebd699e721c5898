"""Exercises that check themselves: `check("4.2", answer)` says what is right and what is not.

An answer is a number, an array, a sympy expression or a function.  A function is run on random
instances, always the same ones, edge cases among them; the checks never print the answer.

How an exercise is declared.  Chapter 5.1 is the file c51.py here (files named so are found by
themselves); it holds a list EXERCISES of `engine.Exercise`, in the order of their names:

    Exercise(
        name="2.2", title="Which rings can be labelled", level="write a function", minutes=10,
        task="`answer(valences)`: whether ...  Return True or False.",
        hint="How often do the names change on the way around?",
        kind="function",                   # or "number", "array", "expression"
        instances=lambda rng: [([3, 3, 3],), *(... for k in range(12))],  # tuples of arguments
        truth=lambda valences: (sum(valences) - len(valences)) % 2 == 0,
        mistakes=[("You count corners: a triangle ...", lambda valences: len(valences) % 2 == 0)],
    )

* `truth` is independent of the functions of the library that a student would call.  It returns
  a number, an array, True, False or None; the names of its arguments are shown in messages, and
  are the symbols of an "expression" (write it with sympy; its instances are numbers).
* "number" and "array" have no instances; `truth` and the wrong answers may be plain values.
* `mistakes`: a wrong answer that agrees with a wrong function on all instances where it returns
  a finite value at all gets the sentence.  Sentences name the mistake and not the answer.
* `fault(value, *arguments)`, if given, says in a sentence how a value is wrong ("" : it is not),
  such as an angle measured from it.  With `truth=None` it alone decides: many answers are right.
* `tolerance` is relative, for what a person types 1e-3 or so."""

import re
import textwrap
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from . import tour
from .engine import Checked, Exercise, judge

WIDTH = 72  # of what is printed, so that a page of the book shows it whole
solved: set[str] = set()  # the names, in this process


@cache
def every() -> dict[str, Exercise]:
    """All exercises by their names, in the order of the chapters."""
    chapters = sorted(m.name for m in iter_modules(__path__) if re.fullmatch(r"c\d+", m.name))
    found = [e for c in chapters for e in import_module(f"{__name__}.{c}").EXERCISES]
    return {exercise.name: exercise for exercise in found}


def names() -> list[str]:
    """The names of all exercises: chapter, dot, number."""
    return list(every())


def find(name: str) -> Exercise:
    """The exercise of a name, or ValueError with the names that there are."""
    if str(name) not in every():
        raise ValueError(f"there is no exercise {name!r}: there are {', '.join(names())}")
    return every()[str(name)]


def check(name: str, answer: object = None) -> Checked:
    """Judge an answer and print the sentence; returns the record `Checked`.

    The steps "tour.1" to "tour.5" of notebook 0 take a net (V, Q) and say what its angles do."""
    if name in tour.STEPS:
        checked = tour.judge(name, answer)
    else:
        checked = judge(find(name), answer)
        solved.update([str(name)] if checked.right else [])
    print(textwrap.fill(f"{name}: {checked.message}", WIDTH, subsequent_indent="  "))
    return checked


def hint(name: str) -> None:
    """Print the hint of an exercise."""
    print(textwrap.fill(f"{name}: {find(name).hint}", WIDTH, subsequent_indent="  "))


def report() -> None:
    """Print which exercises are solved in this process, chapter by chapter."""
    chapters = {}
    for name in names():
        chapters.setdefault(name.rpartition(".")[0], []).append(name)
    for chapter, inside in chapters.items():
        marks = "  ".join(f"{name} {'solved' if name in solved else '-'}" for name in inside)
        print(f"{chapter:4}{marks}")
    print(f"{len(solved)} of {len(names())} are solved")
