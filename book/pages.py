"""The pages of the book, made of the project's files: nothing is written down twice."""

import ast
import functools
import html
import json
import pkgutil
import re
import shutil
from pathlib import Path
from typing import NamedTuple

import scenes
import wording

import inetlib

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
TEXTS = {"PAPER.md": "paper", "ERRATA.md": "errata", "CHANGELOG.md": "changelog"}
TEXTS |= {"CONTRIBUTING.md": "contributing", "README.md": "readme"}
SCENES = {  # which scenes stand below which figure
    "fig05": ["web"],
    "fig07": ["bending"],
    "fig08": ["squares"],
    "fig09": ["associate"],
    "fig10": ["stereographic"],
    "fig11": ["vase", "sphere"],
    "fig12": ["patch"],
    "fig13": ["hexagon", "inversion"],
}


class Row(NamedTuple):
    """A row of PAPER.md."""

    item: str
    says: str
    functions: list  # dotted names below inetlib
    tests: list  # file::function
    notebook: str  # its name without .ipynb
    heading: str  # what its heading names
    proof: str


@functools.cache
def rows() -> list[Row]:
    """The rows of both tables of PAPER.md."""
    found = []
    for line in (ROOT / "PAPER.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("|") and "`" in line:
            item, says, functions, tests, place, proof = (
                cell.strip() for cell in line.strip("|").split("|")
            )
            quoted = [re.findall(r"`([^`]+)`", cell) for cell in (functions, tests)]
            notebook, heading = re.match(r"\[(\w+)\]\([^)]*\), (.*)", place).groups()
            found.append(Row(item, says, *quoted, notebook, heading, proof))
    return found


@functools.cache
def errata() -> dict[str, tuple[str, str, str]]:
    """The errata of ERRATA.md: {number: (kind, heading, text)}."""
    found, kind = {}, ""
    for block in re.split(r"(?m)^(?=#)", (ROOT / "ERRATA.md").read_text(encoding="utf-8")):
        heading, _, text = block.partition("\n")
        if heading.startswith("# "):
            kind = heading[2:]
        elif match := re.match(r"## (E\d+) (.*)", heading):
            found[match[1]] = kind, heading[3:], text
    return found


@functools.cache
def claims() -> dict[str, Row]:
    """The rows by the items that they name."""
    return {name: row for row in rows() for name in wording.items(row.item) or [row.item]}


def address(item: str, depth: int = 0, ending: str = "md") -> str | None:
    """Where an item of the paper, of what is beyond it, or an erratum stands in the book.

    depth: how many folders deep the page is that links there."""
    up = "../" * depth
    if item in errata():
        return f"{up}errata.{ending}#{wording.slug(errata()[item][1])}"
    if item in claims():
        return f"{up}claims.{ending}#{wording.slug(title(claims()[item]))}"
    return None


def title(row: Row) -> str:
    """The heading of a row on the page of claims."""
    return f"{row.item}: {row.says}"


def inside(text: str, depth: int = 0) -> str:
    """Markdown of the project with its links to files of the project made those of the book."""
    up = "../" * depth

    def link(match):
        words, file, fragment = match[1], match[2], match[3]
        path = file.removeprefix("../")
        mark = f"#{wording.slug(fragment[1:])}" if fragment else ""
        if path in TEXTS:
            return f"[{words}]({up}{TEXTS[path]}.md{mark})"
        if path.endswith(".ipynb"):
            return f"[{words}]({up}notebooks/{Path(path).name}{mark})"
        if path.startswith("book/"):
            return f"[{words}]({up}{path.removeprefix('book/')}{mark})"
        if not file:
            return f"[{words}]({mark})"
        return words if words.startswith("`") else f"{words} (`{path}`)"

    text = re.sub(r"(?m)^> \*\*Erratum (E\d+)\.\*\* ((?:.*\n?)(?:^>.*\n?)*)", _box, text)
    text = re.sub(
        r"(?<!!)\[([^\]]+)\]\((?!\w+:)([^)#\s]*)(#[^()\s]*(?:\([^()\s]*\)[^()\s]*)*)?\)", link, text
    )
    return wording.linked(text, lambda item: address(item, depth))


def _box(match):
    """An erratum of a notebook as a box."""
    words = re.sub(r"(?m)^> ?", "", match[2]).rstrip()
    return f":::{{admonition}} Erratum {match[1]}\n:class: warning\n\n{words}\n:::\n"


# -- notebooks


@functools.cache
def headings(notebook: str) -> dict[str, str]:
    """The headings of a notebook with what they name, here or in small print below."""
    texts = [
        "".join(c["source"]) for c in stored(notebook)["cells"] if c["cell_type"] == "markdown"
    ]
    lines = [x for text in texts for x in text.splitlines() if x]
    following = zip(lines, [*lines[1:], ""], strict=True)
    small = [
        (x.lstrip("# "), y if y.startswith("<small>") else "") for x, y in following if x[0] == "#"
    ]
    return {heading: f"{heading} {below}" for heading, below in small}


def about(row: Row) -> list[str]:
    """The headings of its notebook that name a row."""
    wanted = re.compile(rf"(?<!\w){re.escape(row.heading)}(?!\w)")
    return [x for x, words in headings(row.notebook).items() if wanted.search(words)]


@functools.cache
def stored(notebook: str) -> dict:
    """A notebook as it is stored."""
    return json.loads((ROOT / "notebooks" / f"{notebook}.ipynb").read_text(encoding="utf-8"))


def place(row: Row, depth: int = 0) -> str:
    """A link to the heading of a notebook where a row is treated."""
    mark = f"#{wording.slug(about(row)[0])}" if about(row) else ""
    return f"[{row.notebook}]({'../' * depth}notebooks/{row.notebook}.ipynb{mark})"


def code(name: str) -> str:
    """A link to a function of the library on its page of the API."""
    return f"{{py:obj}}`{name} <inetlib.{name}>`"


@functools.cache
def module_of(name: str) -> str:
    """The module of a dotted name below inetlib, as a dotted name below inetlib."""
    while name not in modules():
        name = name.rpartition(".")[0]
    return name


@functools.cache
def modules() -> list[str]:
    """The public modules of the library, as dotted names below inetlib."""
    found = pkgutil.walk_packages(inetlib.__path__, "inetlib.")
    names = [module.name.removeprefix("inetlib.") for module in found]
    return [name for name in names if not any(part.startswith("_") for part in name.split("."))]


def check(test: str, depth: int = 0) -> str:
    """A link to a test, file::function."""
    file, _, name = test.partition("::")
    return f"[{name}]({'../' * depth}tests/{Path(file).stem}.md#{wording.slug(name)})"


def notebooks(folder: Path):
    """The notebooks as pages: links, words for pictures, scenes below their figures."""
    import nbformat

    folder.mkdir()
    for path in sorted((ROOT / "notebooks").glob("*.ipynb")):
        notebook = nbformat.read(path, as_version=4)
        cells = []
        for cell in notebook.cells:
            cells.append(cell)
            if cell.cell_type == "markdown":
                cell.source = _numbered(inside(cell.source, 1), path.stem)
                continue
            alts = [o.get("metadata", {}).get("image/png", {}).get("alt") for o in cell.outputs]
            cell.metadata["mystnb"] = {
                "image": {"alt": next(filter(None, alts), "see the caption")}
            }
            for tag in cell.metadata.get("tags", []):
                cells += [nbformat.v4.new_markdown_cell(scene(x, tag)) for x in SCENES.get(tag, [])]
        notebook.cells = cells
        nbformat.write(notebook, folder / path.name)


def _numbered(text, notebook):
    """Markdown with a line below each heading of a numbered item: its functions and its claim."""
    lines = []
    for line in text.splitlines():
        lines.append(re.sub(r"^#{4} (.*)", r"**\1**", line))  # a level below is no heading here
        if re.match(r"##+ ", line):
            here = [row for row in rows() if row.notebook == notebook]
            here = [row for row in here if line.lstrip("# ") in about(row)]
            if here:
                names = dict.fromkeys(name for row in here for name in row.functions[:3])
                links = [f"[{row.item}]({address(row.item, 1)})" for row in here]
                links += [code(name) for name in names]
                lines += ["", "{.in-the-book}", " \u00b7 ".join(links), ""]
    return "\n".join(lines)


def scene(name: str, still: str) -> str:
    """A scene as HTML; its figure stays where there is no WebGL.  The page is one folder deep."""
    words = html.escape(scenes.SCENES[name][1])
    picture = f'<img src="../_images/{still}.png" alt="{words}">'
    return f'<div class="scene" data-scene="{name}">{picture}</div>'


# -- tests, API


def tests(folder: Path):
    """The tests that PAPER.md and ERRATA.md name, one page a file."""
    folder.mkdir()
    named = {test for row in rows() for test in row.tests}
    text = (ROOT / "ERRATA.md").read_text(encoding="utf-8")
    named |= {f"test_errata.py::{name}" for name in re.findall(r"`(test_\w+)`", text)}
    files = sorted({test.partition("::")[0] for test in named})
    for file in files:
        text = (ROOT / "tests" / file).read_text(encoding="utf-8")
        lines = text.splitlines()
        page = [
            f"# `tests/{file}`",
            "",
            "The tests that the table of the paper, or the errata, name.",
        ]
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef) and f"{file}::{node.name}" in named:
                first = min([node.lineno, *(x.lineno for x in node.decorator_list)])
                about = [row.item for row in rows() if f"{file}::{node.name}" in row.tests]
                about += [n for n, (_, _, x) in errata().items() if f"`{node.name}`" in x]
                links = ", ".join(f"[{item}]({address(item, 1)})" for item in about)
                body = lines[first - 1 : node.end_lineno]
                page += ["", f"## {node.name}", "", links, "", "```python", *body, "```"]
        (folder / f"{Path(file).stem}.md").write_text("\n".join(page) + "\n", encoding="utf-8")
    _index(
        folder,
        "Tests",
        "What the tests named in this book consist of.",
        [Path(f).stem for f in files],
    )


def _index(folder, heading, words, names):
    """A page that lists pages of a folder."""
    listed = ["```{toctree}", ":maxdepth: 1", "", *names, "```"]
    text = "\n".join([f"# {heading}", "", words, "", *listed])
    (folder / "index.md").write_text(text + "\n", encoding="utf-8")


def api(folder: Path):
    """One page a module: its functions with their sources, and where they are proved and tested."""
    folder.mkdir()
    sources = {
        p.name: p.read_text(encoding="utf-8") for p in sorted((ROOT / "tests").glob("test_*.py"))
    }
    for name in modules():
        lines = [
            f"# {name}",
            "",
            "```{eval-rst}",
            f".. automodule:: inetlib.{name}",
            "   :members:",
            "```",
            "",
        ]
        here = [row for row in rows() if any(module_of(x) == name for x in row.functions)]
        if here:
            lines += [
                "## In the paper",
                "",
                "| item | functions | notebook | tests |",
                "|---|---|---|---|",
            ]
        for row in here:
            names = [code(x) for x in row.functions if module_of(x) == name]
            told = [check(x, 1) for x in row.tests]
            link = f"[{row.item}]({address(row.item, 1)})"
            lines.append(f"| {link} | {', '.join(names)} | {place(row, 1)} | {', '.join(told)} |")
        short = name.rpartition(".")[2]
        used = re.compile(rf"(?<!\w){short}\b")
        books = [x for x in _names() if used.search(_code(x))]
        files = [file for file, text in sources.items() if used.search(text)]
        lines += ["", "## Where it is used", ""]
        lines.append(
            "Notebooks: "
            + (", ".join(f"[{x}](../notebooks/{x}.ipynb)" for x in books) or "none")
            + "."
        )
        lines += ["", "Tests: " + (", ".join(f"`{x}`" for x in files) or "none") + "."]
        (folder / f"{name}.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    words = "The library, module after module; each function has its source."
    _index(folder, "The library", words, modules())


def _names():
    return [path.stem for path in sorted((ROOT / "notebooks").glob("*.ipynb"))]


@functools.cache
def _code(notebook):
    cells = stored(notebook)["cells"]
    return "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "code")


# -- the paper and its claims


def table(text: str) -> str:
    """PAPER.md with every function, test and heading a link."""
    lines = []
    for line in text.splitlines():
        row = next((row for row in rows() if line.startswith(f"| {row.item} | {row.says} |")), None)
        if row:
            told = ", ".join(check(x) for x in row.tests)
            names = ", ".join(code(x) for x in row.functions)
            link = f"[{row.item}]({address(wording.items(row.item)[0])})"
            cells = link, row.says, names, told, f"{place(row)}, {row.heading}", row.proof
            line = f"| {' | '.join(cells)} |"
        lines.append(line)
    return "\n".join(lines) + "\n"


GROUPS = {
    "Equations": ("Eq.",),
    "Lemma, definitions, propositions, theorems, corollaries": (
        "Lemma",
        "Def.",
        "Prop.",
        "Thm",
        "Cor.",
    ),
    "Figures": ("Fig.",),
    "Algorithm and table": ("Alg.", "Table"),
    "Appendix": ("App.",),
    "Beyond the paper": ("B",),
}
SAID = {
    "Misprints": "misprint",
    "Conditions that are missing": "holds with a condition",
    "Readings": "reading",
}


def faults(row: Row) -> dict[str, list[str]]:
    """The errata that name the item of a row in their headings: {what they are: [numbers]}."""
    found = {}
    for number, (kind, heading, _) in errata().items():
        if set(wording.items(heading)) & set(wording.items(row.item)):
            found.setdefault(SAID[kind], []).append(number)
    return found


def status(row: Row) -> list[str]:
    """What is known of a row, in words: how it is proved or checked, and what its errata are."""
    said = []
    if "symbols" in row.proof:
        said.append("proved by sympy")
    if cases := re.search(r"(\d+) random", row.proof):
        tolerance = tolerances(tuple(row.tests))
        within = f" within {tolerance}" if tolerance else ""
        said.append(f"checked numerically{within} over {cases[1]} random cases")
    if "nets" in row.proof:
        said.append(
            "checked on nets"
            + (f": {m[1]}" if (m := re.search(r"nets: ([^;]*)", row.proof)) else "")
        )
    if "drawing" in row.proof:
        said.append("drawn, and the drawing checked")
    if "rerun" in row.proof:
        said.append("rerun")
    return said


@functools.cache
def tolerances(tests: tuple) -> str:
    """The coarsest tolerance that the tests compare with, such as 1e-9; or no text."""
    found = []
    for test in tests:
        file, _, name = test.partition("::")
        tree = ast.parse((ROOT / "tests" / file).read_text(encoding="utf-8"))
        node = next(x for x in tree.body if getattr(x, "name", "") == name)
        limits = [x for n in ast.walk(node) if isinstance(n, ast.Compare) for x in n.comparators]
        limits += [
            n.value
            for n in ast.walk(node)
            if isinstance(n, ast.keyword) and n.arg in ("atol", "rtol", "abs", "rel")
        ]
        found += [
            x.value for x in limits if isinstance(x, ast.Constant) and isinstance(x.value, float)
        ]
    small = [x for x in found if 0 < x <= 1e-3]
    return f"{max(small):.0e}".replace("e-0", "e-") if small else ""


def claimed() -> str:
    """The page of claims: all items with what is known of them, counted at the top."""
    page = ["# What the paper claims, and what we found", ""]
    page += [
        "Every numbered item, where it is computed, shown and tested. This page is made of",
        "[the table of the paper](paper.md) and [the errata](errata.md).",
        "",
    ]
    counts, body = [], []
    for group, kinds in GROUPS.items():
        here = [row for row in rows() if row.item.startswith(kinds)]
        numbers = [item for row in here for item in (wording.items(row.item) or [row.item])]
        shown = {
            "proved": sum("symbols" in row.proof for row in here),
            "checked": sum("random" in row.proof for row in here),
            "nets": sum("nets" in row.proof for row in here),
            "drawn": sum("drawing" in row.proof for row in here),
            **{what: sum(what in faults(row) for row in here) for what in SAID.values()},
        }
        last = max(
            (int(n) for n in re.findall(r"\d+", " ".join(numbers)) if kinds[0] != "App."), default=0
        )
        of = f" of {last}" if len(numbers) == last else ""
        counts.append(
            f"| {group} | {len(numbers)}{of} | " + " | ".join(map(str, shown.values())) + " |"
        )
        body += ["", f"## {group}"]
        for row in here:
            said = status(row)
            said += [
                f"{what} ({', '.join(f'[{n}]({address(n)})' for n in names)})"
                for what, names in faults(row).items()
            ]
            body += ["", f"### {title(row)}", "", f"**Status:** {'; '.join(said)}.", ""]
            body.append("**Library:** " + ", ".join(code(x) for x in row.functions) + ".  ")
            body.append(f"**Notebook:** {place(row)}.  ")
            body.append("**Tests:** " + ", ".join(check(x) for x in row.tests) + ".")
            if match := re.match(r"Fig\. (\d+)", row.item):
                body.append(f"  \n**Figure:** [as drawn here](figures/fig{int(match[1]):02}.md).")
    columns = "items", "proved by sympy", "random cases", "nets", "drawn", "misprint"
    columns += "needs a condition", "two readings"
    page.append(f"| | {' | '.join(columns)} |")
    page += ["|---|" + "---:|" * 8, *counts, "", "An item may stand in several columns."]
    return "\n".join([*page, *body]) + "\n"


def gallery(source: Path):
    """The page of nets worth a poster, each with the lines that make it."""
    folder = ROOT / "figures" / "gallery"
    shutil.copytree(folder, source / "gallery_pictures")
    page = [
        "# Twelve nets",
        "",
        "Each is made by the lines below it, with `inetlib` and numpy.",
        "",
    ]
    for name, net in json.loads((folder / "gallery.json").read_text(encoding="utf-8")).items():
        off = "exact" if net["exact"] else f"off by at most {net['deviation_deg']:.2g} degrees"
        angles = f"$\\theta = {net['theta_deg']:.4g}\u00b0$"
        angles += f", $\\theta_0 = {net['theta0_deg']:.4g}\u00b0$, {off}"
        page += ["", f"## {net['title']}", "", f"![{net['sentence']}](gallery_pictures/{name}.png)"]
        page += ["", f"{net['sentence']} {net['quads']} quads; {angles}."]
        page += ["", "```python", net["imports"].rstrip() + "\n", "", net["lines"].rstrip(), "```"]
    (source / "gallery.md").write_text("\n".join(page) + "\n", encoding="utf-8")


def write(source: Path):
    """Write all pages into a folder."""
    for page in HERE.glob("*.md"):
        text = wording.linked(page.read_text(encoding="utf-8"), address)
        (source / page.name).write_text(text, encoding="utf-8")
    for file, name in TEXTS.items():
        text = (ROOT / file).read_text(encoding="utf-8")
        text = table(inside(text)) if file == "PAPER.md" else inside(text)
        text = re.sub(r"`(test_e\d+_\w+)`", lambda m: check(f"test_errata.py::{m[1]}"), text)
        (source / f"{name}.md").write_text(text, encoding="utf-8")
    (source / "claims.md").write_text(claimed(), encoding="utf-8")
    gallery(source)
    import figures  # it needs this module

    figures.write(source / "figures")
    notebooks(source / "notebooks")
    tests(source / "tests")
    api(source / "api")
