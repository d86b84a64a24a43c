"""Homing of an axis (G74): onto the reference cam, off it again, slowly to the zero pulse, which gives the coordinates.

| phase | direction | velocity | ends |
|---|---|---|---|
| TO_CAM | P-AXIS-00158 | P-AXIS-00219 | when the cam is switched on |
| OFF_CAM | against it | P-AXIS-00218, P-AXIS-00219 if P-AXIS-00064 says so | when the cam is switched off |
| TO_REFERENCE | P-AXIS-00158 | P-AXIS-00218 | with the first zero pulse on the cam, or the cam's edge (P-AXIS-00084) |

Each phase is a positioning over the distance of P-AXIS-00412, so that override, feed releases and stops act as on any
other; its signal stops it on its ramp. After the reference the axis stands where that ramp ends. Source: TF5200 homing.
"""

from __future__ import annotations

from enum import Enum, auto

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import HOMING_SIGNAL_MISSING
from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.control.drives.reference_marks import ReferenceMarks
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.parameters.view.homing_view import HomingParameters


class Phase(Enum):
    """Where a homing is; END: the reference is known, the axis comes to rest."""

    TO_CAM = auto()
    OFF_CAM = auto()
    TO_REFERENCE = auto()
    END = auto()


FOLLOWING = {Phase.TO_CAM: Phase.OFF_CAM, Phase.OFF_CAM: Phase.TO_REFERENCE}


class Homing:
    """The homing of one axis, cycle by cycle."""

    def __init__(self, axis: Axis, loop: ControlLoop) -> None:
        self._axis, self._loop = axis, loop
        self._marks = ReferenceMarks(axis.parameters.homing)
        self._phase = Phase.END
        self._was_on_cam = False
        self._position = axis.parameters.homing.reference_position
        self._armed_at: float | None = None
        """Where the encoder was when it last looked for the zero pulse; None: it does not look yet."""

    @property
    def _parameters(self) -> HomingParameters:
        return self._axis.parameters.homing

    @property
    def on_cam(self) -> bool:
        return self._marks.on_cam(self._loop.encoder)

    def begin(self, cycle: int, position: float) -> None:
        """Starts; the reference point will have `position`, mm (deg). What was known of it is lost."""
        self._axis.checks.referenced = False
        self._position = position
        parameters = self._parameters
        if parameters.without_cam or parameters.without_reversing:
            self._search(cycle, Phase.TO_REFERENCE)
        else:
            self._search(cycle, Phase.OFF_CAM if self.on_cam else Phase.TO_CAM)

    def _search(self, cycle: int, phase: Phase) -> None:
        axis, parameters = self._axis, self._parameters
        self._phase = phase
        self._was_on_cam, self._armed_at = False, self._loop.encoder if parameters.without_cam else None
        off_cam = phase is Phase.OFF_CAM
        fast = phase is Phase.TO_CAM or (off_cam and parameters.fast_off_cam)
        velocity = min(parameters.fast if fast else parameters.slow, axis.own_limits.velocity)
        direction = -parameters.direction if off_cam else parameters.direction
        target = axis.ptp.state(cycle)[0] + direction * parameters.range
        axis.ptp.start(cycle, target, axis.own_limits._replace(velocity=velocity))

    def watch(self, cycle: int, setpoint: MotionState) -> MotionState:
        """One cycle of the homing; returns its setpoint, which jumps with the coordinates at the reference."""
        axis = self._axis
        if axis.ptp.job is None:
            if axis.ptp.finished(cycle):
                self._go_on(cycle)
            return setpoint
        encoder = self._loop.encoder
        if self._phase is Phase.TO_REFERENCE:
            reference = self._reference(encoder)
            if reference is not None:
                return self._take_reference(cycle, setpoint, reference)
        elif self._cam_switches(encoder):
            axis.ptp.stop(cycle, axis.own_limits)
            return setpoint
        if axis.ptp.arrived(cycle):
            axis.fault(cycle, HOMING_SIGNAL_MISSING, self._missing(), values={"range": self._parameters.range})
        return setpoint

    def _go_on(self, cycle: int) -> None:
        """The axis has come to rest: the next phase, or the end."""
        self._axis.ptp.finish()
        if self._phase is Phase.END:
            self._axis.take(T.FINISH)
        else:
            self._search(cycle, FOLLOWING[self._phase])

    def _cam_switches(self, encoder: float) -> bool:
        """The signal that ends TO_CAM (on) or OFF_CAM (off again, if the axis stopped beyond a short cam)."""
        before, self._was_on_cam = self._was_on_cam, self._marks.on_cam(encoder)
        return self._was_on_cam if self._phase is Phase.TO_CAM else before and not self._was_on_cam

    def _reference(self, encoder: float) -> float | None:
        """The place of the reference on the encoder when the axis has passed it."""
        parameters = self._parameters
        if self._armed_at is None and self._marks.on_cam(encoder):
            if parameters.without_zero_pulse:
                return encoder
            self._armed_at = self._marks.cam_begin
        if self._armed_at is None:
            return None
        before, self._armed_at = self._armed_at, encoder
        return self._marks.pulse(before, encoder)

    def _take_reference(self, cycle: int, setpoint: MotionState, reference: float) -> MotionState:
        """From now on the place of the reference has its position; the axis stops."""
        axis, loop = self._axis, self._loop
        distance = self._position - (reference + loop.offset)
        loop.shift(distance)
        position, velocity, acceleration, jerk = setpoint
        position += distance
        axis.ptp.take_over(cycle, position, velocity, acceleration)
        axis.ptp.stop(cycle, axis.own_limits)
        axis.checks.referenced, axis.checks.coordinate_shift = True, 0.0
        self._phase = Phase.END
        return position, velocity, acceleration, jerk

    def _missing(self) -> str:
        """What the active phase has not found."""
        range_text = f"{self._parameters.range:g} {self._axis.unit} (P-AXIS-00412)"
        if self._phase is Phase.OFF_CAM:
            return f"homing: the reference cam was not switched off within {range_text}"
        signal = "reference cam" if self._phase is Phase.TO_CAM or self._armed_at is None else "zero pulse"
        return f"homing: no {signal} within {range_text}"
