"""The lectures of the book and their slides: minutes add up, what they name is there."""

import re
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from inetlib import exercises

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "book"))
import pages  # noqa: E402
import scenes  # noqa: E402
import slides  # noqa: E402
import walk  # tools/walk.py  # noqa: E402
import wording  # noqa: E402

PLANS = {"lectures_two": 2, "lectures_six": 6}
TEXTS = {name: (ROOT / "book" / f"{name}.md").read_text(encoding="utf-8") for name in PLANS}


@pytest.mark.parametrize("name", PLANS)
def test_the_minutes_of_each_lecture_add_up_to_90(name):
    found = {}
    for lecture, start, stop, *_ in walk.parts(name):
        found.setdefault(lecture, []).append((start, stop))
    assert len(found) == PLANS[name]
    for heading, times in found.items():
        assert len(times) >= 5, heading
        assert times[0][0] == 0 and times[-1][1] == 90, heading
        assert all(a[1] == b[0] for a, b in pairwise(times)), heading
        assert all(5 <= end - start <= 25 for start, end in times), heading


@pytest.mark.parametrize("name", PLANS)
def test_every_heading_that_a_lecture_shows_is_in_its_notebook(name):
    found = [link for *_, shown in walk.parts(name) for link in shown]
    assert len(found) > 20
    for notebook, mark in found:
        assert mark in map(wording.slug, pages.headings(notebook)), (notebook, mark)
    assert {x for x, _ in found} >= {x.stem for x in (ROOT / "notebooks").glob("[34568]*.ipynb")}


@pytest.mark.parametrize("name", PLANS)
def test_every_exercise_that_a_lecture_gives_exists(name):
    given = re.findall(r"Exercise\s+(\d+(?:\.\d+)+)", TEXTS[name])
    assert len(given) >= 8 and set(given) <= set(exercises.names())
    assert len(re.findall(r"Exercise\s+\d", TEXTS[name])) == len(given)


def test_each_part_of_the_two_lectures_says_something_and_shows_something():
    parts = re.split(r"(?m)^### ", TEXTS["lectures_two"])[1:]
    assert all("**Say:**" in part and "**Show:**" in part for part in parts)


@pytest.mark.parametrize("name", ["what", "where"])
def test_slides_have_pictures_nets_and_formulas_that_are_there(name):
    text = (ROOT / "book" / "slides" / f"{name}.md").read_text(encoding="utf-8")
    found = slides.slides(text)
    assert 12 <= len(found) <= 16
    assert all('<aside class="notes">' in slide and "<h" in slide for slide in found)
    whole = "\n".join(found)
    pictures = re.findall(r'src="\.\./_images/([^"]+)"', whole)
    files = {x.name for x in (ROOT / "figures").rglob("*.png")}
    assert len(pictures) > 6 and set(pictures) <= files
    nets = re.findall(r'data-scene="(\w+)"', whole)
    assert len(nets) >= 2 and set(nets) <= set(scenes.SCENES)
    assert "$" not in whole and whole.count('class="math') > 8
    given = re.findall(r"\d+\.\d+(?:\.\d+)?(?=[,<])", whole.partition("Exercises: ")[2])
    assert set(given) <= set(exercises.names())
    assert f'<a href="slides/{name}.html">' in TEXTS["lectures_two"]


def test_a_slide_is_markdown_with_formulas_left_to_mathjax():
    (one, two) = slides.slides("## A\n\n$a_1 < b_2$ & *c*\n\nNOTE: said\n---\n## B\n")
    assert r"\(a_1 &lt; b_2\)" in one and "<em>c</em>" in one
    assert one.endswith('<aside class="notes">said</aside></section>') and "aside" not in two
