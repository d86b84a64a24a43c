"""The error of bytes that are no message of their topic: of a foreign program, or one of another version."""

from __future__ import annotations

from typing import Final

from cnc_ptp.errors import CncError

UNREADABLE_MESSAGE: Final = 26184


def unreadable(type_name: str, data: bytes, reason: object) -> CncError:
    """26184."""
    return CncError(UNREADABLE_MESSAGE, f"{len(data)} bytes are no message {type_name}: {reason}", "they are ignored")
