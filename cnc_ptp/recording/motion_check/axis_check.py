"""The motion of one axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import chain
from math import inf

import numpy as np

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import AxisParameters
from cnc_ptp.parameters.check.runtime_change import changed
from cnc_ptp.parameters.view.axis_view import axis_view
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit as B
from cnc_ptp.protocol.commands import COUPLINGS, HELD_OFF
from cnc_ptp.recording.motion_check.continuity import PLACES, Setpoints, check_continuity, larger, of_later
from cnc_ptp.recording.motion_check.findings import Findings, Mask, MotionResult, Numbers
from cnc_ptp.recording.motion_check.inputs import Columns, MotionInputs, Order
from cnc_ptp.recording.motion_check.laws import FREE, ON_PATH, STEP, Laws, Stretches, and_next, since
from cnc_ptp.recording.motion_check.limits import check_actual, check_limits, check_numbers, check_rest

LINEAR = ("couple", "couple_gantry")
ADDED = ("move_superimposed", "compensation_start")
STARTS = HELD_OFF["axis"] | {"external_setpoints", "decouple", "set_coupling_factor", "set_cyclic_factor"}
"""Commands that may move an axis that a stop has brought to rest."""
STOPS = frozenset({"stop", "halt", "emergency_stop", "set_emergency_stop", "reset"})
RAMPS = STOPS - {"reset"}
"""Commands after which it must come to rest: by then at the latest …"""
PATIENCE = 1.5
"""… times the time of the ramp, and …"""
BEGINNING = 0.1
"""… seconds, for the blocks until it begins."""
DYNAMICS = ("acceleration", "deceleration", "jerk")


class AxisCheck:
    """Checks one axis; other axes of the run give the setpoints of its masters."""

    def __init__(self, name: str, inputs: MotionInputs, *, steps_from: float, result: MotionResult) -> None:
        """`steps_from`: cycle from which on a path may step the acceleration (#SLOPE, P-CHAN-00071)."""
        self.inputs, self.name, self.steps_from = inputs, name, steps_from
        self.parameters: AxisParameters = inputs.machine.axes[name]
        self.orders: Sequence[Order] = inputs.orders_of(name)
        self.written = self._written()
        """Parameters after each `write_parameter`."""
        self.ever = [self.parameters, *(parameters for _, parameters in self.written)]
        """All parameters that it has had."""
        self.most = max(each.max_acceleration for each in self.ever)
        """No command may ask for more (P-AXIS-00008), …"""
        self.most_abrupt = max(self.most, *(each.emergency_deceleration for each in self.ever))
        """… but for an emergency stop (P-AXIS-00003)."""
        self.columns: Columns = inputs.axes[name]
        self.cycles = self.columns["cycle"]
        self.state, bits = self.columns["state"], self.columns["status_bits"].astype(np.int64)
        self.referenced: Mask = (bits & B.NOT_REFERENCED) == 0
        self.error: Mask = self.columns["error_id"] != 0
        self.points = setpoints_of(self.columns, inputs.cycle_time, "deg" if self.parameters.rotary else "mm")
        still = (self.points.velocity == 0.0) & (self.points.acceleration == 0.0)
        self.resting: Mask = still & ((bits & B.HAS_JOB) == 0)
        self.stretches = Stretches(self.cycles, self.resting)
        coupled: Mask = (bits & B.PROTECTED) != 0
        synchronous: Mask = self.state == S.SYNCHRONIZED_MOTION
        self.follows: Mask = coupled & synchronous
        """It has the setpoints of a master."""
        self.led = and_next(self.follows | (coupled & (self.state == S.ERROR_STOP) & self._gantry_rows()))
        """The same, also in an error that it shares with its master, and where it has just ended."""
        self.on_path = and_next(synchronous & ~coupled)
        self.external: Mask = since((bits & B.EXT_SETPOINT) != 0, self.resting)
        adds = (bits & (B.COMPENSATING | B.EXT_SETPOINT)) != 0
        self.additions: list[list[Order]] = [self._given(name) for name in ADDED] + [self._decoupled_on_path()]
        """Commands for a second motion on top of another one, by kind."""
        self.added: Mask = since(adds, self.resting) | self.stretches.mask(chain(*self.additions))
        self.found = Findings(name, self.cycles, inputs.cycle_time, result)
        self.laws = self._own_laws()

    def check(self) -> None:
        """Everything."""
        check_numbers(self.points, self.found)
        calm = self._take_orders()
        self._take_states()
        check_continuity(self.points, self.laws, self.found)
        check_limits(self.points, self.laws, self.found, calm)
        self._check_power()
        self._check_soft_limits()
        self._check_couplings()
        self._check_stops()
        self._check_obedience()

    # what is permitted

    def _own_laws(self) -> Laws:
        own = self.parameters
        laws = Laws.of(
            len(self.cycles),
            growth=own.acceleration,
            reduction=own.deceleration,
            jerk=own.jerk,
            velocity=own.max_velocity,
        )
        for order, parameters in self.written:
            rows = slice(self.stretches.row(order.cycle), None)
            laws.growth[rows], laws.reduction[rows] = parameters.acceleration, parameters.deceleration
            laws.jerk[rows], laws.velocity[rows] = parameters.jerk, parameters.max_velocity
        return laws

    def _written(self) -> list[tuple[Order, AxisParameters]]:
        """Without a value that the axis cannot have had."""
        found, raw = [], self.parameters.raw
        for order in self.orders:
            if order.command == "write_parameter" and raw is not None:
                with suppress(CncError):
                    new = changed(raw, order.arguments["parameter"], float(order.arguments["value"])).own
                    found.append((order, axis_view(new, self.inputs.cycle_time)))
                    raw = new
        return found

    def _take_orders(self) -> Numbers:
        """Limits that come with commands; returns those of falling |v| in rows of abrupt stops, inf elsewhere (n,)."""
        laws, extra = self.laws, [self._limits_of(orders) for orders in self.additions]
        abrupt = laws.reduction.copy()
        for order in self.orders:
            rows = self.stretches.of(order.cycle)
            if order.command in ("emergency_stop", "set_emergency_stop"):
                self._take_abrupt(rows, order, abrupt)
            elif order.command not in ADDED:
                for column, name in zip((laws.growth, laws.reduction, laws.jerk), DYNAMICS, strict=True):
                    column[rows] = np.maximum(column[rows], self._asked(order, name))
            if order.command == "begin_trajectory":
                self._take_trajectory(rows, order)
        raised = abrupt > laws.reduction
        calm = np.where(raised, laws.reduction + sum(acceleration for acceleration, _ in extra), inf)
        laws.reduction = np.maximum(laws.reduction, abrupt)
        for acceleration, jerk in extra:
            laws.growth, laws.reduction = laws.growth + acceleration, laws.reduction + acceleration
            laws.jerk = laws.jerk + jerk
        return calm

    def _take_abrupt(self, rows: slice, order: Order, abrupt: Numbers) -> None:
        """P-AXIS-00003, or what the command asks for up to P-AXIS-00008; a jerk of it up to A/T."""
        own = self._parameters_at(order.cycle)
        asked = max(min(order.number("deceleration"), self.most_abrupt), own.emergency_deceleration, own.deceleration)
        abrupt[rows] = np.maximum(abrupt[rows], asked)
        jerk = min(order.number("jerk"), self.most_abrupt / self.inputs.cycle_time)
        self.laws.jerk[rows] = np.maximum(self.laws.jerk[rows], jerk)

    def _parameters_at(self, cycle: int) -> AxisParameters:
        before = [parameters for order, parameters in self.written if order.cycle <= cycle]
        return before[-1] if before else self.parameters

    def _asked(self, order: Order, name: str) -> float:
        """What a command asks for, up to P-AXIS-00008, of a jerk up to A/T; 0.0 if it does not say it."""
        return min(order.number(name), self.most / self.inputs.cycle_time if name == "jerk" else self.most)

    def _given(self, command: str) -> list[Order]:
        return [order for order in self.orders if order.command == command]

    def _decoupled_on_path(self) -> list[Order]:
        """What a master has added to a path ends on the axis' own ramp, while the path continues."""
        rows = [(order, self.stretches.row(order.cycle)) for order in self._given("decouple")]
        return [order for order, row in rows if self.on_path[row : row + 2].any()]

    def _limits_of(self, orders: Sequence[Order]) -> tuple[Numbers, Numbers]:
        """Acceleration and jerk of a second motion with its own limits or those of the axis, 0 without one."""
        acceleration, jerk = np.zeros(len(self.cycles)), np.zeros(len(self.cycles))
        for order in orders:
            rows = self.stretches.of(order.cycle)
            up, down, jerks = (self._asked(order, name) for name in DYNAMICS)
            asked = np.maximum(up or self.laws.growth[rows], down or self.laws.reduction[rows])
            acceleration[rows] = np.maximum(acceleration[rows], asked)
            jerk[rows] = np.maximum(jerk[rows], jerks or self.laws.jerk[rows])
        return acceleration, jerk

    def _take_trajectory(self, rows: slice, order: Order) -> None:
        """Without velocities it has steps of them, otherwise of the acceleration."""
        points = [row for row in order.arguments["points"] if isinstance(row, list)]
        bare = not points or len([value for value in points[0] if value is not None]) <= 2
        self.laws.permit(rows, FREE if bare else STEP)
        for column in (self.laws.growth, self.laws.reduction):
            column[rows] = np.maximum(column[rows], self.most)

    def _take_states(self) -> None:
        laws, own = self.laws, self.parameters
        path = self.on_path
        strongest = max(own.acceleration, own.deceleration)
        for column in (laws.growth, laws.reduction):
            column[path] = np.maximum(column[path], strongest)
            column[self.external] = np.maximum(column[self.external], self.most)
        laws.velocity[path] = max(own.max_velocity, own.rapid_velocity)
        laws.relative[path], laws.kinks = ON_PATH, path
        laws.permit(path & (self.cycles >= self.steps_from), STEP)
        laws.permit(self.added, STEP)
        laws.permit(self.external, FREE)
        self._take_unknown()
        self._take_couplings()
        self._take_homings()
        laws.placed |= self._placed()

    def _take_unknown(self) -> None:
        """Of a recording that begins within a motion nobody knows how it was commanded: its velocity is limited."""
        if len(self.cycles) and self.cycles[0] > 0 and not self.resting[0]:
            rows = self.stretches.of(int(self.cycles[0]))
            self.laws.permit(rows, FREE)
            self.laws.growth[rows] = self.laws.reduction[rows] = inf

    def _take_couplings(self) -> None:
        """A slave has no limits of its own; decoupled in motion it keeps its velocity."""
        laws = self.laws
        laws.permit(self.led, FREE)
        laws.velocity[since(self.led, self.resting)] = inf
        laws.growth[self.led] = laws.reduction[self.led] = inf
        for rows, order, _ in self._couplings():
            if order.command == "couple_cyclic":
                alone = rows & self.follows & ~self.added
                laws.law[alone] = STEP
                laws.growth[alone] = laws.reduction[alone] = order.number("acc_bound")

    def _take_homings(self) -> None:
        """The setpoints of a drive that homes the axis are its actual values."""
        if self.parameters.control.sercos is None:
            return
        led = and_next((self.state == S.HOMING) | (self.points.position == self.columns["actual_position"]))
        self.laws.permit(led, FREE)
        self.laws.growth[led] = self.laws.reduction[led] = self.laws.velocity[led] = inf
        self.laws.placed |= led[1:] | led[:-1]

    def _placed(self) -> Mask:
        """Pairs with other coordinates: set_position, the reference of a homing, power for an axis at a standstill."""
        placed = np.zeros(len(self.laws.placed), dtype=bool)
        still = self.points.velocity == 0.0
        for order in self.orders:
            row = self.stretches.row(order.cycle)
            if 0 < row < len(self.cycles):
                switched = still[row] and still[row - 1] and is_power(order)
                placed[row - 1] |= order.command == "set_position" or switched
        homed: Mask = self.referenced[1:] & ~self.referenced[:-1] & (self.state[:-1] == S.HOMING)
        return placed | homed

    # rows

    def _check_power(self) -> None:
        """Without power, and in Standstill, the setpoint stays; without power the axis only comes to rest."""
        disabled: Mask = self.state == S.DISABLED
        check_rest(self.points, disabled, self.laws.placed, self.found, "without power")
        check_rest(self.points, self.state == S.STANDSTILL, self.laws.placed, self.found, "at a standstill")
        blur = 2.0 * self.parameters.encoder_increment / self.inputs.cycle_time
        check_actual(self.columns["actual_velocity"], disabled, blur, self.found, self.points.length)

    def _check_stops(self) -> None:
        """An axis that a stop has brought to rest stays there until a command that moves it, a path or a master."""
        stopped = np.zeros(len(self.cycles), dtype=bool)
        for order in self.orders:
            if order.command in STARTS:
                stopped[self.stretches.row(order.cycle) :] = False
            elif order.command in STOPS:
                stopped[self.stretches.of(order.cycle).stop :] = True
        given = since(self.led | self.on_path, self.resting)
        moves = stopped & ~given & (self.points.velocity != 0.0)
        zero = np.zeros(len(self.cycles))
        self.found.above("moves although it was stopped", self.points.velocity, zero, moves, f"{self.points.length}/s")

    def _check_obedience(self) -> None:
        """An axis that gets a stop comes to rest, unless another command, a path or a master moves it meanwhile."""
        points, late = self.points, np.zeros(len(self.cycles), dtype=bool)
        others = self.led | self.on_path | self.external | self.added
        starts = [order.cycle for order in self.orders if order.command in STARTS]
        for order in self.orders:
            rows = self.stretches.of(order.cycle)
            if order.command not in RAMPS or order.arguments.get("enabled") is False or rows.start == rows.stop:
                continue
            begin = rows.start + self._longest_ramp(order, rows.start)
            again = min((self.stretches.row(cycle) for cycle in starts if cycle >= order.cycle), default=rows.stop)
            if not others[rows].any():
                late[begin : min(rows.stop, again)] = True
        moves = late & (points.velocity != 0.0)
        self.found.above("moves on after a stop", points.velocity, np.zeros(len(late)), moves, f"{points.length}/s")

    def _longest_ramp(self, order: Order, row: int) -> int:
        """Rows that a stop may take: the acceleration is turned round, the velocity braked, the acceleration ended.

        A motion may be stopped with the dynamics of the command that began it.
        """
        points, own = self.points, self.ever
        rests = np.flatnonzero(self.resting[:row])
        began = self.cycles[rests[-1]] if len(rests) else 0
        given = [each for each in self.orders if began <= each.cycle <= order.cycle]
        braking = min([*(each.deceleration for each in own), *(each.number("deceleration") or inf for each in given)])
        jerk = min([*(each.jerk for each in own), *(each.number("jerk") or inf for each in given)])
        acceleration, velocity = (abs(float(column[row])) for column in (points.acceleration, points.velocity))
        turned = (acceleration + braking) / jerk
        seconds = turned + (velocity + acceleration * turned) / braking + braking / jerk
        return int(min(len(self.cycles), (PATIENCE * seconds + BEGINNING) / points.cycle_time))

    def _check_soft_limits(self) -> None:
        """No motion further out where the position is beyond a soft limit; soft limits move with set_position."""
        own, points = self.parameters, self.points
        low, high = (np.full(len(self.cycles), limit) for limit in (own.soft_limit_negative, own.soft_limit_positive))
        for order, parameters in self.written:
            rows = slice(self.stretches.row(order.cycle), None)
            low[rows], high[rows] = parameters.soft_limit_negative, parameters.soft_limit_positive
        shift = self._shift()
        homing = self.state == S.HOMING  # it brakes behind its marker, wherever that is; or is stopped while it does
        free = and_next(since(self.led | self.external | homing, self.resting)) | self._unknown_shift()
        free |= ~self.referenced | self.error
        blur = PLACES * np.spacing(np.abs(points.position) + np.abs(shift))
        blur += np.where(shift != 0.0, own.jerk * points.cycle_time**3, 0.0)
        dx = np.concatenate(([0.0], np.where(self.laws.placed, 0.0, np.diff(points.position))))
        for what, limit, beyond, outwards in (
            ("beyond the negative soft limit", low + shift, points.position < low + shift - blur, dx < 0.0),
            ("beyond the positive soft limit", high + shift, points.position > high + shift + blur, dx > 0.0),
        ):
            self.found.above(what, points.position, limit, beyond & outwards & ~free, points.length)

    def _shift(self) -> Numbers:
        """By how much set_position has moved the coordinates, from what it did to the recorded positions."""
        points, steps = self.points, np.zeros(len(self.cycles))
        for order in self.orders:
            row = self.stretches.row(order.cycle)
            if order.command == "set_position" and row == 0 and self.cycles[0] == 0:
                steps[0] = points.position[0] - self.parameters.start_position
            elif order.command == "set_position" and 0 < row < len(self.cycles):
                moved = 0.5 * points.cycle_time * (points.velocity[row - 1] + points.velocity[row])
                steps[row] = points.position[row] - points.position[row - 1] - moved
        shift = np.cumsum(steps)
        for begin in np.flatnonzero(self.referenced[1:] & ~self.referenced[:-1]) + 1:
            shift[begin:] -= shift[begin]
        return shift

    def _unknown_shift(self) -> Mask:
        """Of a recording that begins behind a set_position nobody knows where the soft limits are."""
        shifted: Mask = (self.columns["status_bits"].astype(np.int64) & B.COORDINATES_SHIFTED) != 0
        late = self.cycles[0] > 0 and shifted[0]
        return shifted if late else np.zeros(len(self.cycles), dtype=bool)

    # couplings

    def _gantry_rows(self) -> Mask:
        rows = np.zeros(len(self.cycles), dtype=bool)
        for of_coupling, order, _ in self._couplings():
            rows[of_coupling] = order.command == "couple_gantry"
        return rows

    def _couplings(self) -> list[tuple[Mask, Order, Numbers]]:
        """Rows from each coupling to the next one, its command, and the factor in each row."""
        begins = [order for order in self.orders if order.command in COUPLINGS]
        found = []
        for number, order in enumerate(begins):
            following = begins[number + 1 :]
            end = self.stretches.row(following[0].cycle) if following else len(self.cycles)
            rows = np.zeros(len(self.cycles), dtype=bool)
            rows[self.stretches.row(order.cycle) : end] = True
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
                self._check_linear(rows & self.follows & ~self.added, factor, self.inputs.axes[master], master)

    def _check_linear(self, rows: Mask, factor: Numbers, masters: Columns, master: str) -> None:
        place = np.minimum(np.searchsorted(masters["cycle"], self.cycles), len(masters["cycle"]) - 1)
        rows = rows & (masters["cycle"][place] == self.cycles)
        if self.inputs.machine.axes[master].couple_to_actual:
            rows &= (masters["state"][place] != S.DISABLED) & (masters["error_id"][place] == 0)
        for what, own, name, units in (
            ("velocity beside that of the master", self.points.velocity, "set_velocity", "/s"),
            ("acceleration beside that of the master", self.points.acceleration, "set_acceleration", "/s²"),
        ):
            wanted = factor * masters[name][place]
            wrong = rows & ~(np.abs(own - wanted) <= PLACES * np.spacing(np.abs(wanted)))
            self.found.above(what, own, wanted, wrong, self.points.length + units)
        self._check_distance(rows, factor, masters["set_position"][place], masters["set_velocity"][place])

    def _check_distance(self, rows: Mask, factor: Numbers, position: Numbers, velocity: Numbers) -> None:
        """Step by step; a master at a standstill may get other coordinates, which move no slave."""
        own, wanted = np.diff(self.points.position), factor[1:] * np.diff(position)
        largest = np.spacing(larger(np.abs(position)))
        blur = PLACES * (np.spacing(larger(np.abs(self.points.position))) + np.abs(factor[1:]) * largest)
        same = rows[1:] & rows[:-1] & self.points.joined & ~self.laws.placed & (factor[1:] == factor[:-1])
        stands = (velocity[1:] == 0.0) & (velocity[:-1] == 0.0)
        wrong = same & ~stands & ~(np.abs(own - wanted) <= blur)
        what = "distance beside that of the master"
        self.found.above(what, of_later(own), of_later(wanted), np.concatenate(([False], wrong)), self.points.length)


def is_power(order: Order) -> bool:
    """Power on, by a command or by the HLI."""
    by_hli = order.command == "overlay" and order.arguments.get("control_unit") == "controller_enable"
    return by_hli or (order.command == "power" and bool(order.arguments.get("enabled")))


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
