"""Words between the project's files and the book: items, anchors, links, docstrings."""

import re

KINDS = {
    "Eqs.": "Eq.",
    "Thms": "Thm",
    "Defs.": "Def.",
    "Props.": "Prop.",
    "Cors.": "Cor.",
    "Figs.": "Fig.",
}
_NUMBER = r"\(?\d+\)?"
# One numbered item as the texts write it, or several of a kind: "Eqs. (7), (9) and (10)"
ITEM = re.compile(
    r"(?<![\w#\[/])(?:"
    rf"(?P<many>Eqs\.|Thms|Defs\.|Props\.|Cors\.|Figs\.) {_NUMBER}"
    rf"(?:(?:, and |, | and | to ){_NUMBER})*"
    r"|(?:Lemma|Def\.|Prop\.|Thm|Cor\.|Fig\.|Alg\.|Table) \d+|Eq\. \(\d+\)|App\. A\.\d"
    r"|[EB]\d+)(?![\w]|\.\d|\])"
)
# Where no link is written: code, mathematics, links, pictures, HTML, headings, rows of tables
KEPT = re.compile(
    r"```.*?```|`[^`]*`|\$\$.*?\$\$|\$[^$\n]*\$|\\begin\{.*?\\end\{[^}]*\}|!?\[[^\]]*\]\([^)\n]*\)"
    r"|<[^>\n]+>|^#[^\n]*$|^\|[^\n]*$|^ {4}[^\n]*$",
    re.DOTALL | re.MULTILINE,
)


def slug(heading: str) -> str:
    """The anchor of a heading, or of a fragment that JupyterLab made of one; no mathematics."""
    plain = re.sub(r"\$[^$]*\$|[`*]", "", heading.lower())
    return re.sub(r"[^\w()]+", "-", plain).strip("-")


def items(text: str) -> list[str]:
    """The numbered items that a text names, each in the singular."""
    found = []
    for match in ITEM.finditer(text):
        many = match["many"]
        numbers = re.findall(_NUMBER, match[0]) if many else [None]
        found += [f"{KINDS[many]} {number}" if many else match[0] for number in numbers]
    return found


def linked(text: str, target, form="[{}]({})") -> str:
    """A text whose items are links: target(item) is an address, or None for no link.

    form: how a link is written, of its words and its address, as in Markdown."""

    def link(words, item):
        address = target(item)
        return form.format(words, address) if address else words

    def one(match):
        many = match["many"]
        if not many:
            return link(match[0], match[0])
        kind = KINDS[many]
        rest = match[0][len(many) :]
        return many + re.sub(_NUMBER, lambda n: link(n[0], f"{kind} {n[0]}"), rest)

    pieces, at = [], 0
    for kept in KEPT.finditer(text):
        pieces += [ITEM.sub(one, text[at : kept.start()]), kept[0]]
        at = kept.end()
    return "".join(pieces) + ITEM.sub(one, text[at:])


def restructured(lines, target) -> list[str]:
    """A docstring of ours as reStructuredText, its items links; it has no other markup.

    lines: of the docstring.  `Names` in backticks become code; examples stay; a paragraph with
    columns or indented lines is kept letter by letter."""
    found = []
    for paragraph in re.split(r"\n\s*\n", "\n".join(lines).strip("\n")):
        if paragraph.lstrip().startswith(">>>"):
            found += [*paragraph.split("\n"), ""]
            continue
        parts = re.split(r"(`[^`\n]+`)", paragraph)
        for k, part in enumerate(parts):
            plain = re.sub(r"([\\*|_`])", r"\\\1", part)
            parts[k] = f"`{part}`" if k % 2 else linked(plain, target, "`{} <{}>`__")
        inner = "".join(parts).split("\n")
        if "\n- " in f"\n{paragraph}":
            inner = [f"| {line}" for line in inner]
        elif re.search(r"\w {2,}(?<![.;:]  )\S|^ ", paragraph, re.MULTILINE):
            inner = ["::", "", *(f"    {line}" for line in paragraph.split("\n"))]
        found += [*inner, ""]
    return found
