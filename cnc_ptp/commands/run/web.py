"""`cnc_ptp web`: pages of a running machine, or of a recording."""

from __future__ import annotations

import asyncio
import os

from cnc_ptp.ros_arguments import ros_arguments
from cnc_ptp.web.security import require_secured
from cnc_ptp.web.serve import WebOptions, listen, require_packages, serve

NICENESS = 5
"""Below the nodes of a machine."""


def web(
    port: int,
    host: str,
    names: tuple[str, ...],
    programs: str,
    certificate: str | None,
    key: str | None,
    users: str | None,
) -> int:
    """Serves the pages of the machine that runs, until Ctrl-C."""
    require_packages()
    require_secured(host, certificate, key, users)
    options = WebOptions(port, host, names, programs, certificate, key, users)
    listening = listen(host, port)
    os.nice(NICENESS)
    from cnc_ptp.web.live_face import live_face

    namespace = ros_arguments().namespace
    asyncio.run(serve(lambda: live_face(namespace=namespace), options, listening, tell=print_address))
    return 0


def print_address(address: str) -> None:
    print(f"pages: {address} (Ctrl-C ends them; the machine continues)", flush=True)
