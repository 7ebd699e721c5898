"""PAPER.md, ERRATA.md, the docstrings, the tests and the notebooks' headings agree."""

import ast
import functools
import inspect
import json
import re
from pathlib import Path
from typing import NamedTuple

import pytest
from test_project import public

ROOT = Path(__file__).resolve().parent.parent
ITEM = re.compile(
    r"(?:Eq\.|Lemma|Def\.|Prop\.|Thm|Cor\.|Fig\.|Alg\.|Table) \d+|App\. A\.\d|Eq\. \(\d+\)"
)
EVERYTHING = (
    [f"Eq. ({k})" for k in range(1, 23)]
    + ["Lemma 1", *(f"Def. {k}" for k in (2, 3, 5, 10, 14)), "Prop. 4", "Prop. 6", "Prop. 13"]
    + [*(f"Thm {k}" for k in (7, 8, 11, 12)), *(f"Cor. {k}" for k in (9, 15, 16, 17, 18))]
    + [*(f"Fig. {k}" for k in range(1, 14)), "Alg. 1", "Table 1"]
    + [f"App. A.{k}" for k in range(1, 5)]
)
RERUN = "test_a_rerun_draws_the_stored_figures"
CONSTANT = "test_thm_7_constant_ratios_of_tangents_mean_constant_angles"
BEYOND = [f"B{k}" for k in range(1, 12)]


@functools.cache
def rows(part=0):
    """A table of PAPER.md, of the paper (0) or beyond it (1): {item: its cells}.

    The cells are functions, tests, notebook and what kind of proof it is."""
    text = (ROOT / "PAPER.md").read_text(encoding="utf-8").split("\n## Beyond the paper\n")[part]
    lines = text.splitlines()
    table, split = {}, ([c.strip() for c in x.strip("|").split("|")] for x in lines if x[:1] == "|")
    for item, _, functions, tests, notebook, proof in list(split)[2:]:
        assert item not in table, item
        quoted = (re.findall(r"`([^`]+)`", cell) for cell in (functions, tests))
        table[item] = *quoted, notebook, proof
    return table


def sources(notebook, kind):
    """The text of each cell of a kind."""
    text = (ROOT / "notebooks" / f"{notebook}.ipynb").read_text(encoding="utf-8")
    found = json.loads(text)["cells"]
    return ["".join(cell["source"]) for cell in found if cell["cell_type"] == kind]


@functools.cache
def headings(notebook, part):
    """The headings of a notebook, or (1) the small lines below them, as one line."""
    lines = "\n".join(sources(notebook, "markdown")).splitlines()
    return " ".join(line for line in lines if line.startswith("<small>" if part else "#"))


@functools.cache
def cells(notebook):
    """The code of a notebook, one text."""
    return "\n".join(sources(notebook, "code"))


@functools.cache
def parts(path):
    """{name: node} of the functions, classes and values that a test file has at its top."""
    found = {}
    for node in ast.parse((ROOT / "tests" / path).read_text(encoding="utf-8")).body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        names = [n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)]
        for name in names or [getattr(node, "name", None)]:
            found.setdefault(name, node)
        if isinstance(node, ast.ImportFrom):
            found |= {(a.asname or a.name, node.module.rpartition(".")[2]): a for a in node.names}
    return found


class Words(NamedTuple):
    """What stands in a test, in its decorators and in the parts of its file that it uses."""

    names: set
    attributes: set
    strings: set
    source: str


@functools.cache
def words(path, test):
    top, todo, seen = parts(path), [test], {}
    while todo:
        name = todo.pop()
        if name in top and name not in seen:
            seen[name] = top[name]
            nodes = list(ast.walk(top[name]))
            todo += [n.id for n in nodes if isinstance(n, ast.Name)]
            todo += [n.arg for n in nodes if isinstance(n, ast.arg)]
    nodes = [n for node in seen.values() for n in ast.walk(node)]
    texts = {n.value for n in nodes if isinstance(n, ast.Constant) and isinstance(n.value, str)}
    return Words(
        {n.id for n in nodes if isinstance(n, ast.Name)},
        {n.attr for n in nodes if isinstance(n, ast.Attribute)},
        texts,
        "\n".join(map(ast.unparse, seen.values())),
    )


