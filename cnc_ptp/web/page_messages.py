"""What each message of a page does."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any

from cnc_ptp.client.faults import unknown_unit
from cnc_ptp.errors import CncError, nearest_name
from cnc_ptp.web.access.rights import is_stop, require_page_command, require_role, role_for
from cnc_ptp.web.commissioning.commissioning_messages import CommissioningMessages
from cnc_ptp.web.faces.recorded_face import RecordedFace
from cnc_ptp.web.faces.scope import Stream, read_signals
from cnc_ptp.web.jog import Jogs
from cnc_ptp.web.numbers import A_RECORDING, BAD_MESSAGE
from cnc_ptp.web.page import Page
from cnc_ptp.web.protocol import NOTHING, Message, answer, field
from cnc_ptp.web.view import View

Answering = Awaitable[Message]


class PageMessages:
    """Handles the messages of one page; what takes time is an awaitable of the answer."""

    def __init__(self, session: Page) -> None:
        self._session = session
        self._hub = session.hub
        self._jogs = Jogs(session)
        self._streams = 0
        self._handlers: dict[str, Callable[[Message], Answering | None]] = {
            "command": self._command,
            "jog": self._jogs.take,
            "jog_stop": self._jogs.take_stop,
            "take_command": self._take_command,
            "ask_command": self._ask_command,
            "give_command": self._give_command,
            "acknowledge": self._acknowledge,
            "load": self._load,
            "offsets": self._offsets,
            "scope": self._scope,
            "scope_stop": self._scope_stop,
            "seek": self._seek,
            "play": self._play,
            "ping": self._ping,
            **CommissioningMessages(session).handlers,
        }

    def handle(self, message: Message) -> Answering | None:
        """Raises CncError for a message that is refused."""
        name = message["type"]
        handler = self._handlers.get(name)
        if handler is None:
            reason = f"message of the unknown type '{name[:40]}'{nearest_name(name, self._handlers)}"
            raise CncError(BAD_MESSAGE, reason, f"{NOTHING}. Known: {', '.join(self._handlers)}")
        return handler(message)

    def end(self) -> None:
        """The page is gone: its jogs end now."""
        self._jogs.end()

    # commands

    def _command(self, message: Message) -> Answering:
        unit, command = field(message, "unit", "text"), field(message, "command", "text")
        arguments = field(message, "arguments", "object", {})
        what = self._require_command(unit, command, arguments)
        return self._ask(message, unit, command, arguments, what)

    def _require_command(self, unit: str, command: str, arguments: dict[str, Any]) -> str:
        """What is to be done, in words. Raises CncError 26111, 26235, 26236, 26249."""
        face = self._hub.require_face()
        kind = face.kinds.get(unit)
        if kind is None:
            raise unknown_unit(unit, face.kinds)
        what = f"{kind} {unit}: {command}"
        require_page_command(kind, unit, command, arguments)
        try:
            require_role(what, self._session.user, self._session.role, role_for(kind, command))
            if not is_stop(kind, command, arguments):
                self._hub.right.require(self._session, what)
        except CncError as error:
            self._hub.note(f"{self._session.user}: {what}, P-ERR-{error.number}")
            raise
        return what

    async def _ask(self, message: Message, unit: str, command: str, arguments: dict[str, Any], what: str) -> Message:
        require, face = partial(self._require_still, what), self._hub.require_face()
        reply = await face.ask(unit, command, arguments, user=self._session.user, require=require)
        return answer(message, cycle=reply.cycle, job=reply.job, warning=reply.message, values=dict(reply.values))

    def _require_still(self, what: str) -> None:
        """A command has waited for others. Raises CncError 26236, 26239 where its page may give it no longer."""
        self._session.require_login()
        self._hub.right.require(self._session, what)

    def _load(self, message: Message) -> Answering:
        """A program of the folder, or its text."""
        face = self._hub.require_face()
        channels = [unit for unit, kind in face.kinds.items() if kind == "channel"]
        channel = field(message, "channel", "text", channels[0] if channels else "channel")
        name, text = field(message, "name", "text"), field(message, "text", "text", None)
        if channel not in channels:
            raise unknown_unit(channel, channels, "channel")
        what = f"channel {channel}: load"
        require_role(what, self._session.user, self._session.role, "operator")
        self._hub.right.require(self._session, what)
        path = str(self._hub.folder.path(name) if text is None else self._hub.folder.place(name))
        arguments = {"program": path}
        if (dialect := field(message, "dialect", "text", None)) is not None:
            arguments["dialect"] = dialect
        if text is not None:
            arguments["text"] = text
        return self._ask(message, channel, "load", arguments, what)

    def _offsets(self, message: Message) -> None:
        """The zero offsets of a channel."""
        tables = self._view().tables
        channel = field(message, "channel", "text", next(iter(tables), "channel"))
        if channel not in tables:
            raise unknown_unit(channel, tables, "channel")
        self._session.send(answer(message, **tables[channel].shown()))

    # the scope

    def _scope(self, message: Message) -> None:
        """Signals in every cycle, from now on; former ones end."""
        face = self._hub.require_face()
        signals = read_signals(field(message, "signals", "list"), face.kinds)
        self._streams += 1
        bits = 64 if field(message, "bits", "integer", 32) == 64 else 32
        self._session.scope = Stream(self._streams, signals, bits=bits) if signals else None
        names = [signal.name for signal in signals]
        self._session.send(answer(message, stream=self._streams, signals=names, bits=bits))

    def _scope_stop(self, message: Message) -> None:
        self._session.scope = None
        self._session.send(answer(message))

    # recordings

    def _seek(self, message: Message) -> Answering:
        return self._sought(message, self._recording(message), field(message, "time", "number"))

    async def _sought(self, message: Message, face: RecordedFace, time: float) -> Message:
        await face.seek(time)
        return answer(message, time=face.time)

    def _play(self, message: Message) -> None:
        self._recording(message).play(field(message, "speed", "number"))
        self._session.send(answer(message))

    def _recording(self, message: Message) -> RecordedFace:
        """Raises CncError 26248 for a machine that runs."""
        face = self._view().face
        if not isinstance(face, RecordedFace):
            raise CncError(A_RECORDING, f"{message['type']}: this machine runs, it is no recording", NOTHING)
        return face

    def _view(self) -> View:
        """What the page sees. Raises CncError 26171, 26244 while there is no machine."""
        self._hub.require_face()
        assert self._session.view is not None
        return self._session.view

    # the command right

    def _take_command(self, message: Message) -> None:
        force = field(message, "force", "switch", False)
        needed = "commissioner" if force else "operator"
        require_role("take_command", self._session.user, self._session.role, needed)
        self._hub.right.take(self._session, force=force)
        self._told(message)

    def _ask_command(self, message: Message) -> None:
        require_role("ask_command", self._session.user, self._session.role, "operator")
        self._hub.right.ask(self._session)
        self._told(message)

    def _give_command(self, message: Message) -> None:
        self._hub.right.give(self._session)
        self._jogs.end()
        self._told(message)

    def _told(self, message: Message) -> None:
        self._session.send(answer(message))
        self._hub.tell_operator()
        self._hub.note(f"{self._session.label}: {message['type']}")

    # alarms

    def _acknowledge(self, message: Message) -> None:
        require_role("acknowledge", self._session.user, self._session.role, "operator")
        self._view().acknowledge(field(message, "alarm", "integer", None), self._session.user)
        self._session.send(answer(message))

    def _ping(self, message: Message) -> None:
        """For the page, to know how far the server is, and for the server, to know how late jogs come."""
        if message.get("time") is not None:
            self._session.send({"type": "pong", "time": self._jogs.take_ping(message)})
        if message.get("id") is not None:
            self._session.send(answer(message))
