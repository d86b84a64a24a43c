"""The process of the web face: it listens, tells its address, and ends with a signal."""

from __future__ import annotations

import asyncio
import signal
import socket
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from cnc_ptp.catalogue import entry
from cnc_ptp.web.access.security import tls_context
from cnc_ptp.web.faces.face import Face
from cnc_ptp.web.numbers import NO_PORT
from cnc_ptp.web.options import WebOptions


def machine_name(options: WebOptions) -> str:
    """What pages call the machine."""
    return Path(options.machine).stem if options.machine else "machine"


async def serve(
    connect: Callable[[], Face],
    options: WebOptions,
    listening: socket.socket,
    *,
    words: Callable[[str], Sequence[tuple[str, str]]],
    tell: Callable[[str], None],
) -> None:
    """Until SIGINT or SIGTERM. `connect` gives the face of the machine, `words` those of a vocabulary of NC programs.

    `tell` gets the address.
    """
    from aiohttp import web

    from cnc_ptp.web.access.access import Access
    from cnc_ptp.web.access.guard import LOCAL_NAMES, Names
    from cnc_ptp.web.access.users import Users
    from cnc_ptp.web.hub import Hub
    from cnc_ptp.web.programs.programs import ProgramFolder
    from cnc_ptp.web.server import Server

    tls = tls_context(options.certificate, options.key)
    entry(NO_PORT)  # the catalogue is read now, and not when the first page gets an error
    hub = Hub(connect, folder=ProgramFolder(options.programs), name=machine_name(options), machine_file=options.machine)
    access = Access(None if options.users is None else Users(options.users))
    server = Server(hub, access, Names((*LOCAL_NAMES, options.host, *options.names)), words=words)
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
