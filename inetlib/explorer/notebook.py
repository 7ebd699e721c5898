"""The explorer in a notebook: live for a person, a picture where a tool runs the notebook."""

import asyncio
import base64
import os
import secrets
import sys
import threading

import numpy as np

from .. import mesh
from .. import view as shaded
from . import choices
from .session import Session

MISSING = "the explorer needs packages of the extra `view`: pip install -e '.[view]'"
TOP, ROUND = (-np.pi / 2, np.pi / 2), (-0.9, 0.45)  # azimuth and elevation of pictures
_lock = threading.Lock()
_door = None


class Live:
    """A page in a notebook's output, and the picture that is left of it elsewhere.

    Where the page cannot be had, because the kernel has ended or the notebook is only read,
    the browser shows the picture.
    """

    def __init__(self, address, picture, height):
        self.address, self.picture, self.height = address, picture, height

    def _repr_mimebundle_(self, include=None, exclude=None):
        data = base64.b64encode(self.picture).decode()
        image = f'<img alt="the net" style="max-width: 100%" src="data:image/png;base64,{data}">'
        style = f"width: 100%; height: {self.height}px; border: 1px solid #8888"
        page = f'<object type="text/html" data="{self.address}" style="{style}">{image}</object>'
        return {"text/html": page, "image/png": data, "text/plain": self.address}


def show(height=640, live=None, **values):
    """The explorer in a notebook: `explorer.show(kind="revolution", theta=75, theta0=60)`.

    values: those of `choices.Choice`, angles in degrees; ValueError for what is no such value.
    live: True, False, or by default True where a person runs the notebook.  Returns a `Live`
    page, or a still IPython Image.
    """
    session = Session()
    if problems := session.change(**values):
        raise ValueError("; ".join(problems))
    if session.must_search:
        session.search(session.begin())
    else:
        session.construct()
    if session.V is None:
        raise ValueError(session.problem)
    picture = session.save(".png", *(ROUND if session.V[:, 2].any() else TOP))
    if not (person() if live is None else live):
        from IPython.display import Image

        return Image(data=picture, format="png", width=640)
    address = f"{_address(_open_door().port)}index.html?{choices.link(session.choice)}"
    return Live(address, picture, height)


def show_net(V, Q, families=("u", "v"), sight=ROUND, height=480, picture=None):
    """A net as a `Live` page of a notebook, with the numbers of the explorer beside it.

    V: (n, 3), Q: (f, 4); families: names; sight: azimuth and elevation of the still picture,
    radians; picture: another one, PNG bytes.  ValueError for arrays that are no net and for
    names of no family.
    """
    session = Session(net=(V, Q))
    if problems := session.change(families=families):
        raise ValueError("; ".join(problems))
    picture = picture or session.save(".png", *sight)
    query = "?families=" + ",".join(session.choice.families)
    door, key = _open_door(), secrets.token_hex(8)
    door.nets[key] = session.V, session.Q
    return Live(f"{_address(door.port)}net/{key}/index.html{query}", picture, height)


def turn(V, Q, families=None, colours=None, width=0.0035, view=(-1.0, 0.5), live=None):
    """The shaded `view.scene` of a net in a notebook, to be turned by hand, or as a still picture.

    live: True, False, or by default True where a person runs the notebook: then the net is a
    page that the browser draws, with the families that have curves, in its own colours and
    widths, and `show_net` has the picture.  A notebook that a tool runs keeps the picture.
    """
    drawn = V, Q, families, colours, width, view
    if not (person() if live is None else live):
        return shaded.show(*drawn, live=False)
    names = mesh.Families._fields
    if families is not None:
        names = [name for name in names if len(getattr(families, name))]
    picture = shaded.png(*drawn) if shaded.available()[0] else None
    return show_net(V, Q, names, view, picture=picture)


def person():
    """Whether somebody runs this notebook by hand: a kernel of a Jupyter server has a name."""
    return "ipykernel" in sys.modules and "JPY_SESSION_NAME" in os.environ


def _address(port):
    """Where the browser of a notebook finds a port of this machine."""
    hub = os.environ.get("JUPYTERHUB_SERVICE_PREFIX")
    return f"{hub}proxy/{port}/" if hub else f"http://127.0.0.1:{port}/"


def _open_door():
    """One server a process, in a thread of its own, that ends with the process."""
    global _door
    with _lock:
        if _door is None:
            try:
                from .serve import Door
            except ImportError as error:
                raise ImportError(MISSING) from error
            guarded = "JUPYTERHUB_SERVICE_PREFIX" not in os.environ  # the hub is a guard itself
            door, loop = Door(guarded=guarded), asyncio.new_event_loop()
            threading.Thread(target=loop.run_forever, daemon=True).start()
            asyncio.run_coroutine_threadsafe(door.open(0), loop).result(60)
            _door = door
    return _door
