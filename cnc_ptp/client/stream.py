"""What comes, item by item: `for state in m.x.states()`, or `async for`."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Iterator
from typing import Generic, TypeVar

from cnc_ptp.client.faults import check_seconds
from cnc_ptp.client.observations import Item, Mailbox
from cnc_ptp.client.session import Session

Shown = TypeVar("Shown")


class Stream(Generic[Item, Shown]):
    """What comes from its making on, while it is iterated over; it ends after a time, or never."""

    def __init__(
        self,
        session: Session,
        mailbox: Mailbox[Item],
        shown: Callable[[Item], list[Shown]],
        *,
        duration: float | None,
        what: str,
    ) -> None:
        """`shown`: what an item of the mailbox stands for. `duration` in s of `m.time`, None = without an end.

        Raises CncError 22001 for a duration that is no number.
        """
        check_seconds("stream", "duration", duration, "nothing was read")
        self._session = session
        self._mailbox = mailbox
        self._shown = shown
        self._what = what
        self._end = None if duration is None else session.time + duration

    def __iter__(self) -> Iterator[Shown]:
        while True:
            self._session.run(self._session.until(self._is_due, None, self._what, may_stall=self._end is not None))
            if not self._mailbox.items:
                return
            yield from self._shown(self._mailbox.items.popleft())

    async def __aiter__(self) -> AsyncIterator[Shown]:
        while True:
            turns = self._session.until(self._is_due, None, self._what, may_stall=self._end is not None)
            await self._session.run_async(turns)
            if not self._mailbox.items:
                return
            for each in self._shown(self._mailbox.items.popleft()):
                yield each

    def _is_due(self) -> bool:
        """Something has come, or the end of the time."""
        return bool(self._mailbox.items) or (self._end is not None and self._session.time >= self._end)
