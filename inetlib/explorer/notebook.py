"""The explorer in a notebook: live for a person, a picture where a tool runs the notebook."""

import asyncio
import base64
import os
import secrets
import sys
import threading
from typing import Any, NamedTuple

import numpy as np

from .. import mesh
from .. import view as shaded
from ..drawings import same
from . import choices
from .session import Session

MISSING = "the explorer needs packages of the extra `view`: pip install -e '.[view]'"
GONE = (
    'No live view here: run the cell again, or open <a href="{0}" target="_blank">its page</a> '
    "in a browser of this machine while the kernel runs (README.md: JupyterLab elsewhere)."
)
TOP, ROUND = (-np.pi / 2, np.pi / 2), (-0.9, 0.45)  # azimuth and elevation of pictures
KEPT = 100  # nets that are given: for more the oldest are forgotten
_lock = threading.Lock()
_door = None
_shown: dict = {}  # {key of a net: what `_cell` said when it was given}


class Live(NamedTuple):
    """A page in a notebook's output, or its picture: the kernel may have ended."""

    address: str
    picture: bytes
    height: int

    def _repr_mimebundle_(self, include=None, exclude=None):
        data = base64.b64encode(self.picture).decode()
        image = f'<img alt="the net" style="max-width: 100%" src="data:image/png;base64,{data}">'
        style = f"width: 100%; height: {self.height}px; border: 1px solid #8888"
        still = f"{image}<p>{GONE.format(self.address)}</p>"
        page = f'<object type="text/html" data="{self.address}" style="{style}">{still}</object>'
        return {"text/html": page, "image/png": data, "text/plain": self.address}


def show(height: int = 640, live: bool | None = None, **values: object) -> Any:
    """The explorer in a notebook: `explorer.show(kind="revolution", theta=75, theta0=60)`.

    values: those of `choices.Choice`, angles in degrees, else ValueError.  live: a `Live` page,
    or a still IPython Image; by default live where a person runs the notebook and can have it."""
    session = Session()
    _change(session, **values)
    if session.must_search:
        session.search(session.begin())
    else:
        session.construct()
    if session.V is None:
        raise ValueError(session.problem)
    picture = session.save(".png", *(ROUND if session.V[:, 2].any() else TOP))
    if not (_possible() if live is None else live):
        return _still(picture, width=640)
    address = f"{_address(_open_door())}index.html?{choices.link(session.choice)}"
    return Live(address, picture, height)


def turn(
    V: np.ndarray,
    Q: np.ndarray,
    families: mesh.Families | None = None,
    colours: dict | None = None,
    width: float = 0.0035,
    view: tuple = (-1.0, 0.5),
    live: bool | None = None,
) -> Any:
    """The `view.scene` of a net for a reader, to be turned by hand, or as a still IPython Image.

    live: by default where there is a person: in JupyterLab as a `Live` page that the browser draws
    in its own colours and widths, in a script with a display as a window.  ValueError for arrays
    that are no net."""
    notebook = "ipykernel" in sys.modules
    if live is None:
        live = _possible() if notebook else not shaded.headless()
    if live and not notebook:
        return shaded.scene(V, Q, families, colours, width, view, live=True).show()
    picture = None
    if shaded.available()[0] or not (live or person()):  # pages, and pictures of them, need none
        scene = shaded.scene(V, Q, families, colours, width, view)
        picture = same.few_tones(shaded.picture(scene), tones=(192,))
    if picture and not live:
        return _still(picture)
    session = Session(net=(V, Q))
    drawn = mesh.polylines(session.Q) if families is None else families
    _change(session, families=[name for name, lines in drawn._asdict().items() if len(lines)])
    picture = picture or session.save(".png", *view)
    if not live:
        return _still(picture, width=640)
    door, key = _open_door(), secrets.token_hex(8)
    _forget(door, *_cell())
    door.nets[key], _shown[key] = (session.V, session.Q), _cell()
    query = "families=" + ",".join(session.choice.families)
    address = f"{_address(door)}net/{key}/index.html?{query}"
    return Live(address, picture, height=480)


def _cell():
    """The cell that runs, those that were deleted, and this run: None and () where nobody says."""
    from IPython import get_ipython

    parent = getattr(get_ipython(), "get_parent", dict)()
    about = parent.get("metadata", {})
    gone = tuple(about.get("deletedCells", ()))
    return about.get("cellId"), gone, parent.get("header", {}).get("msg_id")


def _forget(door, cell, gone, run):
    """Release the nets of former runs of a cell, those of cells that are gone, and the oldest."""
    for key, (other, _, former) in list(_shown.items()):
        again = other is not None and (other in gone or (other == cell and former != run))
        if again or len(door.nets) >= KEPT:
            del _shown[key]
            door.nets.pop(key, None)


def in_the_round(V: np.ndarray, Q: np.ndarray, view: tuple = (-0.9, 0.35)) -> Any:
    """`turn` with the u- and v-curves only; a sentence for a reader where no picture can be made.

    view: azimuth and elevation.  For cells tagged `view`, see tools/outputs.py."""
    works, sentence = shaded.available()
    if not (works or person()):
        return sentence
    return turn(V, Q, mesh.polylines(Q)._replace(d1=[], d2=[]), width=0.006, view=view)


def _change(session, **values):
    if problems := session.change(**values):
        raise ValueError("; ".join(problems))


def _still(picture, width=None):
    from IPython.display import Image

    return Image(data=picture, format="png", width=width)


def person() -> bool:
    """Whether somebody runs this notebook by hand, in JupyterLab or in VS Code.

    A kernel of a Jupyter server has a name; VS Code puts the notebook's among its variables."""
    if "ipykernel" not in sys.modules:
        return False
    from IPython import get_ipython

    shell = get_ipython()
    return "JPY_SESSION_NAME" in os.environ or "__vsc_ipynb_file__" in getattr(shell, "user_ns", ())


def _possible():
    """Whether there is a person who can have a live page; who lacks its packages is told so."""
    if not person():
        return False
    try:
        server()
    except ImportError as error:
        print(f"a still picture: {error}")
        return False
    return True


def _proxy():
    """The path below which a Jupyter server hands on ports of its machine, or "".

    That of a hub, or INETLIB_PROXY, for jupyter-server-proxy without one."""
    hub = os.environ.get("JUPYTERHUB_SERVICE_PREFIX")
    return os.environ.get("INETLIB_PROXY") or (f"{hub}proxy/" if hub else "")


def _address(door):
    """Where the browser of a notebook finds the door."""
    proxy = _proxy()
    return f"{proxy.rstrip('/')}/{door.port}/{door.token}/" if proxy else door.root


def server() -> Any:
    """The module `serve`, or an ImportError that says what it needs."""
    try:
        from . import serve
    except ImportError as error:
        raise ImportError(MISSING) from error
    return serve


def _open_door():
    """One server a process, in a thread of its own, that ends with the process."""
    global _door
    with _lock:
        if _door is None:
            guarded = not _proxy()  # which is a guard itself, and has another name
            door, loop = server().Door(guarded=guarded, framed=True), asyncio.new_event_loop()
            threading.Thread(target=loop.run_forever, daemon=True).start()
            asyncio.run_coroutine_threadsafe(door.open(0), loop).result(60)
            _door = door
    return _door
