"""Reference cam and zero pulses of a simulated axis, as its encoder counts."""

from __future__ import annotations

from math import ceil, floor, inf

from cnc_ptp.parameters.view.homing_view import HomingParameters


class ReferenceMarks:
    """Where the cam is switched on, and where the encoder gives its zero pulses; all in mm (deg)."""

    def __init__(self, parameters: HomingParameters) -> None:
        self._begin, self._direction = parameters.cam_position, parameters.direction
        self._length = parameters.cam_length or inf
        self._pulse = parameters.cam_position + parameters.direction * parameters.to_zero_pulse
        self._distance = parameters.pulse_distance

    @property
    def cam_begin(self) -> float:
        """The edge of the cam that an axis meets in the direction of homing."""
        return self._begin

    def on_cam(self, encoder: float) -> bool:
        return 0.0 <= self._direction * (encoder - self._begin) <= self._length

    def pulse(self, before: float, now: float) -> float | None:
        """The first zero pulse behind `before`, if the encoder has passed it on its way to `now`."""
        if before == now:
            return None
        if self._distance == 0.0:
            passed = before < self._pulse <= now or now <= self._pulse < before
            return self._pulse if passed else None
        turns = (before - self._pulse) / self._distance
        mark = self._pulse + (floor(turns) + 1 if now > before else ceil(turns) - 1) * self._distance
        passed = mark <= now if now > before else mark >= now
        return mark if passed else None
