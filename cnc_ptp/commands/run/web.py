"""`cnc_ptp web`: pages of a running machine, or of a recording."""

from __future__ import annotations

import asyncio
import select
import socket
import sys
from collections.abc import Callable
from functools import cache, partial

from cnc_ptp.nodes.forked import end_with
from cnc_ptp.ros_arguments import ros_arguments
from cnc_ptp.web.access.security import require_secured
from cnc_ptp.web.faces.face import Face
from cnc_ptp.web.options import WebOptions, be_nice, listen, require_packages
from cnc_ptp.web.serve import serve


def web(
    port: int,
    host: str,
    names: tuple[str, ...],
    programs: str,
    certificate: str | None,
    key: str | None,
    users: str | None,
    machine: str | None = None,
    listening: int | None = None,
    recording: str | None = None,
) -> int:
    """Serves the pages of the machine that runs, or of a recording, until Ctrl-C.

    `machine`: its file, beside which pages may write others; `listening`: descriptor of a socket that has the port.
    """
    require_packages()
    options = WebOptions(port, host, names, programs, certificate, key, users, machine)
    require_secured(options)
    taken = listen(host, port) if listening is None else socket.socket(fileno=listening)
    if listening is None:
        be_nice()
    else:
        end_with(sys.stdin.fileno())
        if select.select([sys.stdin], [], [], 0.0)[0]:
            return 0  # the run has ended before the signal was ordered
    tell = partial(print_address, is_recording=recording is not None)
    asyncio.run(serve(connector(recording), options, taken, words=words_of, tell=tell))
    return 0


def connector(recording: str | None) -> Callable[[], Face]:
    """Gives the face of the machine. Raises CncError 26001 … for a recording that cannot be read."""
    if recording is not None:
        from cnc_ptp.web.faces.recorded_face import recorded_face

        first = [recorded_face(recording)]  # what is wrong with it is reported before anything is served
        return lambda: first.pop() if first else recorded_face(recording)
    from cnc_ptp.web.faces.live_face import live_face

    namespace = ros_arguments().namespace
    return lambda: live_face(namespace=namespace)


@cache
def words_of(dialect: str) -> list[tuple[str, str]]:
    """Codes and commands of a vocabulary, each with its meaning, without those that are not built yet."""
    from cnc_ptp.commands.language.words import entries

    kinds = ("G function", "M function", "command")
    return [
        (entry.name, entry.explanation.meaning) for entry in entries(dialect) if entry.kind in kinds and not entry.later
    ]


def print_address(address: str, *, is_recording: bool) -> None:
    continues = "" if is_recording else "; the machine continues"
    print(f"pages: {address} (Ctrl-C ends them{continues})", flush=True)
