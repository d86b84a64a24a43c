"""Jobs of a unit: every command that moves it, or runs a program, has a number and an end that the PLC learns.

PLCopen's function blocks rest on it: a block is Active while its job is, Done when that was finished in full, and
CommandAborted when another job took its place (PLCopen Motion Control part 1, 2.4.1).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from enum import IntEnum

from cnc_ptp.protocol.axis_states import REST_STATES, AxisStateCode
from cnc_ptp.protocol.blocks import ChannelBlock, CycleBlock, JobEvent, PlcBlock
from cnc_ptp.protocol.channel_states import ChannelStateCode

JOBS: Mapping[str, Collection[str]] = {
    "axis": frozenset(
        {
            "move_absolute",
            "move_relative",
            "move_modulo",
            "move_additive",
            "move_velocity",
            "new_target",
            "new_velocity_and_target",
            "begin_trajectory",
            "jog",
            "home",
            "stop",
            "halt",
            "emergency_stop",
            "external_enable",
            "external_disable",
            "couple",
            "couple_gantry",
            "couple_cyclic",
            "couple_flying_saw",
            "couple_cam",
            "decouple",
            "move_superimposed",
            "halt_superimposed",
        }
    ),
    "spindle": frozenset({"start", "set_speed", "stop", "orient", "home"}),
    "channel": frozenset({"start", "mdi", "reset"}),
    "plc": frozenset(),
}
"""Kind of unit -> commands that are jobs."""
SUPERIMPOSED = frozenset({"move_superimposed", "halt_superimposed"})
"""Jobs that are active beside that of the basic motion."""


class JobStatus(IntEnum):
    """What has become of a job (JobEvent.msg)."""

    ACTIVE = 1
    DONE = 2
    ABORTED = 3
    FAILED = 4


class Jobs:
    """Numbers the jobs of one unit and notes what becomes of them.

    At most one is active, and one beside it that moves an axis in addition to its basic motion. A job that begins
    aborts the active one of its place. A job ends when its unit is at rest: done at a standstill, failed in ErrorStop,
    aborted without power; a job without an end of its own stays active until another one begins.
    """

    def __init__(self) -> None:
        self.newest = 0
        """Number of the newest job; 0: there was none."""
        self.active = 0
        """Number of the active job; 0: none is."""
        self.superimposed = 0
        """Number of the job that is active beside it; 0: none is."""
        self._since = 0
        """Cycle at which the newest job became active: what the unit was before is not its end."""
        self._events: list[JobEvent] = []

    def accept(self) -> int:
        """The number of a new job, which becomes active later."""
        self.newest += 1
        return self.newest

    def activate(self, cycle: int, number: int) -> None:
        """An accepted job becomes the active one."""
        self.end(cycle, JobStatus.ABORTED)
        self.active, self._since = number, cycle
        self._note(number, JobStatus.ACTIVE, cycle)

    def begin(self, cycle: int) -> int:
        """Accepts a job and makes it the active one; its number."""
        self.activate(cycle, self.accept())
        return self.newest

    def begin_superimposed(self, cycle: int) -> int:
        """The same for a job beside the active one."""
        self.end_superimposed(cycle, JobStatus.ABORTED)
        self.superimposed, self._since = self.accept(), cycle
        self._note(self.superimposed, JobStatus.ACTIVE, cycle)
        return self.newest

    def end(self, cycle: int, status: JobStatus, error_id: int = 0) -> None:
        """The active job, if there is one, ends."""
        if self.active:
            self._note(self.active, status, cycle, error_id)
            self.active = 0

    def end_superimposed(self, cycle: int, status: JobStatus, error_id: int = 0) -> None:
        """The job beside it, if there is one, ends."""
        if self.superimposed:
            self._note(self.superimposed, status, cycle, error_id)
            self.superimposed = 0

    def drop(self, cycle: int, number: int, error_id: int = 0) -> None:
        """A job that waits will never become active; with an error number it was refused at its turn."""
        self._note(number, JobStatus.FAILED if error_id else JobStatus.ABORTED, cycle, error_id)

    def _note(self, number: int, status: JobStatus, cycle: int, error_id: int = 0) -> None:
        self._events.append(JobEvent(number, int(status), cycle, error_id))

    def watch(self, block: CycleBlock) -> None:
        """Ends the active jobs at the first cycle of a new block in which their unit is at rest."""
        if not (self.active or self.superimposed) or isinstance(block, PlcBlock):
            return
        ends = CHANNEL_ENDS if isinstance(block, ChannelBlock) else AXIS_ENDS
        for cycle, state in enumerate(block.state, block.first_cycle):
            if state in ends and cycle >= self._since:
                error_id = block.error_id[cycle - block.first_cycle]
                self.end(cycle, ends[state], error_id)
                self.end_superimposed(cycle, ends[state], error_id)
                return

    def take_events(self) -> list[JobEvent]:
        """What has become of jobs since the last call, in order."""
        events, self._events = self._events, []
        return events


AXIS_ENDS: Mapping[int, JobStatus] = {
    int(AxisStateCode.STANDSTILL): JobStatus.DONE,
    int(AxisStateCode.DISABLED): JobStatus.ABORTED,
    int(AxisStateCode.ERROR_STOP): JobStatus.FAILED,
}
CHANNEL_ENDS: Mapping[int, JobStatus] = {
    int(ChannelStateCode.IDLE): JobStatus.DONE,
    int(ChannelStateCode.READY): JobStatus.DONE,
    int(ChannelStateCode.ERROR): JobStatus.FAILED,
}
assert AXIS_ENDS.keys() == {*map(int, REST_STATES)}
