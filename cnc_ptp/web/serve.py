"""The process of the web face: it listens, tells its address, and ends with a signal."""

from __future__ import annotations

import asyncio
import errno
import importlib.util
import signal
import socket
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

from cnc_ptp.catalogue import entry
from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import NO_AIOHTTP, NO_PORT
from cnc_ptp.web.security import tls_context

HOST = "127.0.0.1"
DEFAULT_PORT = 8080
NOTHING = "nothing was started"


@dataclass(frozen=True, slots=True)
class WebOptions:
    """How the pages are served."""

    port: int = DEFAULT_PORT
    host: str = HOST
    names: tuple[str, ...] = field(default=())
    """More names of this computer under which pages may be asked for."""
    programs: str = "."
    """Folder of NC programs."""
    certificate: str | None = None
    key: str | None = None
    """Files (PEM) for TLS."""
    users: str | None = None
    """File of users; None: no login."""

    @property
    def address(self) -> str:
        scheme = "http" if self.certificate is None else "https"
        host = "localhost" if self.host == HOST else f"[{self.host}]" if ":" in self.host else self.host
        return f"{scheme}://{host}:{self.port}"


def require_packages() -> None:
    """Raises CncError 26230 where the packages of the web face are not installed."""
    missing = [name for name in ("aiohttp", "argon2") if importlib.util.find_spec(name) is None]
    if missing:
        reason = f"web: {' and '.join(missing)} not installed"
        raise CncError(NO_AIOHTTP, reason, f"{NOTHING}, install with: pip install 'cnc_ptp[web]'")


def listen(host: str, port: int) -> socket.socket:
    """The socket of the server. Raises CncError 26231 for a port that cannot be had."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listening = socket.socket(family)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((host, port))
        listening.listen()
    except OSError as error:
        listening.close()
        taken = "another program listens there" if error.errno == errno.EADDRINUSE else str(error.strerror)
        raise CncError(NO_PORT, f"web: {host} port {port}: {taken}", f"{NOTHING}, give another one") from None
    return listening


async def serve(
    connect: Callable[[], object], options: WebOptions, listening: socket.socket, *, tell: Callable[[str], None]
) -> None:
    """Until SIGINT or SIGTERM. `connect` gives the face of the machine; `tell` gets the address."""
    from aiohttp import web

    from cnc_ptp.web.access import Access
    from cnc_ptp.web.guard import LOCAL_NAMES, Names
    from cnc_ptp.web.hub import Hub
    from cnc_ptp.web.programs import ProgramFolder
    from cnc_ptp.web.server import Server
    from cnc_ptp.web.users import Users

    tls = tls_context(options.certificate, options.key)
    entry(NO_PORT)  # the catalogue is read now, and not when the first page gets an error
    hub = Hub(connect, folder=ProgramFolder(options.programs))  # type: ignore[arg-type]
    access = Access(None if options.users is None else Users(options.users))
    server = Server(hub, access, Names((*LOCAL_NAMES, options.host, *options.names)))
    runner = web.AppRunner(server.app, access_log=None)
    await runner.setup()
    await web.SockSite(runner, listening, ssl_context=tls).start()
    tell(options.address)
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, ended.set)
    try:
        await ended.wait()
    finally:
        with suppress(asyncio.TimeoutError):
            await asyncio.wait_for(runner.cleanup(), 5.0)
