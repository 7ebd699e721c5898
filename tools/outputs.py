"""Whether a cell that was run again shows what is stored below it, within tolerances.

Text may differ by one unit of the last digit it shows, pictures by a little in their tones (see
`inetlib.drawings.same`).  Two tags of a cell say that more may differ, and why:
  timing   seconds differ from run to run: what is stored stays
  view     OpenGL draws otherwise on every graphics card: pictures need only look alike"""

import base64
import os
import re
from importlib.metadata import version
from pathlib import Path

import matplotlib

from inetlib import publish, view
from inetlib.drawings import same

ROOT = Path(__file__).resolve().parent.parent
PINNED = (  # another matplotlib than that of constraints.txt draws otherwise
    f"\nmatplotlib=={version('matplotlib')}\n" in (ROOT / "constraints.txt").read_text("utf-8")
)
ALIKE = 255, 0.005  # levels and mean for pictures by OpenGL


def environment(folder):
    """What a kernel needs to draw alike for everybody; folder: an empty one, for its settings."""
    own = os.environ | {
        "IPYTHONDIR": str(folder),
        "MATPLOTLIBRC": matplotlib.get_data_path(),
        "MPLBACKEND": "module://matplotlib_inline.backend_inline",
    }
    # JPY_SESSION_NAME says that a person looks on; where figures go is for the caller to say.
    for name in ("PYTHONSTARTUP", "JPY_SESSION_NAME", publish.FOLDER):
        own.pop(name, None)
    return own


def tags(cell):
    """The tags of a cell, none for most."""
    return cell.metadata.get("tags", [])


def kept(stored, fresh, looks=same.FEW):
    """Whether the outputs of the stored cell can stay, in the light of a fresh run of it.

    looks: levels and mean, see `same.picture`."""
    if "timing" in tags(fresh) and stored.outputs:
        return True
    if "view" in tags(fresh) and stored.outputs and not view.available()[0]:
        return True  # what this machine cannot draw
    old, new = shown(stored), shown(fresh)
    looks = ALIKE if "view" in tags(fresh) else looks
    return len(old) == len(new) and all(_same(a, b, looks) for a, b in zip(old, new, strict=True))


def shown(cell):
    """What a cell shows: (kind, content) pairs, streams in one piece, no warnings of OpenGL."""
    found = []
    for output in cell.outputs:
        if output.output_type == "stream":
            if "view" in tags(cell) and output.name == "stderr":
                continue
            if found and found[-1][0] == output.name:  # one print may be stored in several pieces
                found[-1] = output.name, found[-1][1] + output.text
            else:
                found.append((output.name, output.text))
        elif output.output_type == "error":
            found.append(("error", "\n".join(output.traceback)))
        else:
            drawn = "image/png" in output.data  # the text beside it says what it shows: `describe`
            found += sorted(
                (k, x) for k, x in output.data.items() if k != "text/plain" or not drawn
            )
    return found


def caption(below):
    """The sentence in italics at the top of the Markdown below a picture, as plain words, or ""."""
    found = re.match(r"\*(\w[^*]+[.])\*(\n|$)", below)
    words = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", found[1] if found else "")  # of a link
    words = re.sub(r"\^\\circ|\\degree", " degrees", words).replace("\\sqrt", "root ")
    return re.sub(r"\\[, ]?|[${}`]", "", words)


def describe(cell, below):
    """Give the pictures of a cell words: their alternative text or, where they have none, the
    caption `below`.

    Stored twice: as "alt" of image/png, which books by myst-nb and HTML by nbconvert read out
    (`--template classic`; its default template does not), and in the place of "<Figure ...>", for
    whoever shows text only.  JupyterLab and GitHub read out neither, but the caption."""
    for output in cell.outputs:
        if "image/png" in output.get("data", {}):
            about = output.metadata.setdefault("image/png", {})
            if words := about.get("alt") or caption(below):
                about["alt"] = output.data["text/plain"] = words


def few_tones(picture):
    """A PNG in base64 as it is stored: see `same.few_tones`."""
    return base64.b64encode(same.few_tones(base64.b64decode(picture))).decode()


def _same(old, new, looks):
    (kind, one), (other, two) = old, new
    if kind != other:
        return False
    if kind == "image/png":
        return same.picture(*map(base64.b64decode, (one, few_tones(two))), *looks)
    return same.text(one, two) if isinstance(one, str) and isinstance(two, str) else one == two
