"""Errors of stored states."""

from __future__ import annotations

from cnc_ptp.errors import CncError

NOT_STORABLE = 26150
DAMAGED = 26151
OTHER_VERSION = 26152

NOT_RESTORED = "nothing was restored"


def not_storable(place: str, what: str) -> CncError:
    """26150: something that has no form in a state."""
    return CncError(NOT_STORABLE, f"the state holds {what} at {place}", "no state was stored", where="checkpoint")


def damaged(why: str) -> CncError:
    """26151: bytes that no state has."""
    return CncError(DAMAGED, f"the state is damaged: {why}", NOT_RESTORED, where="checkpoint")


def other_version(reason: str) -> CncError:
    """26152: the state of another kernel."""
    return CncError(OTHER_VERSION, f"the state {reason}", NOT_RESTORED, where="checkpoint")
