"""Messages of the commissioning pages: identification, circle test, and what becomes of their results."""

from __future__ import annotations

import asyncio

from cnc_ptp.web.access.rights import require_role
from cnc_ptp.web.page import Page
from cnc_ptp.web.protocol import Message, answer, field


class CommissioningMessages:
    """Handles those of one page; all of them take the role commissioner."""

    def __init__(self, session: Page) -> None:
        self._session = session
        self._tasks = session.hub.tasks
        self.handlers = {
            "identify": self._identify,
            "circle": self._circle,
            "cancel_task": self._cancel,
            "accept": self._accept,
        }

    def _identify(self, message: Message) -> None:
        self._require_role(message)
        kinds = self._session.hub.require_face().kinds
        axes = [unit for unit, kind in kinds.items() if kind == "axis"]
        self._begin(message, self._tasks.identify(message, axes))

    def _circle(self, message: Message) -> None:
        self._require_role(message)
        self._begin(message, self._tasks.circle(message))

    def _begin(self, message: Message, words: list[str]) -> None:
        number, task = self._tasks.begin(words, self._session.hub.to_all)
        self._note(f"task {number} begun: {' '.join(map(str, words))}")
        self._session.hub.keep(task)
        self._session.send(answer(message, task=number))

    def _cancel(self, message: Message) -> None:
        self._require_role(message)
        number = field(message, "task", "integer")
        self._tasks.cancel(number)
        self._note(f"task {number} cancelled")
        self._session.send(answer(message))

    async def _accept(self, message: Message) -> Message:
        self._require_role(message)
        number, name = field(message, "task", "integer"), field(message, "file", "text")
        file = await asyncio.to_thread(self._tasks.accept, number, name)
        self._note(f"result of task {number} accepted, machine file {file} written")
        return answer(message, file=file)

    def _note(self, text: str) -> None:
        self._session.hub.note(f"{self._session.user}: {text}")

    def _require_role(self, message: Message) -> None:
        require_role(message["type"], self._session.user, self._session.role, "commissioner")