def says(path, test, function):
    """Whether a test names a function, "room.name": as an attribute of its room, or imported."""
    room, _, name = function.rpartition(".")
    room, found = room.rpartition(".")[2], words(path, test)
    imported = name in found.names and (name, room) in parts(path)
    return imported or (room in found.names and name in found.attributes | found.strings)


def touched(functions, tests, notebook):
    """Those of the functions that the tests name, or the notebook if it is rerun and compared,
    or another one of them."""
    stem, run = notebook[1:].partition("]")[0], f"test_notebooks.py::{RERUN}" in tests
    pairs = [test.split("::") for test in tests]
    found = {f for f in functions if any(says(*pair, f) for pair in pairs)}
    found |= {f for f in functions if run and re.search(rf"\b{short(f)}\b", cells(stem))}
    todo = list(found)
    while todo:
        source = inspect.getsource(public()[todo.pop()])
        new = [f for f in functions if f not in found and re.search(rf"\b{last(f)}\(", source)]
        found.update(new)
        todo += new
    return found


def last(name):
    return re.escape(name.rpartition(".")[2])


def short(name):
    """room.function, without the packages around the room."""
    return re.escape(".".join(name.split(".")[-2:]))


def shown(strength, functions, tests, notebook):
    """Whether the tests of a row are of the kind that its last column states."""
    found = [words(*test.split("::")) for test in tests]
    kind, _, names = strength.partition(": ")
    if kind == "symbols":
        return any(re.search(r"\b(?:sp|sympy)\.[sS]ymbol", w.source) for w in found)
    if kind == "nets":
        source = " ".join(w.source for w in found).lower()
        return all(name in source for name in names.split(", "))
    if kind == "drawing":
        rooms = {f.split(".")[1] for f in functions if f.startswith("drawings.")}
        return any(rooms & w.names and {"draw", "drawn"} & (w.attributes | w.names) for w in found)
    if kind == "rerun":
        return f"test_notebooks.py::{RERUN}" in tests and notebook
    count = re.fullmatch(r"(\d+) random", kind)[1]
    cases = [w for w in found if re.search(r"\b(?:default_rng|given|random_angles)\(", w.source)]
    often = {"60": "@given("}.get(count)  # as many examples as conftest.py asks for
    return any(re.search(rf"\b{count}\b", w.source) or (often and often in w.source) for w in cases)


def kinds(part):
    """{"symbols" or "random" ...: the rows with it}, and all numbers of random cases."""
    found, counts = {}, []
    for item, (*_, proof) in rows(part).items():
        for strength in proof.split("; "):
            kind = strength.partition(": ")[0]
            counts += map(int, re.findall(r"^\d+", kind))
            found.setdefault(kind.split()[-1], []).append(item)
    return found, counts


def cited(doc):
    """The numbered items in the last line of a docstring, and the results beyond the paper."""
    last = doc.splitlines()[-1]
    return set(ITEM.findall(last)), set(re.findall(r"\bB\d+\b", last))


@functools.cache
def citations(part):
    """{"room.name": the items that the docstring cites, of the paper (0) or beyond it (1)}."""
    return {name: cited(inspect.getdoc(value))[part] for name, value in public().items()}


def test_every_numbered_item_stands_exactly_once():
    assert sorted(rows()) == sorted(EVERYTHING)
    assert list(rows(1)) == BEYOND


def test_a_heading_begins_with_the_items_that_it_stands_for():
    """ITEM, ITEM: title.  Any other item of a heading comes after the colon, as a mention."""
    one = rf"(?:{ITEM.pattern}|(?:Sec|App)\. [A\d][.\d]*)"
    begin, named = re.compile(rf"{one}(?:, {one})*(?:, remark)?: \S"), {}
    for path in sorted((ROOT / "notebooks").glob("*.ipynb")):
        for line in re.findall("##+ ([^#]+)", headings(path.stem, 0)):
            first = begin.match(line)
            assert first or not ITEM.search(line.partition(":")[0]), line
            named.setdefault(path.stem, set()).update(ITEM.findall(first[0] if first else ""))
    for item in EVERYTHING:
        stem = re.match(r"\[(\w+)\]", rows()[item][2])[1]
        assert item in named[stem], f"no heading of {stem} begins with {item}"


