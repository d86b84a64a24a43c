"""Who commands the machine: one session at a time, which hands it over."""

from __future__ import annotations

from typing import Any, Protocol

from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import NO_COMMAND_RIGHT
from cnc_ptp.web.protocol import NOTHING


class Holder(Protocol):
    """A page that may hold the command."""

    @property
    def label(self) -> str: ...

    def shown(self) -> dict[str, Any]: ...

    def end_jogs(self) -> None: ...


class CommandRight:
    """The session that holds the command, and the one that asks for it."""

    def __init__(self) -> None:
        self.holder: Holder | None = None
        self.asking: Holder | None = None

    def take(self, session: Holder, *, force: bool = False) -> None:
        """`force`: from another session, whose jogs end. Raises CncError 26236 while another session holds it."""
        if force and self.holder not in (None, session):
            assert self.holder is not None
            self.holder.end_jogs()
        elif self.holder not in (None, session):
            assert self.holder is not None
            effect = f"{NOTHING}; ask for the command, or wait until it is given"
            raise CncError(NO_COMMAND_RIGHT, f"take_command: {self.holder.label} holds the command", effect)
        self.holder = session
        self.asking = None if self.asking is session else self.asking

    def ask(self, session: Holder) -> None:
        """The holder is asked to give it; a command that nobody holds is taken at once."""
        if self.holder in (None, session):
            self.take(session)
        else:
            self.asking = session

    def give(self, session: Holder) -> None:
        """To whoever asks for it, or to nobody. Raises CncError 26236 for one who does not hold it."""
        self.require(session, "give_command")
        self.holder, self.asking = self.asking, None

    def leave(self, session: Holder) -> bool:
        """The session has ended; whether anything has changed."""
        changed = session in (self.holder, self.asking)
        if self.asking is session:
            self.asking = None
        if self.holder is session:
            self.holder, self.asking = self.asking, None
        return changed

    def require(self, session: Holder, what: str) -> None:
        """Raises CncError 26236 for a session that does not hold the command."""
        if self.holder is not session:
            held = "nobody holds it: take it" if self.holder is None else f"{self.holder.label} holds it"
            raise CncError(NO_COMMAND_RIGHT, f"{what}: this page does not hold the command, {held}", NOTHING)

    def shown(self) -> dict[str, Any]:
        """As `operator` tells it to pages."""
        return {
            "holder": None if self.holder is None else self.holder.shown(),
            "asking": None if self.asking is None else self.asking.shown(),
        }
