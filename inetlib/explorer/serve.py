"""The way in: one local address, and for every browser tab an `app.App` of its own.

Only this machine can connect, and only pages from this address: requests that name another
host, or come from another site, are refused.  Nothing is read but the program's own pages.

Paper: Sec. 3-6 (explorer; beyond the paper).
"""

import asyncio
import os
import secrets
from urllib.parse import urlsplit

from aiohttp import WSMsgType, web

from .app import App

HOST = "127.0.0.1"
PORT, MORE = 8765, 30  # the port, and how many further ones are tried when it is taken
LOCAL = {"127.0.0.1", "localhost"}
MESSAGE = 2**24  # bytes, at most, from a browser
os.environ.setdefault("TRAME_ARGS", "--server")  # trame must not read our command line


class Door:
    """A web server on the loopback interface; `app(name)` makes the app of a tab."""

    def __init__(self, app=App, allowed=LOCAL):
        self.app, self.allowed, self.port = app, allowed, None
        self.tabs = set()
        self._runner = None

    async def open(self, port=None):
        """Listen: the port.  port None: the usual one, or the next that is free; 0: any.

        OSError when the port is taken.

        Paper: Sec. 3-6 (explorer).
        """
        application = web.Application(middlewares=[self._guard])
        pages = self.app(f"pages{secrets.token_hex(8)}")
        routes = [web.get("/", _index), web.get("/ws", self._tab)]
        folders = {f"/{name}": folder for name, folder in pages.server.serve.items()}
        pages.server.enable_module(_client())
        folders["/"] = pages.server._www
        pages.close()
        for name in sorted(folders, reverse=True):
            routes.append(web.static(name, _folder(folders[name])))
        application.add_routes(routes)
        self._runner = web.AppRunner(application, access_log=None, shutdown_timeout=2)
        await self._runner.setup()
        for candidate in [port] if port is not None else [*range(PORT, PORT + MORE), 0]:
            try:
                site = web.TCPSite(self._runner, HOST, candidate)
                await site.start()
                break
            except OSError:
                if port is not None:
                    raise
        self.port = site._server.sockets[0].getsockname()[1]
        return self.port

    async def close(self):
        """End all tabs, and listen no more.

        Paper: Sec. 3-6 (explorer).
        """
        for app, socket in list(self.tabs):
            app.session.stop()
            await socket.close()
        if self._runner is not None:
            await self._runner.cleanup()

    @web.middleware
    async def _guard(self, request, handler):
        """Refuse other hosts (rebound names) and other sites (their scripts)."""
        origin = request.headers.get("Origin")
        host = urlsplit(f"//{request.host}").hostname
        same = origin is None or urlsplit(origin).netloc == request.host
        if host not in self.allowed or not same:
            raise web.HTTPForbidden(text="only pages of this address are served, on this machine")
        return await handler(request)

    async def _tab(self, request):
        """A browser tab: its app lives as long as the connection."""
        socket = web.WebSocketResponse(max_msg_size=MESSAGE, heartbeat=30)
        await socket.prepare(request)
        app = self.app(secrets.token_hex(16), **_options(request))
        entry = app, socket
        self.tabs.add(entry)
        task = app.server.start(backend="generic", exec_mode="task")
        await app.server.ready
        connection = await app.server._server.ws.connect()

        async def forward(binary, content):
            if not socket.closed:
                await (socket.send_bytes if binary else socket.send_str)(content)

        connection.on_message(forward)
        try:
            async for message in socket:
                await connection.send(message.type == WSMsgType.BINARY, message)
        finally:
            self.tabs.discard(entry)
            app.close()
            await connection.close()
            await app.server.stop()
            await task
        return socket


def _options(request):
    return {}


async def _index(request):
    query = f"?{request.query_string}" if request.query_string else ""
    raise web.HTTPFound(f"index.html{query}")


def _client():
    from trame_client.module import vue3

    return vue3


def _folder(value):
    return value[0] if isinstance(value, (list, tuple)) else value


def serve(app, port=None, ready=print):
    """Serve until SIGINT or SIGTERM; ready(address) is called once.

    Paper: Sec. 3-6 (explorer).
    """

    async def run():
        door = Door(app)
        try:
            await door.open(port)
            ready(f"http://{HOST}:{door.port}/")
            await asyncio.Event().wait()
        finally:
            await door.close()

    asyncio.run(run())
