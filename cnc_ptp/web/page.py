"""What the messages of a page need of the page and of what all pages share."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any, Protocol

from cnc_ptp.web.access.command_right import CommandRight
from cnc_ptp.web.commissioning.tasks import Tasks
from cnc_ptp.web.faces.face import Face
from cnc_ptp.web.faces.scope import Stream
from cnc_ptp.web.programs.programs import ProgramFolder
from cnc_ptp.web.view import View


class Shared(Protocol):
    """The machine, and what belongs to all pages: the hub."""

    face: Face | None
    right: CommandRight
    folder: ProgramFolder
    tasks: Tasks

    def require_face(self) -> Face: ...

    def to_all(self, message: Mapping[str, Any]) -> None: ...

    def tell_operator(self) -> None: ...

    def note(self, text: str) -> None: ...

    def keep(self, task: asyncio.Task[None]) -> None: ...


class Page(Protocol):
    """One page: its session."""

    @property
    def hub(self) -> Shared: ...

    user: str
    role: str
    number: int
    view: View | None
    scope: Stream | None

    @property
    def label(self) -> str: ...

    def shown(self) -> dict[str, Any]: ...

    def end_jogs(self) -> None: ...

    def require_login(self) -> None: ...

    def send(self, message: Mapping[str, Any]) -> None: ...