EVERY_ROW = pytest.mark.parametrize(("part", "item"), [(k, i) for k in (0, 1) for i in rows(k)])


@EVERY_ROW
def test_a_row_names_a_function_a_test_and_a_heading_that_exist(part, item):
    functions, tests, notebook, _ = rows(part)[item]
    assert functions and tests
    for name in functions:
        assert item in citations(part)[name], f"{name} does not cite {item}"
    for name in tests:
        path, _, test = name.partition("::")
        assert test in parts(path), name
    stem, heading = re.fullmatch(r"\[(\w+)\]\(notebooks/\1\.ipynb\), (.+)", notebook).groups()
    assert heading == item
    assert re.search(re.escape(item) + r"(?!\d)", headings(stem, part)), (
        f"{stem} has no heading for {item}"
    )


@EVERY_ROW
def test_the_tests_of_a_row_touch_its_functions_and_are_of_the_kind_it_states(part, item):
    functions, tests, notebook, proof = rows(part)[item]
    missed = set(functions) - touched(functions, tests, notebook)
    assert not missed, f"no test of {item} names {sorted(missed)}"
    for strength in proof.split("; "):
        assert shown(strength, functions, tests, notebook), f"{item}: {strength}?"


def test_the_checks_of_rows_can_fail():
    row = ["parallelogram.angles"], [f"test_theorems.py::{CONSTANT}"], "[4_isogonal_nets](...)"
    assert touched(*row) == set()
    assert touched(["surfaces.ratios"], *row[1:]) == {"surfaces.ratios"}
    for strength in ("symbols", "99 random", "nets: pyramid", "drawing", "rerun"):
        assert not shown(strength, *row)
    assert shown("100 random", *row) and shown("nets: sphere", *row)


def test_paper_md_counts_its_rows_by_the_kind_of_their_proof():
    text = " ".join((ROOT / "PAPER.md").read_text(encoding="utf-8").split())
    for part in (0, 1):
        found, counts = kinds(part)
        assert {*found} == {"symbols", "random", "nets", "drawing", "rerun"}
        stated = (
            f"{len(found['symbols'])} of {len(rows(part))} rows are proved by symbols,"
            f" {len(found['random'])} over {min(counts)} to {max(counts)} random cases,"
            f" {len(found['nets'])} on nets, {len(found['drawing'])} by what is drawn and"
            f" {len(found['rerun'])} by a rerun"
        )
        assert stated in text, stated


def test_every_docstring_that_cites_an_item_stands_in_its_row():
    for part in (0, 1):
        for name, items in citations(part).items():
            for item in items:
                assert name in rows(part)[item][0], f"the row of {item} lacks {name}"


def test_every_erratum_has_a_test_and_each_number_is_accounted_for():
    text = (ROOT / "ERRATA.md").read_text(encoding="utf-8")
    found, done = [name for name in parts("test_errata.py") if isinstance(name, str)], []
    kinds = re.split(r"^# ", text, flags=re.MULTILINE)[2:]
    heads = {"Misprints": "Must be", "Conditions that are missing": "Must be"}
    heads |= {"Readings": "Read as", "Words": None}
    assert [kind.partition("\n")[0] for kind in kinds] == list(heads)
    for kind, word in zip(kinds, heads.values(), strict=True):
        for part in re.split(r"^## ", kind, flags=re.MULTILINE)[1:]:
            number = re.match(r"E(\d+) ", part)[1]
            assert all(f"- {w}:" in part for w in ("Printed", word, "Why", "Test")), part
            assert (test := re.search(r"- Test: `(\w+)`", part)[1]) in found
            assert test.startswith(f"test_e{number}_")
            done.append(int(number))
    tests = {int(re.match(r"test_e(\d+)_", n)[1]) for n in found if n.startswith("test_e")}
    assert sorted(done) == sorted(tests) == list(range(1, len(done) + 1))
