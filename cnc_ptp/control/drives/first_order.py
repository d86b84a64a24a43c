"""The plain simulated drive: a first-order lag in the velocity."""

from __future__ import annotations

import math

from mypy_extensions import mypyc_attr

from cnc_ptp.control.drives.drive import Drive

NEGLIGIBLE = 1e-12
"""mm/s or deg/s; a smaller lag is 0, so that a drive comes to rest exactly."""
FASTEST = 1e9
"""mm/s or deg/s; bounds an unstable loop before numbers overflow."""


@mypyc_attr(allow_interpreted_subclasses=True)
class FirstOrderDrive(Drive):
    """Velocity-controlled drive as a first-order lag G(s) = 1 / (1 + Ta s) before an integrator and an encoder.

    dv/dt = (u - v) / Ta + M / k with u = command + additive velocity, M the additive torque, k the torque for a unit
    of acceleration. All are held over a cycle, so the discrete solution is exact; with u' = u + Ta M / k:
    v(T) = u' + (v0 - u') e^(-T/Ta), x(T) = x0 + u' T + (v0 - u') Ta (1 - e^(-T/Ta)).
    `torque` is the mean of k dv/dt over the last cycle. Source: TF5200 feedforward, figure 1 and 4.2.
    """

    __slots__ = (
        "_cycle_time",
        "_decay",
        "_encoder_increment",
        "_lag_time",
        "_torque_per_change",
        "_true_position",
        "_velocity_per_torque",
    )

    def __init__(
        self,
        *,
        cycle_time: float,
        time_constant: float,
        encoder_increment: float,
        start_position: float = 0.0,
        torque_per_acceleration: float = 0.0,
    ) -> None:
        """`cycle_time` and `time_constant` in s, `encoder_increment` in mm or deg (0 = ideal encoder).

        `time_constant` 0 is an ideal drive: no lag, and no additive torque can move it. `torque_per_acceleration` in
        Nm (N) for 1 mm/s² (deg/s²); with 0 the drive has no inertia: it reports no torque and ignores additive torques.
        """
        super().__init__(position=start_position, has_torque=torque_per_acceleration > 0.0)
        self._cycle_time = cycle_time
        self._decay = math.exp(-cycle_time / time_constant) if time_constant > 0.0 else 0.0
        self._lag_time = time_constant * (1.0 - self._decay)
        self._velocity_per_torque = time_constant / torque_per_acceleration if torque_per_acceleration else 0.0
        self._torque_per_change = torque_per_acceleration / cycle_time
        self._encoder_increment = encoder_increment
        self._true_position = start_position
        self.step(0.0)  # stands; shows the position as the encoder does

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """Holds the velocities `command` and `additive_velocity` (mm/s, deg/s) and the torque (Nm, N) for one cycle."""
        wanted = command + additive_velocity + additive_torque * self._velocity_per_torque
        if not -FASTEST < wanted < FASTEST:
            wanted = math.copysign(FASTEST, wanted)
        before = self.velocity
        surplus = before - wanted
        if -NEGLIGIBLE < surplus < NEGLIGIBLE:
            surplus = 0.0
        self._true_position += wanted * self._cycle_time + surplus * self._lag_time
        self.velocity = velocity = wanted + surplus * self._decay
        self.torque = (velocity - before) * self._torque_per_change
        increment = self._encoder_increment
        self.position = round(self._true_position / increment) * increment if increment else self._true_position
