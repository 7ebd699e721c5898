"""PAPER.md, ERRATA.md, the docstrings, the tests and the notebooks' headings agree."""

import ast
import functools
import inspect
import re
from pathlib import Path

import nbformat
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
BEYOND = [f"B{k}" for k in range(1, 12)]


@functools.cache
def rows(part=0):
    """A table of PAPER.md, of the paper (0) or beyond it (1): {item: (functions, tests, page)}."""
    text = (ROOT / "PAPER.md").read_text(encoding="utf-8").split("\n## Beyond the paper\n")[part]
    lines = text.splitlines()
    cells = [[c.strip() for c in line.strip("|").split("|")] for line in lines if line[:1] == "|"]
    table = {}
    for item, _, functions, tests, notebook, status in cells[2:]:
        assert item not in table, item
        assert status == "done", item
        quoted = (re.findall(r"`([^`]+)`", cell) for cell in (functions, tests))
        table[item] = *quoted, notebook
    return table


@functools.cache
def headings(notebook, part):
    """The headings of a notebook, or (1) the small lines below them, as one line."""
    cells = nbformat.read(ROOT / "notebooks" / f"{notebook}.ipynb", as_version=4).cells
    lines = [line for c in cells if c.cell_type == "markdown" for line in c.source.splitlines()]
    return " ".join(line for line in lines if line.startswith("<small>" if part else "#"))


@functools.cache
def names_in(path):
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    return {n.name for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)}


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


@pytest.mark.parametrize(("part", "item"), [(k, item) for k in (0, 1) for item in rows(k)])
def test_a_row_names_a_function_a_test_and_a_heading_that_exist(part, item):
    functions, tests, notebook = rows(part)[item]
    assert functions and tests
    for name in functions:
        assert item in citations(part)[name], f"{name} does not cite {item}"
    for name in tests:
        path, _, test = name.partition("::")
        assert test in names_in(f"tests/{path}"), name
    stem, heading = re.fullmatch(r"\[(\w+)\]\(notebooks/\1\.ipynb\), (.+)", notebook).groups()
    assert heading == item
    assert re.search(re.escape(item) + r"(?!\d)", headings(stem, part)), (
        f"{stem} has no heading for {item}"
    )


def test_every_docstring_that_cites_an_item_stands_in_its_row():
    for part in (0, 1):
        for name, items in citations(part).items():
            for item in items:
                assert name in rows(part)[item][0], f"the row of {item} lacks {name}"


def test_every_erratum_has_a_test_and_each_number_is_accounted_for():
    text = (ROOT / "ERRATA.md").read_text(encoding="utf-8")
    found, done = names_in("tests/test_errata.py"), []
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
