"""The spindle that leads a thread, as it reports: its angle, whether it is ready for the start, whether it fails."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.path.thread.spindle_angle import SpindleAngle, SpindleReport
from cnc_ptp.protocol.axis_states import AxisStateCode, state_name
from cnc_ptp.protocol.blocks import CycleBlock, SpindleBlock
from cnc_ptp.protocol.spindle_states import SpindleBit

SPINDLE_STANDS = 22080
SPINDLE_HELD = 51109

PATIENCE: Final = 0.5
"""s that a spindle has to start to turn after its command, and to come to a constant speed."""
STEADY: Final = 10.0
"""deg/s² below which the speed of a spindle is constant: 0.05 deg within 0.1 s."""
STANDS: Final = 6.0
"""deg/s below which a spindle that stops stands: 1 rpm."""


class LeadingSpindle:
    """Reads the blocks of a spindle.

    node    its name
    angle   where it is, and will be
    """

    def __init__(self, node: str, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self.node = node
        self.angle = SpindleAngle(cycle_time)
        self._cycle_time = cycle_time
        self._report: SpindleBlock | None = None
        self._waited = 0
        """Cycles that it has not turned in."""
        self._steady = 0
        """Cycles since its set speed is constant."""

    def read(self, feedback: Mapping[str, CycleBlock]) -> bool:
        """Takes its newest block; False without one."""
        report = feedback.get(self.node)
        self._report = report if isinstance(report, SpindleBlock) else None
        if self._report is None:
            return False
        self.angle.read(self._what_it_does(self._report))
        self._note_speed(self._report)
        return True

    def _what_it_does(self, report: SpindleBlock) -> SpindleReport:
        wanted = 0.0
        if self._turns(report) and not self.held:
            suppressed = report.status_bits[-1] & SpindleBit.OVERRIDE_SUPPRESSED
            override = 1.0 if suppressed else 0.01 * report.override_percent[-1]
            wanted = report.programmed_speed_rpm[-1] * override * DEG_S_PER_RPM
        speeds = [rpm * DEG_S_PER_RPM for rpm in report.set_speed_rpm]
        gain = report.set_acceleration_deg_s2[-1]
        return SpindleReport(report.first_cycle, report.actual_position_deg, speeds, gain, wanted)

    @property
    def cycles(self) -> int:
        """Of its last block."""
        return 0 if self._report is None else self._report.count

    def _note_speed(self, report: SpindleBlock) -> None:
        reached = self._turns(report) and report.speed_reached[-1] and abs(self.angle.speed) >= STANDS
        self._steady = self._steady + report.count if reached and not any(report.set_acceleration_deg_s2) else 0
        self._waited = 0 if self._turns(report) else self._waited + report.count

    @staticmethod
    def _turns(report: SpindleBlock) -> bool:
        return report.state[-1] == AxisStateCode.CONTINUOUS_MOTION

    @property
    def ready(self) -> bool:
        """It turns at a constant speed; after a while that is taken for granted. Raises CncError 22080."""
        report = self._report
        if report is None or not self.angle.known:
            return False
        if self._waited * self._cycle_time > PATIENCE:
            state = state_name(AxisStateCode(report.state[-1]))
            raise CncError(SPINDLE_STANDS, f"spindle {self.node} does not turn for the thread (G33), it is in {state}")
        settled = self._steady * self._cycle_time > PATIENCE
        return settled or (self._steady > 0 and abs(self.angle.acceleration) < STEADY)

    @property
    def waits_for(self) -> str:
        """What it needs for the start of a thread, as long as it does not turn at a constant speed."""
        if self._report is None or self._steady:
            return ""
        return f"{'an override above 0' if self.held else 'a constant speed'} of spindle {self.node}"

    @property
    def held(self) -> bool:
        """Override 0 acts on it."""
        report = self._report
        if report is None or report.status_bits[-1] & SpindleBit.OVERRIDE_SUPPRESSED:
            return False
        return report.override_percent[-1] == 0.0

    @property
    def stops(self) -> bool:
        """It is on its way to a standstill, and reports where it is."""
        return self._report is not None and (not self._turns(self._report) or self.held)

    def require_turning(self) -> None:
        """Raises CncError 51109 for a spindle that is held or stopped; those in error are reported by the channel."""
        report = self._report
        if report is None or report.error_id[-1] or not self.stops:
            return
        why = "is held by override 0" if self.held else f"is in {state_name(AxisStateCode(report.state[-1]))}"
        raise CncError(SPINDLE_HELD, f"spindle {self.node} {why} within a thread (G33)")
