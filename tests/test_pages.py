"""What the book is made of: links of items, docstrings, the counts of the claims; no build."""

import re
import sys
from pathlib import Path

import pytest
from test_paper import BEYOND, EVERYTHING
from test_paper import rows as table

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "book"))
import build  # noqa: E402
import pages  # noqa: E402
import wording  # noqa: E402


def test_every_item_of_the_paper_has_one_claim():
    found = [item for row in pages.rows() for item in wording.items(row.item)]
    assert sorted(found) == sorted(EVERYTHING + BEYOND)
    assert {row.item for row in pages.rows()} == {*table(0), *table(1)}


def test_the_claims_are_counted_from_the_table_and_the_errata():
    text = pages.claimed()
    counts = re.findall(r"^\| ([\w ,]+) \| (\d+)(?: of (\d+))? \|", text, re.MULTILINE)
    assert counts[0] == ("Equations", "22", "22") and counts[2] == ("Figures", "13", "13")
    assert counts[1][1:] == ("18", "18") and counts[5] == ("Beyond the paper", "11", "11")
    statuses = re.findall(r"\*\*Status:\*\* (.*)\.", text)
    assert len(statuses) == len(pages.rows()) and all(statuses)
    misprints = [s for s in statuses if "misprint (" in s]
    assert any("[E4](errata.md#e4-eq-(15))" in s for s in misprints)
    assert sum("holds with a condition" in s for s in statuses) == sum(
        "holds with a condition" in pages.faults(row) for row in pages.rows()
    )


def test_the_tolerance_of_a_row_is_the_coarsest_that_its_tests_compare_with(tmp_path, monkeypatch):
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_a.py").write_text(
        "def test_b():\n    step = 1e-4\n    assert abs(step - 1e-4) < 1e-12\n"
        "    close(1, 1, atol=1e-9)\n    assert step < 1\n"
    )
    monkeypatch.setattr(pages, "ROOT", tmp_path)
    pages.tolerances.cache_clear()
    assert pages.tolerances(("test_a.py::test_b",)) == "1e-9"
    pages.tolerances.cache_clear()


@pytest.mark.parametrize(
    ("text", "items"),
    [
        ("as in Eq. (3) and Thm 7.", ["Eq. (3)", "Thm 7"]),
        ("Eqs. (7), (9) and (10)", ["Eq. (7)", "Eq. (9)", "Eq. (10)"]),
        ("Figs. 7, 9, and 10; App. A.3", ["Fig. 7", "Fig. 9", "Fig. 10", "App. A.3"]),
        ("see E12, B3", ["E12", "B3"]),
        ("Sec. 4.3, E12x, Fig. 3.5, [E12]", []),
    ],
)
def test_items_are_found_in_texts(text, items):
    assert wording.items(text) == items


def test_items_become_links_outside_of_code_mathematics_headings_and_links():
    def target(item):
        return f"x#{wording.slug(item)}"

    text = (
        "# Eq. (1)\nEq. (1), `Eq. (1)`, $Eq. (1)$, [Eq. (1)](y)\n| Eq. (1) |\n\nEqs. (1) to (3)\n"
    )
    link = "[Eq. (1)](x#eq-(1))"
    wanted = f"# Eq. (1)\n{link}, `Eq. (1)`, $Eq. (1)$, [Eq. (1)](y)\n| Eq. (1) |\n\n"
    wanted += "Eqs. [(1)](x#eq-(1)) to [(3)](x#eq-(3))\n"
    assert wording.linked(text, target) == wanted
    assert wording.linked(text, lambda item: None) == text


def test_links_between_files_of_the_project_become_those_of_the_book():
    text = "[a](../PAPER.md) [b](4_isogonal_nets.ipynb#Def.-3:-a-$(x)$-quad) [`c`](tests/t.py)"
    found = pages.inside(text, 1)
    assert found == "[a](../paper.md) [b](../notebooks/4_isogonal_nets.ipynb#def-3-a-quad) `c`"
    assert pages.inside("[lectures](book/two.md#a)") == "[lectures](two.md#a)"
    assert pages.inside("[d](tests/t.py) [e](#Two-words)") == "d (`tests/t.py`) [e](#two-words)"


def test_docstrings_become_restructured_text():
    lines = ["|d2| / |d1| of `d2`, Eq. (3).", "", "V  (n, 3) vertices", "Q  (f, 4) quads", ""]
    found = wording.restructured(lines, lambda item: "x")
    assert found[0] == r"\|d2\| / \|d1\| of ``d2``, `Eq. (3) <x>`__."
    assert found[2:6] == ["::", "", "    V  (n, 3) vertices", "    Q  (f, 4) quads"]
    assert wording.restructured([">>> f(1)", "2"], lambda item: None) == [">>> f(1)", "2", ""]


def test_every_function_test_and_heading_of_a_row_is_a_link_to_something():
    for row in pages.rows():
        assert all(pages.module_of(name) in pages.modules() for name in row.functions)
        assert "#" in pages.place(row), row.item
        assert all(pages.check(test).startswith("[test_") for test in row.tests)


def test_links_that_lead_nowhere_are_found(tmp_path):
    (tmp_path / "a.html").write_text(
        '<p id="x"><a href="#x"><a href="b.html#y"><a href="b.html#z"><img src="c.png">'
    )
    (tmp_path / "b.html").write_text('<p id="y"><a href="a.html"><a href="a.html?q=1#x">')
    assert build.broken(tmp_path) == ["a.html: b.html#z", "a.html: c.png"]


def test_an_erratum_of_a_notebook_becomes_a_box():
    text = "a\n\n> **Erratum E11.** One\n> two.\n\nb\n"
    title = "[E11](errata.md#e11-caption-of-fig-1-and-app-a-1)"
    box = f":::{{admonition}} Erratum {title}\n:class: warning\n\nOne\ntwo.\n:::\n"
    assert pages.inside(text) == f"a\n\n{box}\nb\n"
