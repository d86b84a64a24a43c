"""The rhythm of a PLC for function blocks: `for _ in m.plc_cycles(): move(execute=True, position=100)`."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator

from cnc_ptp.client.session import Session, Turns


class PlcCycles:
    """The first cycle of each block: at once for the one that comes next, then whenever all units have told of it.

    What comes meanwhile is seen in the next one, so that all function blocks of a cycle see the same. In the graph a
    program that is slower than the blocks gets every second one, or fewer; offline it gets all.
    """

    def __init__(self, session: Session, duration: float | None) -> None:
        """`duration` in s of the machine, None = without an end."""
        self._session = session
        self._end = None if duration is None else session.time + duration

    def __iter__(self) -> Iterator[int]:
        try:
            while not self._is_over:
                cycle = self._session.link.seen.cycle
                self._hold()
                yield cycle
                self._session.in_plc_cycle = False
                self._session.run(self._next(cycle))
        finally:
            self._release()

    async def __aiter__(self) -> AsyncIterator[int]:
        try:
            while not self._is_over:
                cycle = self._session.link.seen.cycle
                self._hold()
                yield cycle
                self._session.in_plc_cycle = False
                await self._session.run_async(self._next(cycle))
        finally:
            self._release()

    def _hold(self) -> None:
        self._session.in_plc_cycle = True
        self._session.link.hold()

    def _release(self) -> None:
        self._session.in_plc_cycle = False
        self._session.link.release()

    @property
    def _is_over(self) -> bool:
        """Seconds of a machine are whole cycles: half of one is no time."""
        return self._end is not None and self._session.time > self._end - 0.5 * self._session.link.cycle_time

    def _next(self, cycle: int) -> Turns:
        """Raises CncError 26174 offline, where nothing has moved for long."""
        seen = self._session.link.seen
        return self._session.until(
            lambda: seen.cycle > cycle, None, "plc_cycles: no end", may_stall=self._end is not None, effect="it ends"
        )
