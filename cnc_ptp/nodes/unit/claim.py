"""One process for a unit: the first one has it, a later one ends and names the first."""

from __future__ import annotations

import hashlib
import shlex
import socket
import struct
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from rclpy.node import Node

from cnc_ptp.errors import CncError
from cnc_ptp.nodes.topics import block_topic

UNIT_TAKEN = 26141
REFUSED_STARTS = 128
"""Number of later processes that can ask who has a unit."""
CREDENTIALS = struct.Struct("3i")
"""SO_PEERCRED: process, user, group."""


def claim_unit(node: Node, unit: str) -> socket.socket:
    """Holds a unit of this computer, ROS domain and namespace until the socket is closed, by the system
    at the latest, when the process ends. Raises CncError 26141 when another process has it.
    """
    claim = socket.socket(socket.AF_UNIX)
    try:
        claim.bind(_name(node, unit))
    except OSError:
        claim.close()
        raise _taken(node, unit) from None
    claim.listen(REFUSED_STARTS)
    return claim


def require_free(node: Node, units: Iterable[str]) -> None:
    """Raises CncError 26141 when a process has one of the units."""
    for unit in units:
        claim_unit(node, unit).close()


def _name(node: Node, unit: str) -> str:
    """In the abstract namespace of sockets: nothing to clean up. Of fixed length, because topics may be long."""
    place = f"{node.context.get_domain_id()} {node.resolve_topic_name(block_topic(unit))}"
    return f"\0cnc_ptp/unit/{hashlib.sha256(place.encode()).hexdigest()}"


def _taken(node: Node, unit: str) -> CncError:
    return CncError(
        UNIT_TAKEN,
        f"{unit}: {_holder(_name(node, unit))} on this computer has this unit on ROS domain "
        f"{node.context.get_domain_id()} already",
        "nothing was started. End one of the two",
    )


def _holder(name: str) -> str:
    """`process 4711 (python -m cnc_ptp.nodes.axis config/mill.yaml x)`, as far as it can be found out."""
    with suppress(OSError), socket.socket(socket.AF_UNIX) as asker:
        asker.setblocking(False)
        asker.connect(name)
        process, _, _ = CREDENTIALS.unpack(asker.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, CREDENTIALS.size))
        return f"process {process}{_command_line(process)}"
    return "another process"


def _command_line(process: int) -> str:
    with suppress(OSError):
        line = Path(f"/proc/{process}/cmdline").read_bytes().decode(errors="replace")
        line = line.rstrip("\0")
        program, *words = line.split("\0" if "\0" in line else " ")  # spaces: of a title that a process has chosen
        return f" ({shlex.join([Path(program).name, *words])})"
    return ""
