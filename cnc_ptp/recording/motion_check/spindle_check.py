"""The motion of one spindle."""

from __future__ import annotations

from math import inf

import numpy as np

from cnc_ptp.parameters import GearParameters
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.spindle_states import SpindleBit as B
from cnc_ptp.recording.motion_check.axis_check import is_power, setpoints_of
from cnc_ptp.recording.motion_check.continuity import check_continuity
from cnc_ptp.recording.motion_check.findings import Findings, Mask, MotionResult
from cnc_ptp.recording.motion_check.inputs import MotionInputs, Order
from cnc_ptp.recording.motion_check.laws import FREE, ON_PATH, STEP, Laws, Stretches, and_next
from cnc_ptp.recording.motion_check.limits import check_limits, check_numbers, check_rest

SWITCHES = B.POSITION_CONTROL | B.VELOCITY_CONTROL | B.MONITORING_INVALID
"""Of the position loop: when it opens or closes, the set position goes to where the spindle is."""
STARTS = frozenset({"start", "set_speed", "orient", "home", "select_gear", "gear_changed", "follow_path"})
STOPS = frozenset({"stop", "reset", "set_emergency_stop", "upstream_lost"})


class SpindleCheck:
    """Checks one spindle."""

    def __init__(self, name: str, inputs: MotionInputs, result: MotionResult) -> None:
        self.inputs, self.name = inputs, name
        self.parameters = inputs.machine.spindles[name]
        self.orders = inputs.orders_of(name)
        self.columns = inputs.spindles[name]
        self.cycles = self.columns["cycle"]
        self.state, self.bits = self.columns["state"], self.columns["status_bits"].astype(np.int64)
        speed = self.columns["set_speed_rpm"] * DEG_S_PER_RPM
        named = {
            "cycle": self.cycles,
            "set_position": self.columns["set_position_deg"],
            "set_velocity": speed,
            "set_acceleration": self.columns["set_acceleration_deg_s2"],
        }
        self.points = setpoints_of(named, inputs.cycle_time, "deg")
        self.found = Findings(name, self.cycles, inputs.cycle_time, result)
        self.laws = self._laws()

    def check(self) -> None:
        """Everything."""
        check_numbers(self.points, self.found)
        check_continuity(self.points, self.laws, self.found)
        check_limits(self.points, self.laws, self.found)
        placed = self.laws.placed
        check_rest(self.points, self.state == S.DISABLED, placed, self.found, "without power")
        check_rest(self.points, self.state == S.STANDSTILL, placed, self.found, "at a standstill")
        self._check_owner()
        self._check_channels()

    def _laws(self) -> Laws:
        laws = Laws.of(len(self.cycles), growth=inf, reduction=inf, jerk=inf, velocity=inf, law=STEP)
        for stage in np.unique(self.columns["gear"]):
            gear, rows = self.parameters.gears.get(int(stage)), self.columns["gear"] == stage
            if gear is not None:
                most = strongest(gear)
                laws.growth[rows] = laws.reduction[rows] = most
                laws.velocity[rows] = gear.max_speed
        laws.placed |= self._placed()
        on_path = and_next((self.bits & B.ON_PATH) != 0)
        laws.relative[on_path] = ON_PATH
        opened = (np.diff(self.bits & B.POSITION_CONTROL) != 0) & self.parameters.open_loop
        laws.permit(np.concatenate(([False], opened)), FREE)
        return laws

    def _placed(self) -> Mask:
        """Pairs with other coordinates: reference, gear, loop opened or closed, power, a fault without power."""
        columns = self.columns
        changes: Mask = (np.diff(columns["gear"].astype(int)) != 0) | (np.diff(columns["referenced"].astype(int)) != 0)
        changes |= np.diff(self.bits & SWITCHES) != 0
        changes |= (self.state[:-1] == S.DISABLED) & (self.state[1:] != S.DISABLED)
        changes |= (self.state[1:] == S.HOMING) | (self.state[:-1] == S.HOMING)
        still = self.points.velocity == 0.0
        for order in filter(is_power, self.inputs.orders_of(self.name)):  # off and on again within a block
            row = int(np.searchsorted(self.cycles, order.cycle))
            if 0 < row < len(still):
                changes[row - 1] |= still[row - 1] & still[row]
        return changes

    # owner

    def _check_owner(self) -> None:
        """A spindle that speeds up does so for a command that no stop has ended, for a path, or for its master."""
        speed = np.abs(self.points.velocity)
        faster = np.concatenate(([False], self.points.joined & (speed[1:] > speed[:-1])))
        led = ((self.bits & B.ON_PATH) != 0) | (self.state == S.SYNCHRONIZED_MOTION)
        wrong = faster & ~led & ~self._owned()
        self.found.above("speeds up without an owner", self.points.velocity, np.zeros(len(speed)), wrong, "deg/s")

    def _check_channels(self) -> None:
        """Behind the last cycle of the channel for which it turns, and the time of the watchdog, it only slows down."""
        speed = np.abs(self.points.velocity)
        slows = np.concatenate(([True], ~(speed[1:] >= speed[:-1]) | ~self.points.joined))
        for name, cycles in self.inputs.channels.items():
            rows = self._turns_for(name) & (speed > 0.0) & ~slows
            machine = self.inputs.machine
            patience = machine.watchdog_ms * 1000 // machine.cycle_time_us + 3 * machine.block_cycles
            wrong = rows & (self.cycles > cycles[-1] + patience)
            self.found.above(
                "turns for a channel that is gone", self.points.velocity, np.zeros(len(speed)), wrong, "deg/s"
            )

    def _turns_for(self, channel: str) -> Mask:
        """Rows behind the commands of a channel, up to those of another source."""
        stretches = Stretches(self.cycles, np.zeros(len(self.cycles), dtype=bool))
        rows = np.zeros(len(self.cycles), dtype=bool)
        for order in self.orders:
            if order.command in STARTS | STOPS:
                rows[stretches.row(order.cycle) :] = order.arguments.get("source") == channel
        return rows

    def _owned(self) -> Mask:
        """Rows behind a command that turns the spindle or its master, up to the next stop.

        Of a recording that begins later than the run nobody knows the commands before it.
        """
        stretches = Stretches(self.cycles, np.zeros(len(self.cycles), dtype=bool))
        owned = np.zeros(len(self.cycles), dtype=bool)
        for unit in self._leaders():
            late = bool(len(self.cycles)) and self.cycles[0] > 0
            of_unit = np.full(len(self.cycles), late)
            commander = ""
            for order in self.inputs.orders_of(unit):
                row, source = stretches.row(order.cycle), str(order.arguments.get("source", ""))
                if order.command in STARTS:
                    of_unit[row:], commander = True, source
                elif order.command in STOPS and not is_without_effect(order, source, commander):
                    of_unit[row + 1 :] = False
            owned |= of_unit
        return owned | self._homes()

    def _homes(self) -> Mask:
        """A spindle that homes before it stops searches for its marker, also where a stop has begun that."""
        owned: Mask = self.state == S.HOMING
        return owned

    def _leaders(self) -> set[str]:
        """The spindle itself, and what it was ever coupled to."""
        leaders, waiting = set(), [self.name]
        while waiting:
            unit = waiting.pop()
            if unit not in leaders:
                leaders.add(unit)
                couplings = [order for order in self.inputs.orders_of(unit) if order.command == "couple"]
                waiting += [str(order.arguments["master"]) for order in couplings]
        return leaders


def is_without_effect(order: Order, source: str, commander: str) -> bool:
    """A stop that counts only while nobody else has commanded the spindle since, and the end of an emergency stop."""
    if order.command == "set_emergency_stop":
        return order.arguments.get("enabled") is False
    return order.arguments.get("own") is True and commander not in ("", source)


def strongest(gear: GearParameters) -> float:
    """The largest acceleration of a gear, deg/s²: of its ramps and its curve."""
    of_curve = 0.0 if gear.curve is None else max(gear.curve.maximum, gear.curve.constant, gear.curve.minimum)
    return max(gear.acceleration, gear.deceleration, gear.emergency_deceleration, of_curve)
