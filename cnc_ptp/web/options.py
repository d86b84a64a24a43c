"""How the pages are served: address, files; the port is taken before anything is started."""

from __future__ import annotations

import errno
import importlib.util
import os
import socket
from dataclasses import dataclass, field

from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import NO_AIOHTTP, NO_PORT

HOST = "127.0.0.1"
DEFAULT_PORT = 8080
NOTHING = "nothing was started"
NICENESS = 5
"""Of the server: below the nodes of a machine."""


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
    machine: str | None = None
    """Machine file, beside which changed ones are written."""

    @property
    def address(self) -> str:
        scheme = "http" if self.certificate is None else "https"
        host = "localhost" if self.host == HOST else f"[{self.host}]" if ":" in self.host else self.host
        return f"{scheme}://{host}:{self.port}"

    @property
    def words(self) -> list[str]:
        """As options of `cnc_ptp web`."""
        given = {
            "--port": str(self.port),
            "--host": self.host,
            "--programs": self.programs,
            "--tls-cert": self.certificate,
            "--tls-key": self.key,
            "--users": self.users,
            "--machine": self.machine,
        }
        words = [word for option, value in given.items() if value is not None for word in (option, value)]
        return words + [word for name in self.names for word in ("--name", name)]


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


def be_nice() -> None:
    """Called once: by a run in the process that it starts, and otherwise when the server begins."""
    os.nice(NICENESS)
