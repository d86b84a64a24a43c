"""Function blocks that move a unit: positionings, velocity, stop, homing.

Positions in mm (°), velocities in mm/s (°/s), of spindles in rpm. Dynamics that are None come from the axis parameters.
"""

from __future__ import annotations

from numbers import Real
from typing import Any, ClassVar

from cnc_ptp.axis.faults import IN_BRAKE_PHASE
from cnc_ptp.plc.plcopen.buffer_mode import ABORTING
from cnc_ptp.plc.plcopen.execute_block import EndlessBlock, ExecuteBlock
from cnc_ptp.plc.plcopen.faults import NO_RAMPS
from cnc_ptp.plc.plcopen.unit_reference import UnitReference
from cnc_ptp.protocol.blocks import AxisBlock, SpindleBlock

EXACT = 1e-9
"""Part of a velocity: rounding of a setpoint."""


class PositionBlock(ExecuteBlock):
    """Positioning to `position`. Dynamics that are None come from the axis parameters."""

    command: ClassVar[str]
    argument: ClassVar[str]
    """Of the command: the position."""

    def __call__(
        self,
        execute: bool,
        position: float = 0.0,
        velocity: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
        buffer_mode: str = ABORTING,
    ) -> None:
        if self._rises(execute):
            motion = dynamics_of(acceleration, deceleration, jerk) | {self.argument: position, "velocity": velocity}
            self._start(self.command, buffer_mode, **motion)


class DistanceBlock(ExecuteBlock):
    """Positioning over `distance`. Dynamics that are None come from the axis parameters."""

    command: ClassVar[str]

    def __call__(
        self,
        execute: bool,
        distance: float = 0.0,
        velocity: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
        buffer_mode: str = ABORTING,
    ) -> None:
        if self._rises(execute):
            motion = dynamics_of(acceleration, deceleration, jerk) | {"distance": distance, "velocity": velocity}
            self._start(self.command, buffer_mode, **motion)


class MC_MoveAbsolute(PositionBlock):
    """Positioning to `position`."""

    command = "move_absolute"
    argument = "target"


class MC_MoveModulo(PositionBlock):
    """Positioning of a modulo axis; the sign of `position` is the direction, its magnitude has whole turns in it."""

    command = "move_modulo"
    argument = "position"


class MC_MoveRelative(DistanceBlock):
    """Positioning over `distance` from the set position at which it begins."""

    command = "move_relative"


class MC_MoveAdditive(DistanceBlock):
    """Positioning over `distance` from the target of the motion before."""

    command = "move_additive"


class MC_MoveSuperimposed(ExecuteBlock):
    """Adds `distance` to the motion of an axis, at most `velocity_difference` faster; that motion continues."""

    def __call__(
        self,
        execute: bool,
        distance: float = 0.0,
        velocity_difference: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
    ) -> None:
        if self._rises(execute):
            motion = dynamics_of(acceleration, deceleration, jerk)
            self._start("move_superimposed", distance=distance, velocity_difference=velocity_difference, **motion)


class MC_MoveVelocity(EndlessBlock):
    """Motion at `velocity` until another command; its sign is the direction. Of a spindle in rpm, + is M03."""

    def __init__(self, unit: UnitReference) -> None:
        super().__init__(unit)
        self._velocity = 0.0

    @property
    def in_velocity(self) -> bool:
        """The unit moves at the commanded velocity times its override."""
        return self._reached

    def __call__(
        self,
        execute: bool,
        velocity: float = 0.0,
        acceleration: float | None = None,
        deceleration: float | None = None,
        jerk: float | None = None,
        buffer_mode: str = ABORTING,
    ) -> None:
        if not self._rises(execute):
            return
        self._velocity = velocity
        ramps = dynamics_of(acceleration, deceleration, jerk)
        if self.unit.kind == "spindle" and any(value is not None for value in ramps.values()):
            reason = "a spindle has the ramps of its gear, no acceleration, deceleration or jerk is possible"
            self._fail(NO_RAMPS, f"{self._where}: MC_MoveVelocity refused: {reason}; nothing was changed")
        elif self.unit.kind == "spindle":
            turns = isinstance(velocity, Real)  # the command refuses what is no number
            direction = "ccw" if turns and velocity < 0.0 else "cw"
            self._start("start", buffer_mode, direction=direction, speed_rpm=abs(velocity) if turns else velocity)
        else:
            self._start("move_velocity", buffer_mode, velocity=velocity, **ramps)

    def _while_active(self) -> None:
        block = self.unit.block
        if isinstance(block, SpindleBlock):
            self._reached = block.speed_reached[-1] and block.set_acceleration_deg_s2[-1] == 0.0
        elif isinstance(block, AxisBlock):
            wanted = self._velocity * block.override_percent[-1] / 100.0
            self._reached = abs(block.set_velocity[-1] - wanted) <= EXACT * abs(self._velocity)


class MC_Halt(ExecuteBlock):
    """Stops on the ramp of the motion; another motion may follow at once."""

    def __call__(self, execute: bool) -> None:
        if self._rises(execute):
            self._start("stop" if self.unit.kind == "spindle" else "halt")


class MC_Stop(ExecuteBlock):
    """Stops, and holds the unit in Stopping until that is done and `execute` is false: nobody moves it then.

    With `deceleration` or `jerk` an axis stops on a ramp of its own, never weaker than that of the motion. A spindle
    stops on the ramp of its gear in any case.
    """

    moves = False

    def __init__(self, unit: UnitReference) -> None:
        super().__init__(unit)
        self._holds = False

    def __call__(self, execute: bool, deceleration: float | None = None, jerk: float | None = None) -> None:
        if not self._rises(execute):
            if self.error or not (self.execute or self.busy):
                self._hold(False)
            return
        if self.unit.kind == "spindle" or (deceleration is None and jerk is None):
            self._start("stop")
        else:
            self._start("emergency_stop", deceleration=deceleration, jerk=jerk)
        self._hold(True)

    def _hold(self, holds: bool) -> None:
        """The first block that holds the unit and the last one give the command."""
        before = self.unit.stops
        self.unit.stops += int(holds) - int(self._holds)
        self._holds = holds
        if bool(self.unit.stops) != bool(before):
            self.unit.give("hold_stop", enabled=holds)

    def _refused(self, error_id: int, text: str) -> None:
        """An axis that brakes naturally takes no stronger ramp, but a stop."""
        if error_id == IN_BRAKE_PHASE:
            self._start("stop")
        else:
            super()._refused(error_id, text)


class MC_Home(ExecuteBlock):
    """Homing, as the parameters of the unit say; the reference point of an axis gets `position`, or P-AXIS-00152."""

    def __call__(self, execute: bool, position: float | None = None) -> None:
        if self._rises(execute):
            self._start("home", position=position)


class MC_OrientSpindle(ExecuteBlock):
    """M19: positioning of a spindle to `position` within a turn, at `velocity` in rpm, P-AXIS-00209 without it."""

    def __call__(
        self,
        execute: bool,
        position: float = 0.0,
        velocity: float | None = None,
        direction: str | None = None,
        buffer_mode: str = ABORTING,
    ) -> None:
        if self._rises(execute):
            self._start("orient", buffer_mode, position_deg=position, speed_rpm=velocity, direction=direction)


def dynamics_of(acceleration: float | None, deceleration: float | None, jerk: float | None) -> dict[str, Any]:
    """As arguments of a command."""
    return {"acceleration": acceleration, "deceleration": deceleration, "jerk": jerk}
