"""The procedure command S-0-0148: a drive homes its axis on its own.

| phase | the drive | ends |
|---|---|---|
| OFF_SWITCH | moves against the direction of homing, if it stands on its home switch | the switch is off |
| TO_SWITCH | moves in the direction of homing (S-0-0147 bit 0) at S-0-0041 | the switch is on |
| TO_MARKER | moves on in this direction | the first marker pulse behind the edge of the switch |
| TO_REFERENCE | comes to rest, with bit 7 of S-0-0147 on the reference point itself | it is in its windows |
| DONE | has set S-0-0403: its position counts from the reference S-0-0052; holds its position | the master cancels |
| FAILED | stops on its ramp and holds its position | the master cancels |
| CANCELLED | stops on its ramp | at a standstill |

Without the home switch (bit 5) or the marker pulse (bit 6) the phases of that signal are left out. The ramps are
S-0-0042 and S-0-0349. Sources: public documentation of S-0-0041, 0042, 0052, 0108, 0147, 0148, 0403.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from cnc_ptp.control.drives.reference_marks import ReferenceMarks
from cnc_ptp.control.drives.sercos import idns
from cnc_ptp.control.drives.sercos.own_motion import OwnMotion
from cnc_ptp.motion import Limits
from cnc_ptp.parameters.view.sercos_view import (
    ABORTED,
    NO_ANSWER,
    NO_MARKER,
    NO_REFERENCE,
    NO_SWITCH,
    SercosParameters,
)

NOT_ACTIVE, EXECUTED, INTERRUPTED, ACTIVE, ERROR = 0x0, 0x3, 0x5, 0x7, 0xF
"""Acknowledgement of a procedure command: set, enabled, not executed yet, error (bits 0 to 3)."""


class Phase(Enum):
    """The values are S-0-0095 without a fault."""

    IDLE = "follows its cyclic commands"
    OFF_SWITCH = "homing, moves off the home switch"
    TO_SWITCH = "homing, moves to the home switch"
    TO_MARKER = "homing, moves to the marker pulse"
    TO_REFERENCE = "homing, the reference is found"
    DONE = "homing is completed"
    FAILED = "homing is aborted with an error"
    CANCELLED = "homing is cancelled, the drive stops"


SEARCHING = (Phase.OFF_SWITCH, Phase.TO_SWITCH, Phase.TO_MARKER)
RUNNING = (*SEARCHING, Phase.TO_REFERENCE)


class HomingSettings(NamedTuple):
    """What the parameters of the drive say when the procedure starts; mm, mm/s (deg, deg/s)."""

    velocity: float
    acceleration: float
    jerk: float
    reference: float
    """Position of the reference point, S-0-0052."""
    bits: int
    """S-0-0147."""

    @property
    def direction(self) -> float:
        return -1.0 if self.bits & idns.NEGATIVE else 1.0


class HomingProcedure:
    """The drive's side of S-0-0148, cycle by cycle. Places are the encoder's; `origin` makes positions of them."""

    def __init__(
        self, drive: SercosParameters, *, cycle_time: float, kv: float, place: float, standstill_window: float
    ) -> None:
        """`cycle_time` in s, `kv` of the drive's position loop in 1/s (S-0-0104), `place` of its encoder at start.

        `standstill_window` in mm/s (deg/s), S-0-0124.
        """
        self._cycle_time, self._kv = cycle_time, kv
        self._marks = ReferenceMarks(drive.homing)
        self._range, self._fault = drive.homing.range, drive.fault
        self._unit = "deg" if drive.rotary else "mm"
        self._position_window, self.standstill_window = drive.position_window, standstill_window
        self._motion = OwnMotion(cycle_time=cycle_time)
        self._settings = HomingSettings(0.0, 1.0, 1.0, 0.0, 0)
        self._phase_begin = self._armed_at = self._mark = 0.0
        self._reason = ""
        self.phase = Phase.IDLE
        self.control = 0
        """What the master has written to S-0-0148."""
        self.place = place
        self.velocity = 0.0
        self.origin = 0.0 if drive.referenced else -place
        """Position of the drive where its encoder is at 0."""
        self.referenced = drive.referenced
        """S-0-0403."""
        self.override = 1.0
        """S-0-0108."""

    # what others see

    @property
    def leads(self) -> bool:
        """The drive moves or holds its axis on its own and ignores its cyclic commands."""
        return self.phase is not Phase.IDLE

    @property
    def acknowledgement(self) -> int:
        """Data status of S-0-0148."""
        if not self.control:
            return NOT_ACTIVE
        if self.phase is Phase.FAILED:
            return ERROR
        if self.phase is Phase.DONE:
            return EXECUTED
        return ACTIVE if self.control == idns.SET_AND_ENABLE else INTERRUPTED

    @property
    def diagnosis(self) -> str:
        """S-0-0095."""
        return self._reason if self.phase is Phase.FAILED else str(self.phase.value)

    @property
    def position(self) -> float:
        """S-0-0051."""
        return self.place + self.origin

    @property
    def set_position(self) -> float:
        """S-0-0047: of its own motion."""
        return (self._motion.position if self.leads else self.place) + self.origin

    @property
    def on_switch(self) -> bool:
        """S-0-0400."""
        return self._fault != NO_SWITCH and self._marks.on_cam(self.place)

    # what the master does

    def start(self, settings: HomingSettings) -> None:
        """Sets and enables the procedure, or enables it again."""
        self.control = idns.SET_AND_ENABLE
        if self.phase is Phase.IDLE:
            self._begin(settings)
        else:
            self._lead()

    def prepare(self) -> None:
        """Sets the procedure without the enable: a running one is interrupted, the drive stops on its ramp."""
        self.control = idns.SET
        if self.leads:
            self._lead()

    def cancel(self) -> None:
        """Takes the procedure away. The drive stops on its ramp; at a standstill it follows its cyclic commands."""
        self.control = 0
        if not self.leads:
            return
        if self._motion.rests:
            self.phase = Phase.IDLE
        else:
            self.phase = Phase.CANCELLED
            self._motion.to_velocity(0.0, self._limits(1.0))

    def set_override(self, ratio: float) -> None:
        """Feedrate override in steps of 0.01 %; stop ramps are not affected."""
        ratio = round(ratio * 10_000.0) / 10_000.0
        if ratio != self.override:
            self.override = ratio
            if self.phase in RUNNING:
                self._lead()

    # one cycle

    def next_velocity(self) -> float:
        """Velocity command of the drive's own position loop: its motion in this cycle, and Kv times its deviation."""
        motion = self._motion
        before = motion.position
        motion.advance()
        return (motion.position - before) / self._cycle_time + self._kv * (before - self.place)

    def watch(self, place: float, velocity: float) -> None:
        """Takes the encoder and the velocity at the end of the cycle."""
        self.place, self.velocity = place, velocity
        if self.phase is Phase.IDLE:
            return
        if self.phase in SEARCHING:
            self._search()
        elif self.phase is Phase.TO_REFERENCE:
            self._settle()
        elif self.phase is Phase.CANCELLED and self._motion.rests:
            self.phase = Phase.IDLE

    # phases

    def _begin(self, settings: HomingSettings) -> None:
        """What was known of the reference point is lost."""
        self._settings, self.referenced = settings, False
        self._motion.begin(self.place)
        if settings.velocity == 0.0:
            self._fail("the homing velocity S-0-0041 is 0")
        elif settings.bits & idns.WITHOUT_SWITCH:
            self._armed_at = self.place
            self._enter(Phase.TO_MARKER)
        else:
            self._enter(Phase.OFF_SWITCH if self.on_switch else Phase.TO_SWITCH)

    def _enter(self, phase: Phase) -> None:
        self.phase, self._phase_begin = phase, self.place
        self._lead()

    def _lead(self) -> None:
        """Makes the profile of the phase with the active override; none without enable."""
        settings, motion = self._settings, self._motion
        ratio = self.override if self.control == idns.SET_AND_ENABLE else 0.0
        if self.phase in SEARCHING:
            direction = -settings.direction if self.phase is Phase.OFF_SWITCH else settings.direction
            motion.to_velocity(direction * ratio * settings.velocity, self._limits(1.0))
        elif self.phase is Phase.TO_REFERENCE:
            if ratio > 0.0 and settings.bits & idns.AT_REFERENCE:
                motion.to_position(self._mark, self._limits(ratio))
            else:
                motion.to_velocity(0.0, self._limits(1.0))

    def _limits(self, ratio: float) -> Limits:
        settings = self._settings
        return Limits(ratio * settings.velocity or 1.0, settings.acceleration, settings.acceleration, settings.jerk)

    def _search(self) -> None:
        if self.phase is Phase.OFF_SWITCH and not self.on_switch:
            self._enter(Phase.TO_SWITCH)
        elif self.phase is Phase.TO_SWITCH and self.on_switch:
            self._switch_found()
        elif self.phase is Phase.TO_MARKER:
            self._look_for_marker()
        if self.phase in SEARCHING and abs(self.place - self._phase_begin) > self._range:
            self._fail(self._missing())

    def _switch_found(self) -> None:
        if self._settings.bits & idns.WITHOUT_MARKER:
            self._found(self.place)
            return
        self._armed_at = self._marks.cam_begin
        self._enter(Phase.TO_MARKER)
        self._look_for_marker()

    def _look_for_marker(self) -> None:
        before, self._armed_at = self._armed_at, self.place
        mark = None if self._fault == NO_MARKER else self._marks.pulse(before, self.place)
        if mark is not None:
            self._found(mark)

    def _found(self, mark: float) -> None:
        """The place of the reference is known."""
        if self._fault == ABORTED:
            self._fail("excessive position deviation")
            return
        self._mark = mark
        self._enter(Phase.TO_REFERENCE)

    def _settle(self) -> None:
        """At rest in its windows, the drive counts from the reference."""
        motion = self._motion
        deviation = motion.position - self.place
        if not motion.rests or self._fault == NO_ANSWER or abs(deviation) > self._position_window:
            return
        missed = bool(self._settings.bits & idns.AT_REFERENCE) and motion.position != self._mark
        if missed or abs(self.velocity) > self.standstill_window:
            return
        self.phase = Phase.DONE
        if self._fault != NO_REFERENCE:
            self.origin = self._settings.reference - self._mark
            self.referenced = True

    def _fail(self, reason: str) -> None:
        self.phase, self._reason = Phase.FAILED, reason
        self._motion.to_velocity(0.0, self._limits(1.0))

    def _missing(self) -> str:
        """What the active phase has not found."""
        if self.phase is Phase.OFF_SWITCH:
            return f"the home switch was not switched off within {self._range:g} {self._unit}"
        signal = "home switch" if self.phase is Phase.TO_SWITCH else "marker pulse"
        return f"no {signal} within {self._range:g} {self._unit}"
