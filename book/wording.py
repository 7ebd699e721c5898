"""Text between the project's files and the book: anchors, links, docstrings."""

import re

# Numbered items as the texts write them, one or several
ITEM = re.compile(
    r"(?<![\w#\[])(?:Eq\. \(\d+\)|(?:Lemma|Def\.|Prop\.|Thm|Cor\.|Fig\.|Alg\.|Table) \d+"
    r"|App\. A\.\d|[EB]\d+)(?![\w.]*\])"
)
# What no link is written into: code, mathematics, links, pictures, HTML
KEPT = re.compile(
    r"```.*?```|`[^`]*`|\$\$.*?\$\$|\$[^$\n]*\$|!?\[[^\]]*\]\([^)]*\)|<[^>\n]+>", re.DOTALL
)


def slug(heading: str) -> str:
    """The anchor of a heading, as JupyterLab and GitHub make it, in lower case."""
    heading = re.sub(r"[`*$\\{}]", "", heading)
    return re.sub(r"[^\w()-]+", "-", heading.lower()).strip("-")


def anchor(item: str) -> str:
    """The anchor of an item on the page of claims, such as eq-3 or app-a-1."""
    return re.sub(r"\W+", "-", item.lower()).strip("-")


def linked(text: str, target) -> str:
    """Markdown whose items are links: target(item) is an address, or None for no link.

    Headings, code, mathematics and what is a link stay as they are."""

    def link(match):
        address = target(match[0])
        return f"[{match[0]}]({address})" if address else match[0]

    lines = []
    for line in re.split(r"(?m)^(#.*|\|.*)$", text):
        if line.startswith("#"):
            lines.append(line)
            continue
        pieces, at = [], 0
        for kept in KEPT.finditer(line):
            pieces += [ITEM.sub(link, line[at : kept.start()]), kept[0]]
            at = kept.end()
        lines.append("".join(pieces) + ITEM.sub(link, line[at:]))
    return "".join(lines)
