"""The way in: one local address, and for every browser tab an `app.App` of its own.

Only this machine can connect, only who knows the token in the address, and only its own pages."""

import asyncio
import gc
import os
import secrets
import signal
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from urllib.parse import urlsplit

from aiohttp import WSMsgType, web
from trame_client.module import vue3

from .app import App

HOST = "127.0.0.1"
PORT, MORE = 8765, 30  # the port, and how many further ones are tried when it is taken
LOCAL = {"127.0.0.1", "localhost"}
MESSAGE = 2**24  # bytes, at most, from a browser
SWEEP = 0.5  # seconds after a tab was closed: then what is left of it is collected
STRANGER = (
    "this address is of no explorer that runs now: open the one that was printed last, "
    "or run the cell of the notebook again; what follows the ? may be put behind it"
)
os.environ.setdefault("TRAME_ARGS", "--server")  # trame must not read our command line


class Door:
    """A web server on the loopback interface: an app for every tab.

    surface, path: as of `Session`; nets: {key: (V, Q)} of nets that are given, each at the address
    net/KEY/index.html; guarded: whether requests for other hosts and from other sites are refused;
    framed: whether pages of other sites, such as notebooks, may show it in a frame.  All addresses
    begin with the token, which is new for every door: see `root`.
    """

    def __init__(self, surface=None, path=None, guarded=True, framed=False):
        self.options = {"surface": surface, "path": path}
        self.guarded, self.framed, self.port, self.nets, self.tabs = (
            guarded,
            framed,
            None,
            {},
            set(),
        )
        self.token = secrets.token_urlsafe(16)
        self._runner = self._www = self._sweep = None

    @property
    def root(self):
        """The address of the explorer, where the door is open."""
        return f"http://{HOST}:{self.port}/{self.token}/"

    async def open(self, port=None):
        """Listen: the port, or OSError.  None: the usual one, or the next that is free; 0: any."""
        application = web.Application(middlewares=[self._guard])
        pages = App("pages")
        pages.server.enable_module(vue3)
        self._www = Path(pages.server._www)
        folders = {k: x if isinstance(x, str) else x[0] for k, x in pages.server.serve.items()}
        pages.close()
        top = f"/{self.token}"
        routes = [
            web.get(f"{top}/", self._index),
            web.get(f"{top}/ws", self._tab),
            web.get(f"{top}/net/{{key}}/ws", self._tab),
            web.get(f"{top}/net/{{key}}/index.html", self._net),
            web.get(f"{top}/net/{{key}}/{{rest:.+}}", _up),
            *(web.static(f"{top}/{name}", folder) for name, folder in folders.items()),
            web.static(top, self._www),
        ]
        application.add_routes(routes)
        if not self.framed:
            application.on_response_prepare.append(_unframed)
        self._runner = web.AppRunner(application, access_log=None, shutdown_timeout=2)
        await self._runner.setup()
        for candidate in [port] if port is not None else [*range(PORT, PORT + MORE), 0]:
            try:
                await web.TCPSite(self._runner, HOST, candidate).start()
                break
            except OSError:
                if port is not None:
                    await self._runner.cleanup()
                    raise
        self.port = self._runner.addresses[0][1]
        return self.port

    async def close(self):
        """End all tabs, and listen no more."""
        for app, socket in list(self.tabs):
            app.session.stop()
            await socket.close()
        if self._runner is not None:
            await self._runner.cleanup()

    async def _index(self, request):
        query = f"?{request.query_string}" if request.query_string else ""
        raise web.HTTPFound(f"index.html{query}")

    async def _net(self, request):
        self._known(request)
        return web.FileResponse(self._www / "index.html")

    def _known(self, request):
        key = request.match_info["key"]
        if key not in self.nets:
            raise web.HTTPNotFound(text="this net is gone: run the cell of the notebook again")
        return self.nets[key]

    @web.middleware
    async def _guard(self, request, handler):
        """Refuse other hosts (rebound names), other sites (their scripts), and other tokens."""
        origin = request.headers.get("Origin", f"http://{request.host}")
        try:
            site, host = urlsplit(origin).netloc, urlsplit(f"//{request.host}").hostname
        except ValueError:
            site = host = None
        if self.guarded and (host not in LOCAL or site != request.host):
            raise web.HTTPForbidden(text="only pages of this address are served, on this machine")
        if request.path == "/favicon.ico":  # browsers ask for it at the top
            return web.Response(status=204)
        token = request.path.split("/")[1].encode()
        if not secrets.compare_digest(token, self.token.encode()):
            raise web.HTTPForbidden(text=STRANGER)
        if request.method == "POST":  # trame's page looks for a launcher: there is none
            return web.Response(status=204)
        return await handler(request)

    async def _tab(self, request):
        """A browser tab: its app lives as long as the connection."""
        net = self._known(request) if "key" in request.match_info else None
        socket = web.WebSocketResponse(max_msg_size=MESSAGE, heartbeat=30)
        await socket.prepare(request)
        app = App(secrets.token_hex(16), net=net, **self.options)
        entry = app, socket
        self.tabs.add(entry)
        try:
            await _talk(app.server, socket)
        finally:
            self.tabs.discard(entry)
            app.close()
            if self._sweep is not None:
                self._sweep.cancel()
            # Apps and servers know each other: only the collector finds them.
            self._sweep = asyncio.get_running_loop().call_later(SWEEP, gc.collect)
        return socket


async def _talk(server, socket):
    """Run a trame server for one browser, until it goes away."""
    task = server.start(backend="generic", exec_mode="task")
    await server.ready
    endpoint = server._server.ws
    refuse = endpoint.sendWrappedError

    async def briefly(number, code, message, data=None, client_id=None):
        await refuse(number, code, message, None, client_id)  # without traces and their paths

    endpoint.sendWrappedError = briefly
    connection = await endpoint.connect()

    async def forward(binary, content):
        with suppress(ConnectionResetError):  # the tab may just be closing
            if not socket.closed:
                await (socket.send_bytes if binary else socket.send_str)(content)

    connection.on_message(forward)
    try:
        async for message in socket:
            await connection.send(message.type == WSMsgType.BINARY, message)
    finally:
        await connection.close()
        await server.stop()
        await task


async def _unframed(request, response):
    """Other sites show no page in a frame, where a person could be led to click."""
    response.headers["Content-Security-Policy"] = "frame-ancestors 'self'"


async def _up(request):
    """The files of a given net's page are those of the explorer."""
    rest = request.match_info["rest"]
    raise web.HTTPFound("../" * (rest.count("/") + 2) + rest)


def serve(
    surface=None, path=None, port: int | None = None, ready: Callable = print, net=None
) -> None:
    """Serve until Ctrl-C or SIGTERM; ready(address) is called once.

    surface, path: `io.Surface` of a file and its name, or None; port as of `Door.open`; net: as
    of `Session`, to be shown instead."""

    async def run():
        door, end = Door(surface, path), asyncio.Event()
        door.nets |= {"file": net} if net else {}
        await door.open(port)
        for number in (signal.SIGINT, signal.SIGTERM):
            with suppress(NotImplementedError):  # on Windows Ctrl-C is a KeyboardInterrupt
                asyncio.get_running_loop().add_signal_handler(number, end.set)
        try:
            ready(door.root + "net/file/index.html" * bool(net))
            await end.wait()
        finally:
            await door.close()

    asyncio.run(run())
