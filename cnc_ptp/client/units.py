"""The units of a machine as a client sees them: commands, state, and what comes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from cnc_ptp.client.asking import Asking
from cnc_ptp.client.faults import check_callable
from cnc_ptp.client.job import Answer, Job, ProgramJob
from cnc_ptp.client.made.axis_commands import AxisCommands
from cnc_ptp.client.made.channel_commands import ChannelCommands
from cnc_ptp.client.made.plc_commands import PlcCommands
from cnc_ptp.client.made.spindle_commands import SpindleCommands
from cnc_ptp.client.several_jobs import TrajectoryJob
from cnc_ptp.client.states import STATES, AxisState, ChannelState, SpindleState
from cnc_ptp.client.stream import Stream
from cnc_ptp.plc.trajectories import FOLLOW
from cnc_ptp.protocol.blocks import CycleBlock, HandshakeRequest


def state_of(unit: Asking) -> Any:
    """Its state in the newest cycle that has come."""
    return STATES[unit.kind](unit._session.link.seen.blocks[unit.name], -1)


def states_of(unit: Asking, duration: float | None) -> Stream[CycleBlock, Any]:
    """Its states from now on, cycle by cycle."""

    def states(block: CycleBlock) -> list[Any]:
        return [STATES[unit.kind](block, index) for index in range(block.count)]

    mailbox = unit._session.link.seen.blocks_of(unit.name)
    what = f"{unit.kind} {unit.name}: no new state"
    return Stream(unit._session, mailbox, states, duration=duration, what=what)


class Axis(AxisCommands):
    """An axis."""

    @property
    def state(self) -> AxisState:
        """Its newest state, with the fields of the recording."""
        state: AxisState = state_of(self)
        return state

    def states(self, duration: float | None = None) -> Stream[CycleBlock, AxisState]:
        """Its states from now on, cycle by cycle: `for state in m.x.states():`, or `async for`.

        `duration` in s of the machine; None: without an end. If nobody reads it, a stream keeps the last 1000 blocks.
        """
        return states_of(self, duration)


class Spindle(SpindleCommands):
    """A spindle."""

    @property
    def state(self) -> SpindleState:
        """As of an axis."""
        state: SpindleState = state_of(self)
        return state

    def states(self, duration: float | None = None) -> Stream[CycleBlock, SpindleState]:
        """As of an axis."""
        return states_of(self, duration)


class Channel(ChannelCommands):
    """An NC channel."""

    @property
    def state(self) -> ChannelState:
        """As of an axis."""
        state: ChannelState = state_of(self)
        return state

    def states(self, duration: float | None = None) -> Stream[CycleBlock, ChannelState]:
        """As of an axis."""
        return states_of(self, duration)

    def run(
        self,
        program: str,
        *,
        text: str | None = None,
        files: Mapping[str, str] | None = None,
        dialect: Any = None,
        line: int | None = None,
        block_number: int | None = None,
        in_program: str | None = None,
        pass_number: int | None = None,
    ) -> ProgramJob:
        """Loads a program and starts it: `load`, then `start`, with their arguments."""
        self.load(program, text=text, files=files, dialect=dialect)
        return self.start(line=line, block_number=block_number, in_program=in_program, pass_number=pass_number)


class Plc(PlcCommands):
    """The PLC of the machine."""

    def emergency_stop(self, enabled: bool) -> Answer:
        """As the command. A release has reached the units when this returns, so that resets may follow.

        In a cycle of `plc_cycles`, where no time passes, it reaches them with the next one.

        enabled  on or off
        """
        answer = super().emergency_stop(enabled)
        if not enabled and not self._session.in_plc_cycle:
            seen = self._session.link.seen
            arrived = self._session.until(
                lambda: seen.has_arrived(answer.cycle), None, "plc: emergency_stop", may_stall=True
            )
            self._session.run(arrived)
        return answer

    def on_handshake(self, callback: Callable[[HandshakeRequest], object] | None) -> None:
        """`callback(request)` gets the M, S, T, D and H functions of all channels that come from now on.

        It is called while this client waits. A request that needs one is acknowledged when it returns True, otherwise
        the channel waits for `acknowledge(request.id)`. None: they are acknowledged automatically again.
        """
        if callback is not None:
            check_callable("plc: on_handshake", "callback", callback, "nothing was changed")
        self._session.on_handshake(None)
        self.auto_acknowledge(callback is None)
        self._session.on_handshake(callback)

    def _trajectory_job(self, axes: Sequence[str], points: Any, options: Mapping[str, Any]) -> TrajectoryJob:
        reply, given = self._asked(FOLLOW, {"axes": axes, "points": points, **options})
        return TrajectoryJob(self._session, axes, FOLLOW, given, reply)


Unit = Axis | Spindle | Channel | Plc
UNITS: Mapping[str, Callable[..., Unit]] = {"axis": Axis, "spindle": Spindle, "channel": Channel, "plc": Plc}
__all__ = ["UNITS", "Axis", "Channel", "Job", "Plc", "Spindle", "Unit"]
