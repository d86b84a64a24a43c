"""The motion of one axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

import numpy as np

from cnc_ptp.parameters import AxisParameters
from cnc_ptp.parameters.check.runtime_change import changed
from cnc_ptp.parameters.view.axis_view import axis_view
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit as B
from cnc_ptp.protocol.commands import COUPLINGS, HELD_OFF
from cnc_ptp.recording.motion_check.continuity import PLACES, Setpoints, check_continuity
from cnc_ptp.recording.motion_check.findings import Findings, Mask, MotionResult, Numbers
from cnc_ptp.recording.motion_check.inputs import Columns, MotionInputs, Order
from cnc_ptp.recording.motion_check.laws import FREE, ON_PATH, STEP, Laws, Stretches, since
from cnc_ptp.recording.motion_check.limits import check_limits, check_numbers, check_rest

LINEAR = ("couple", "couple_gantry")
ADDED = frozenset({"move_superimposed", "compensation_start"})
ABRUPT = frozenset({"emergency_stop", "set_emergency_stop"})
STARTS = HELD_OFF["axis"] | {"external_setpoints", "decouple", "set_coupling_factor", "set_cyclic_factor"}
"""Commands that may move an axis that a stop has brought to rest."""
STOPS = frozenset({"stop", "halt", "emergency_stop", "set_emergency_stop", "reset"})
DYNAMICS = ("acceleration", "deceleration", "jerk")


class AxisCheck:
    """Checks one axis; other axes of the run give the setpoints of its masters."""

    def __init__(self, name: str, inputs: MotionInputs, *, steps: bool, result: MotionResult) -> None:
        """`steps`: a path may step the acceleration (#SLOPE, P-CHAN-00071)."""
        self.inputs, self.name, self.steps = inputs, name, steps
        self.parameters: AxisParameters = inputs.machine.axes[name]
        self.orders: Sequence[Order] = inputs.orders_of(name)
        self.columns: Columns = inputs.axes[name]
        self.cycles = self.columns["cycle"]
        self.state, bits = self.columns["state"], self.columns["status_bits"].astype(np.int64)
        self.coupled: Mask = (bits & B.PROTECTED) != 0
        self.referenced: Mask = (bits & B.NOT_REFERENCED) == 0
        self.error: Mask = self.columns["error_id"] != 0
        self.points = setpoints_of(self.columns, inputs.cycle_time, "deg" if self.parameters.rotary else "mm")
        still = (self.points.velocity == 0.0) & (self.points.acceleration == 0.0)
        self.resting: Mask = still & ((bits & B.HAS_JOB) == 0)
        self.stretches = Stretches(self.cycles, self.resting)
        self.following: Mask = (self.state == S.SYNCHRONIZED_MOTION) | (self.coupled & (self.state == S.ERROR_STOP))
        self.slave: Mask = self.coupled & self.following
        self.on_path: Mask = (self.state == S.SYNCHRONIZED_MOTION) & ~self.coupled
        adds = (bits & (B.COMPENSATING | B.EXT_SETPOINT)) != 0
        self.added: Mask = since(adds, self.resting) | self.stretches.mask(self.orders, ADDED)
        self.external: Mask = since((bits & B.EXT_SETPOINT) != 0, self.resting)
        self.found = Findings(name, self.cycles, inputs.cycle_time, result)
        self.laws = self._own_laws()

    def check(self) -> None:
        """Everything."""
        check_numbers(self.points, self.found)
        told = self._take_orders()
        self._take_states()
        check_continuity(self.points, self.laws, self.found)
        check_limits(self.points, self.laws, self.found, told)
        self._check_power()
        self._check_soft_limits()
        self._check_couplings()
        self._check_stops()

    # what is permitted

    def _own_laws(self) -> Laws:
        own = self.parameters
        laws = Laws.of(
            len(self.cycles), growth=own.acceleration, reduction=own.deceleration, jerk=own.jerk, velocity=own.max_velocity
        )
        for order, parameters in self._written():
            rows = slice(self.stretches.row(order.cycle), None)
            laws.growth[rows], laws.reduction[rows] = parameters.acceleration, parameters.deceleration
            laws.jerk[rows], laws.velocity[rows] = parameters.jerk, parameters.max_velocity
        return laws

    def _written(self) -> list[tuple[Order, AxisParameters]]:
        """Parameters after each `write_parameter`."""
        found, raw = [], self.parameters.raw
        for order in self.orders:
            if order.command == "write_parameter" and raw is not None:
                raw = changed(raw, str(order.arguments["parameter"]), float(order.arguments["value"])).own
                found.append((order, axis_view(raw, self.inputs.cycle_time)))
        return found

    def _take_orders(self) -> Mask:
        """Limits that come with commands; returns the rows of abrupt stops."""
        told = np.zeros(len(self.cycles), dtype=bool)
        base = [self.laws.growth.copy(), self.laws.reduction.copy(), self.laws.jerk.copy()]
        for order in self.orders:
            rows = self.stretches.of(order.cycle)
            values = [order.number(name) for name in DYNAMICS]
            if order.command == "emergency_stop":
                values[0] = values[1]
            if order.command in ADDED:
                self._add(rows, base, values)
                continue
            for column, value in zip((self.laws.growth, self.laws.reduction, self.laws.jerk), values, strict=True):
                column[rows] = np.maximum(column[rows], value)
            if order.command in ABRUPT:
                told[rows] = True
                strongest = max(self.parameters.emergency_deceleration, self.parameters.deceleration)
                self.laws.reduction[rows] = np.maximum(self.laws.reduction[rows], strongest)
            elif order.command == "begin_trajectory":
                self._take_trajectory(rows, order)
        return told

    def _add(self, rows: slice, base: Sequence[Numbers], values: Sequence[float]) -> None:
        """A second motion, with its own limits or those of the axis, in addition."""
        up, down = (value or float(column[rows][:1].sum()) for value, column in zip(values[:2], base[:2], strict=True))
        for column in (self.laws.growth, self.laws.reduction):
            column[rows] += max(up, down)
        self.laws.jerk[rows] += values[2] or float(base[2][rows][:1].sum())

    def _take_trajectory(self, rows: slice, order: Order) -> None:
        """Without velocities it has steps of them, otherwise of the acceleration."""
        points = order.arguments["points"]
        bare = not points or len([value for value in points[0] if value is not None]) <= 2
        self.laws.permit(rows, FREE if bare else STEP)
        for column in (self.laws.growth, self.laws.reduction):
            column[rows] = np.maximum(column[rows], self.parameters.max_acceleration)

    def _take_states(self) -> None:
        laws, own = self.laws, self.parameters
        path = self.on_path
        strongest = max(own.acceleration, own.deceleration)
        for column in (laws.growth, laws.reduction):
            column[path] = np.maximum(column[path], strongest)
        laws.velocity[path] = max(own.max_velocity, own.rapid_velocity)
        laws.relative[path], laws.kinks[:] = ON_PATH, path
        if self.steps:
            laws.permit(path, STEP)
        laws.permit(self.added, STEP)
        laws.permit(self.external, FREE)
        for column in (laws.growth, laws.reduction):
            column[self.external] = np.maximum(column[self.external], own.max_acceleration)
        self._take_couplings()
        self._take_homings()
        laws.placed |= self._placed()

    def _take_couplings(self) -> None:
        """A slave has no limits of its own; decoupled in motion it keeps its velocity."""
        laws = self.laws
        laws.permit(self.slave, FREE)
        laws.velocity[since(self.slave, self.resting)] = inf
        laws.growth[self.slave] = laws.reduction[self.slave] = inf
        for rows, order, _ in self._couplings():
            if order.command == "couple_cyclic":
                bound = order.number("acc_bound")
                laws.law[rows & self.slave & ~self.added] = STEP
                laws.growth[rows & self.slave] = laws.reduction[rows & self.slave] = bound
        laws.growth[self.added & self.slave] = laws.reduction[self.added & self.slave] = inf

    def _take_homings(self) -> None:
        """The setpoints of a drive that homes the axis are its actual values."""
        if self.parameters.control.sercos is None:
            return
        led = (self.state == S.HOMING) | (self.points.position == self.columns["actual_position"])
        self.laws.permit(led, FREE)
        self.laws.growth[led] = self.laws.reduction[led] = self.laws.velocity[led] = inf
        self.laws.placed |= led[1:] | led[:-1]

    def _placed(self) -> Mask:
        """Pairs with other coordinates: set_position, the reference of a homing, power for an axis at a standstill."""
        placed = np.zeros(len(self.laws.placed), dtype=bool)
        still = self.points.velocity == 0.0
        for order in self.orders:
            row = self.stretches.row(order.cycle)
            if not 0 < row < len(self.cycles):
                continue
            powered = order.command == "power" and bool(order.arguments.get("enabled")) and still[row] and still[row - 1]
            placed[row - 1] |= order.command == "set_position" or powered
        homed = self.referenced[1:] & ~self.referenced[:-1] & (self.state[:-1] == S.HOMING)
        return placed | homed

    # rows

    def _check_power(self) -> None:
        """Without power, and in Standstill, the setpoint stays; without power the axis only comes to rest."""
        disabled: Mask = self.state == S.DISABLED
        check_rest(self.points, disabled, self.laws.placed, self.found, "without power")
        check_rest(self.points, self.state == S.STANDSTILL, self.laws.placed, self.found, "at a standstill")

    def _check_stops(self) -> None:
        """An axis that a stop has brought to rest stays there until a command that moves it, a path or a master."""
        stopped = np.zeros(len(self.cycles), dtype=bool)
        for order in self.orders:
            if order.command in STARTS:
                stopped[self.stretches.row(order.cycle) :] = False
            elif order.command in STOPS:
                rest = self.stretches.of(order.cycle).stop - 1
                stopped[rest:] = True
        moves = stopped & ~self.following & ~since(self.following, self.resting) & (self.points.velocity != 0.0)
        zero = np.zeros(len(self.cycles))
        self.found.above("moves although it was stopped", self.points.velocity, zero, moves, f"{self.points.length}/s")

    def _check_soft_limits(self) -> None:
        """No motion further out where the position is beyond a soft limit; soft limits move with set_position."""
        own, points = self.parameters, self.points
        low, high = (np.full(len(self.cycles), limit) for limit in (own.soft_limit_negative, own.soft_limit_positive))
        for order, parameters in self._written():
            rows = slice(self.stretches.row(order.cycle), None)
            low[rows], high[rows] = parameters.soft_limit_negative, parameters.soft_limit_positive
        shift = self._shift()
        free = ~self.referenced | self.error | since(self.slave | self.external, self.resting)
        blur = PLACES * np.spacing(np.abs(points.position) + np.abs(shift))
        dx = np.concatenate(([0.0], np.where(self.laws.placed, 0.0, np.diff(points.position))))
        for what, limit, beyond, outwards in (
            ("beyond the negative soft limit", low + shift, points.position < low + shift - blur, dx < 0.0),
            ("beyond the positive soft limit", high + shift, points.position > high + shift + blur, dx > 0.0),
        ):
            found = beyond & outwards & ~free
            self.found.above(what, points.position, limit, found, points.length)

    def _shift(self) -> Numbers:
        """By how much set_position has moved the coordinates, from what it did to the recorded positions."""
        steps = np.zeros(len(self.cycles))
        for order in self.orders:
            row = self.stretches.row(order.cycle)
            if order.command == "set_position" and 0 < row < len(self.cycles):
                moved = self.points.velocity[row - 1] * self.inputs.cycle_time
                steps[row] += self.points.position[row] - self.points.position[row - 1] - moved
        shift = np.cumsum(steps)
        homed = np.flatnonzero(np.concatenate(([False], self.referenced[1:] & ~self.referenced[:-1])))
        for row in homed:
            shift[row:] -= shift[row]
        return shift

    # couplings

    def _couplings(self) -> list[tuple[Mask, Order, Numbers]]:
        """Rows from each coupling to the next one, its command, and the factor in each row."""
        begins = [order for order in self.orders if order.command in COUPLINGS]
        found = []
        for number, order in enumerate(begins):
            begin = self.stretches.row(order.cycle)
            following = begins[number + 1 :]
            end = self.stretches.row(following[0].cycle) if following else len(self.cycles)
            rows = np.zeros(len(self.cycles), dtype=bool)
            rows[begin:end] = True
            factor = np.full(len(self.cycles), float(order.arguments.get("factor", 1.0)))
            for change in self.orders:
                if change.command == "set_coupling_factor" and order.cycle <= change.cycle:
                    factor[self.stretches.row(change.cycle) :] = float(change.arguments["factor"])
            found.append((rows, order, factor))
        return found

    def _check_couplings(self) -> None:
        """A slave of a linear coupling has `factor` times the velocity and the acceleration of its master."""
        for rows, order, factor in self._couplings():
            master = str(order.arguments["master"])
            if order.command in LINEAR and master in self.inputs.axes:
                self._check_linear(rows, factor, master)

    def _check_linear(self, rows: Mask, factor: Numbers, master: str) -> None:
        columns = self.inputs.axes[master]
        place = np.searchsorted(columns["cycle"], self.cycles)
        place = np.minimum(place, len(columns["cycle"]) - 1)
        there = columns["cycle"][place] == self.cycles
        if self.inputs.machine.axes[master].couple_to_actual:
            there &= (columns["state"][place] != S.DISABLED) & (columns["error_id"][place] == 0)
        rows = rows & self.slave & there & ~self.added
        for what, own, name, units in (
            ("velocity beside that of the master", self.points.velocity, "set_velocity", "/s"),
            ("acceleration beside that of the master", self.points.acceleration, "set_acceleration", "/s²"),
        ):
            wanted = factor * columns[name][place]
            wrong = rows & ~(np.abs(own - wanted) <= PLACES * np.spacing(np.abs(wanted)))
            self.found.above(what, own, wanted, wrong, self.points.length + units)
        masters = columns["set_position"][place]
        wanted = factor[1:] * np.diff(masters)
        blur = PLACES * (np.spacing(larger_of(self.points.position)) + np.abs(factor[1:]) * np.spacing(larger_of(masters)))
        pairs = rows[1:] & rows[:-1] & self.points.joined & ~self.laws.placed & (factor[1:] == factor[:-1])
        master_placed = (columns["set_velocity"][place][1:] == 0.0) & (columns["set_velocity"][place][:-1] == 0.0)
        own_step = np.diff(self.points.position)
        wrong = pairs & ~master_placed & ~(np.abs(own_step - wanted) <= blur)
        shown = [np.concatenate(([0.0], each)) for each in (own_step, wanted)]
        self.found.above(
            "distance beside that of the master", *shown, np.concatenate(([False], wrong)), self.points.length
        )


def larger_of(column: Numbers) -> Numbers:
    """|value| of each row or the next one, the larger."""
    return np.maximum(np.abs(column[:-1]), np.abs(column[1:]))


def setpoints_of(columns: Mapping[str, Numbers], cycle_time: float, length: str) -> Setpoints:
    cycles = columns["cycle"]
    last = float(cycles[-1]) * cycle_time if len(cycles) else 0.0
    return Setpoints(
        columns["set_position"],
        columns["set_velocity"],
        columns["set_acceleration"],
        np.diff(cycles) == 1,
        cycle_time,
        last,
        length,
    )
