"""The spindle: endless rotation on speed ramps in a position loop, with speed monitoring."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, NoReturn

from cnc_ptp.axis.states import state_name
from cnc_ptp.control.drive import Drive, SimulatedDrive
from cnc_ptp.control.position_controller import PositionController
from cnc_ptp.errors import CncError
from cnc_ptp.machine.blocks import AxisStateCode, Block, CycleTick, Severity, SpindleBlock, SpindleMode
from cnc_ptp.machine.unit import UPSTREAM_LOST, Unit
from cnc_ptp.motion import Profile
from cnc_ptp.parameters import SpindleParameters
from cnc_ptp.spindle.speed_ramp import plan_speed

BAD_SPEED = 24001
SPEED_TOO_HIGH = 24002
NOT_READY = 24003
STILL_TURNING = 24004
BAD_OVERRIDE = 24005
FOLLOWING_ERROR = 0x4550
AGAINST_PREFERRED_DIRECTION = 60254

DEG_S_PER_RPM = 6.0
S = AxisStateCode


class SpindleUnit(Unit):
    """One NC spindle: M03/M04 with a speed, M05, override, speed reached and speed zero.

    Speeds inside are deg/s, + = M03. Source: TF5200 spindle 2.3.1, 2.4.1, 2.6.
    """

    kind: ClassVar[str] = "spindle"

    def __init__(self, parameters: SpindleParameters, *, cycle_time: float, drive: Drive | None = None) -> None:
        """`cycle_time` in s; without `drive` the simulated one of the parameters is used."""
        super().__init__(parameters.name)
        self._parameters = parameters
        self._gear = parameters.gears[parameters.gear]
        self._cycle_time = cycle_time
        self._controller = PositionController(
            kv=self._gear.kv,
            following_error_limit=self._gear.following_error_limit,
            monitoring=self._gear.following_error_monitoring,
        )
        self._drive: Drive = drive or SimulatedDrive(
            cycle_time=cycle_time,
            time_constant=parameters.drive_time_constant,
            encoder_increment=self._gear.encoder_increment,
            start_position=parameters.start_position,
        )
        self._origin = 0
        self._profile: Profile = plan_speed(parameters.start_position, 0.0, 0.0, acceleration=1.0, deceleration=1.0)
        self._commanded_speed = 0.0
        self._wanted_speed = 0.0
        """Where the ramp in work leads to: the commanded speed under the override, deg/s."""
        self._override_percent = min(100.0, parameters.max_override_percent)
        self._mode = SpindleMode.STOP
        self._state = S.STANDSTILL if parameters.powered_at_start else S.DISABLED
        self._error_id = 0

    # commands

    def do_start(self, cycle: int, *, direction: str, speed_rpm: float) -> None:
        """M03 (cw) or M04 (ccw) at `speed_rpm`. Refusals 24001–24003; 60254 puts the spindle into ErrorStop."""
        if self._state == S.ERROR_STOP:
            self._refuse("start", NOT_READY, f"the spindle is in ErrorStop (P-ERR-{self._error_id}); reset it first")
        if self._state == S.DISABLED:
            self._refuse("start", NOT_READY, "the spindle is in Disabled, the machine starts it without power")
        self._check_speed("start", speed_rpm)
        sign = 1.0 if direction == "cw" else -1.0
        self._check_preferred_direction(cycle, direction, sign)
        self._mode = SpindleMode.CW if direction == "cw" else SpindleMode.CCW
        self._commanded_speed = sign * speed_rpm * DEG_S_PER_RPM
        self._state = S.CONTINUOUS_MOTION
        self._ramp(cycle)

    def do_set_speed(self, cycle: int, *, speed_rpm: float) -> str | None:
        """An S word alone: a new speed in the same direction; without effect while the spindle does not rotate."""
        self._check_speed("set_speed", speed_rpm)
        if self._state != S.CONTINUOUS_MOTION:
            return f"spindle {self.name}: set_speed without effect in {state_name(self._state)}"
        sign = 1.0 if self._mode == SpindleMode.CW else -1.0
        self._commanded_speed = sign * speed_rpm * DEG_S_PER_RPM
        self._ramp(cycle)
        return None

    def _check_speed(self, command: str, speed_rpm: float) -> None:
        if speed_rpm < 0.0:
            self._refuse(command, BAD_SPEED, f"speed {speed_rpm} rpm must not be negative; the direction is cw or ccw")
        limit_rpm = self._gear.max_speed / DEG_S_PER_RPM
        if speed_rpm > limit_rpm:
            reason = f"speed {speed_rpm} rpm is above the maximum {limit_rpm:g} rpm (P-AXIS-00212)"
            self._refuse(command, SPEED_TOO_HIGH, reason)

    def do_stop(self, cycle: int) -> None:
        """M05: down to speed 0 with P-AXIS-00002."""
        if self._state in (S.ERROR_STOP, S.DISABLED):
            return
        self._mode = SpindleMode.STOP
        self._commanded_speed = 0.0
        self._state = S.STOPPING
        self._ramp(cycle)

    def do_set_override(self, cycle: int, *, percent: float) -> None:
        """Spindle override of endless rotation, 0 … P-AXIS-00109 %; the speed stays within P-AXIS-00212."""
        limit = self._parameters.max_override_percent
        if not 0.0 <= percent <= limit:
            reason = f"percent = {percent} is not within 0 ... {limit:g} (P-AXIS-00109)"
            self._refuse("set_override", BAD_OVERRIDE, reason)
        self._override_percent = float(percent)
        if self._state == S.CONTINUOUS_MOTION:
            self._ramp(cycle)

    def do_reset(self, cycle: int) -> None:
        """Leaves ErrorStop at standstill (24004 while turning); otherwise stops the spindle (CNC reset)."""
        if self._state != S.ERROR_STOP:
            self.do_stop(cycle)
            return
        if self._setpoint(cycle)[1] != 0.0:
            self._refuse("reset", STILL_TURNING, "the spindle still turns on its error ramp; wait for standstill")
        self._error_id = 0
        self._state = S.STANDSTILL

    def do_upstream_lost(self, cycle: int, *, source: str) -> None:
        """The watchdog: `source` (channel, PLC or clock) has sent nothing in time; the spindle stops."""
        if self._state not in (S.ERROR_STOP, S.DISABLED):
            self._fault(cycle, UPSTREAM_LOST, f"no block of '{source}' came within the watchdog time")

    # one block

    def step(self, tick: CycleTick, inputs: Mapping[str, Block]) -> SpindleBlock:
        """Computes one block; a spindle is moved by commands alone."""
        first_cycle, count = tick
        rows = [self._cycle(first_cycle + index) for index in range(count)]
        return SpindleBlock(first_cycle, count, *map(list, zip(*rows, strict=True)))

    def _cycle(self, cycle: int) -> tuple[float | int | bool, ...]:
        drive = self._drive
        position, speed, acceleration, _ = self._setpoint(cycle)
        if speed == 0.0 and self._state == S.STOPPING:
            self._state = S.STANDSTILL
        following_error = position - drive.position
        if self._error_id == 0 and self._controller.exceeds_limit(following_error):
            limit = self._gear.following_error_limit
            self._fault(
                cycle, FOLLOWING_ERROR, f"following error {following_error:.3f} deg exceeds {limit} deg (P-AXIS-00168)"
            )
        actual_speed = drive.velocity
        row = (
            speed / DEG_S_PER_RPM,
            actual_speed / DEG_S_PER_RPM,
            acceleration,
            position,
            drive.position,
            following_error,
            self._override_percent,
            self._mode,
            self._parameters.gear,
            self._speed_reached(actual_speed),
            abs(actual_speed) <= self._gear.zero_speed,
            self._parameters.referenced_at_start,
            self._state,
            self._error_id,
        )
        drive.step(self._controller.command_velocity(following_error) if self._state != S.DISABLED else 0.0)
        return row

    def _speed_reached(self, actual_speed: float) -> bool:
        """P-AXIS-00217: within the tolerance band around the commanded speed; for speed 0 the zero limit P-AXIS-00216.

        A spindle that override 0 holds has not reached its speed.
        """
        wanted = self._wanted_speed
        if wanted == 0.0:
            return self._commanded_speed == 0.0 and abs(actual_speed) <= self._gear.zero_speed
        return abs(actual_speed - wanted) <= self._parameters.speed_reached_band * abs(wanted)

    def _setpoint(self, cycle: int) -> tuple[float, float, float, float]:
        return self._profile.state_at((cycle - self._origin) * self._cycle_time)

    def _ramp(self, cycle: int) -> None:
        position, speed, _, _ = self._setpoint(cycle)
        limit = self._gear.max_speed
        self._wanted_speed = max(-limit, min(limit, self._commanded_speed * self._override_percent / 100.0))
        self._origin = cycle
        self._profile = plan_speed(
            position,
            speed,
            self._wanted_speed,
            acceleration=self._gear.acceleration,
            deceleration=self._gear.deceleration,
        )

    def _check_preferred_direction(self, cycle: int, direction: str, sign: float) -> None:
        preferred = self._parameters.preferred_direction
        if preferred and sign != preferred:
            word = "positive" if preferred > 0 else "negative"
            reason = f"{direction} contradicts the preferred direction of rotation (P-AXIS-00224, P-AXIS-00031: {word})"
            self._fault(cycle, AGAINST_PREFERRED_DIRECTION, reason)
            raise CncError(
                AGAINST_PREFERRED_DIRECTION,
                f"spindle {self.name}: start refused: {reason}; the spindle is in ErrorStop",
            )

    def _refuse(self, command: str, error_id: int, reason: str) -> NoReturn:
        raise CncError(error_id, f"spindle {self.name}: {command} refused: {reason}; nothing was changed")

    def _fault(self, cycle: int, error_id: int, reason: str) -> None:
        """Error reaction: down to speed 0 on the spindle's ramp, state ErrorStop."""
        self._error_id = error_id
        self._state = S.ERROR_STOP
        self._mode = SpindleMode.STOP
        self._commanded_speed = 0.0
        self._ramp(cycle)
        self.event(
            cycle, Severity.ERROR, error_id, f"spindle {self.name}: {reason}; the spindle stops on its ramp (ErrorStop)"
        )
