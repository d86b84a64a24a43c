"""The watchdogs of the simulated drives: what becomes of an axis or spindle whose process has died.

A simulated drive is computed in the process of its unit and would end with it, in mid-motion. Its watchdog is here, in
the process of the clock, which is the field bus of this machine: with the newest block of each unit it knows where the
drive is, and lets it brake when no more setpoints come.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import partial
from math import inf
from typing import NamedTuple

from cnc_ptp import msg
from cnc_ptp.control.drives.setpoint_watchdog import (
    OwnStop,
    axis_stop,
    braking_deceleration,
    own_stop,
    spindle_stop,
)
from cnc_ptp.errors import CncError, Value
from cnc_ptp.motion.profile import Profile
from cnc_ptp.nodes import convert
from cnc_ptp.nodes.events import EventPublisher
from cnc_ptp.nodes.polling_node import PollingNode, chain
from cnc_ptp.nodes.topics import BLOCK_CLASSES, BLOCK_TYPES, DRIVE_STOPS, EVENTS, NEWEST_BLOCK, block_topic
from cnc_ptp.nodes.watchdog import Watchdog
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.protocol.blocks import AxisBlock, Event, Severity, SpindleBlock
from cnc_ptp.protocol.event_values import event_values
from cnc_ptp.protocol.unit import UPSTREAM_LOST
from cnc_ptp.wire.block_codec import codec_of
from cnc_ptp.wire.stamps import Stamps

FAREWELL = 0.3
"""Seconds between the last tick, or the last stop of a drive, and the end of the clock: what it has said arrives."""
LAST_PATIENCE = 1.0
"""Seconds of silence, at the end of a run, after which no more setpoints come, however long the watchdog time is."""
HELD_UP, PROBATION = 2.5, 5.0
"""Watchdog times between two looks after which this process was held up; in which it finds out what units have done."""
DRIVE_BRAKED = 26265
DRIVE_STOOD = 26266
CLOCK_LATE = 26268


class LastValues(NamedTuple):
    """The state of a drive in the cycle of its last setpoint, mm (deg)."""

    cycle: int
    position: float
    velocity: float
    profile: Profile
    """Its stop from there."""
    deceleration: float


class DriveWatch:
    """Holds the newest block of each axis and spindle, and lets the drive of a silent unit brake.

    No executor is woken by these blocks; some times in each watchdog time the newest ones are read. In machine time a
    stop begins with the cycle after the last setpoint, as everything else that depends on the unit: units wait for its
    blocks, so that all of them come to that cycle when the watchdog time has passed.

    A clock that was itself held up for some watchdog times does not know what units have done without it: the
    drive of one that is not heard for so long afterwards is left to its unit. Where units have stopped without it, the
    clock ends.
    """

    def __init__(self, node: PollingNode, machine: MachineParameters) -> None:
        self._node = node
        self._machine = machine
        axes = [name for name, axis in machine.axes.items() if not axis.virtual]
        kinds = dict.fromkeys(axes, "axis") | dict.fromkeys(machine.spindles, "spindle")
        self._units = [*kinds]
        """Those whose drives have not stopped on their own."""
        self._newest: dict[str, AxisBlock | SpindleBlock] = {}
        self._seconds = machine.watchdog_ms / 1000.0
        self._watchdog = Watchdog(self._units, seconds=self._seconds)
        self._cycle_time = machine.cycle_time_us * 1e-6
        self._due = self._stopped_at = 0.0
        self.longest_pause = HELD_UP * self._seconds
        """Seconds between two looks after which this process was held up."""
        self._held_for, self._resumed_at = 0.0, -inf
        self._known = {*self._units}
        """Units whose newest block is here: all, as long as this process was not held up."""
        self._publisher = node.create_publisher(msg.DriveStop, DRIVE_STOPS, EVENTS)
        self._events = EventPublisher(node)
        node.input_period = float("inf")  # this class says when
        for unit, kind in kinds.items():
            decode = partial(codec_of(BLOCK_CLASSES[kind]).decode, count=machine.block_cycles)
            take = chain(decode, partial(self._take, unit))
            node.poll_input(BLOCK_TYPES[kind], block_topic(unit), take, NEWEST_BLOCK)

    def heard(self, unit: str) -> None:
        """A unit has sent a block, or says that it lives while it waits for others."""
        self._watchdog.heard(unit)
        if not self._on_probation():
            self._known.add(unit)

    def restart(self) -> None:
        """The run begins: all count as heard."""
        self._watchdog.restart()

    def look(self, stamps: Stamps, *, begun: bool) -> None:
        """To be called often: some times in each watchdog time, drives whose unit has been silent for it brake."""
        now = time.monotonic()
        if now < self._due:
            return
        self._due = now + self._seconds / 4.0
        suspended = self._watchdog.was_suspended()
        if self._watchdog.paused > self.longest_pause:
            self._held_for, self._resumed_at = self._watchdog.paused, now
            self._known.clear()
        self._node.take_inputs()
        self._require_own_ticks()
        if suspended:
            self._watchdog.restart()
            return
        for unit in self._watchdog.silent(self._judged(), begun=begun):
            self._stop(unit, stamps)

    def _require_own_ticks(self) -> None:
        """Raises CncError 26268 when this process was held up, and units have stopped without it."""
        alone = [unit for unit in self._units if self._stops_alone(unit)]
        if alone:
            held = f"clock: it was held up for {self._held_for:.1f} s"
            reason = f"{held}, and units have stopped without it: {', '.join(alone)}"
            raise CncError(CLOCK_LATE, reason, "the clock ends, and the run with it")

    def _judged(self) -> list[str]:
        """Units whose drives brake when they fall silent."""
        return [unit for unit in self._units if unit in self._known and not self._stops_alone(unit)]

    def _stops_alone(self, unit: str) -> bool:
        """While this process was held up, the unit has lost the clock."""
        block = self._newest.get(unit)
        return self._on_probation() and block is not None and block.error_id[-1] == UPSTREAM_LOST

    def _on_probation(self) -> bool:
        """This process was held up a short time ago."""
        return time.monotonic() - self._resumed_at < PROBATION * self._seconds

    def settled(self, stamps: Stamps) -> bool:
        """At the end of a run: True when no drive got a setpoint of a motion last; those of silent units brake before.

        Then nobody says that it lives, so that a drive that stands is left alone. A unit that lives sends its stop, so
        that this holds also of one that has not been heard since this process was held up.
        """
        self._node.take_inputs()
        left = [unit for unit in self._units if unit in self._newest and not self._stops_alone(unit)]
        moved = [unit for unit in left if is_commanded(self._newest[unit])]
        for unit in self._watchdog.silent(moved, begun=True, most=LAST_PATIENCE):
            self._stop(unit, stamps)
            moved.remove(unit)
        return not moved and time.monotonic() - self._stopped_at > FAREWELL

    def _take(self, unit: str, block: AxisBlock | SpindleBlock) -> None:
        self.heard(unit)
        self._newest[unit] = block

    def _stop(self, unit: str, stamps: Stamps) -> None:
        last = self._last_values(unit)
        self._units.remove(unit)
        if last is None:  # no block has ever come: the drive has not been moved
            return
        self._stopped_at = time.monotonic()
        stop = own_stop(last.profile, self._cycle_time)
        self._publish(unit, last.cycle + 1, stop, stamps)
        place, length = stop.positions[-1], self._length_unit(unit)
        watched = f"no setpoint came after cycle {last.cycle} within its watchdog time of {self._seconds:g} s"
        silence = f"drive of {self._name(unit)}: {watched}"
        if len(stop.positions) > 1:
            ramp = f"{last.velocity:.4f} {length}/s with {last.deceleration:g} {length}/s²"
            text = f"{silence}; it has braked on its own from {ramp} to a standstill at {place:.4f} {length}"
            values: dict[str, Value] = {"velocity": last.velocity, "deceleration": last.deceleration, "place": place}
            self._tell(last.cycle + 1, DRIVE_BRAKED, text, unit, values, stamps)
        else:
            text = f"{silence}; it stands at {place:.4f} {length}"
            self._tell(last.cycle + 1, DRIVE_STOOD, text, unit, {"place": place}, stamps)

    def _publish(self, unit: str, first_cycle: int, stop: OwnStop, stamps: Stamps) -> None:
        message = msg.DriveStop(unit=unit, first_cycle=first_cycle)
        message.actual_position, message.actual_velocity = stop.positions, stop.velocities
        message.header.stamp = convert.time_message(stamps.at(first_cycle))
        self._publisher.publish(message)

    def _tell(self, cycle: int, number: int, text: str, unit: str, values: Mapping[str, Value], stamps: Stamps) -> None:
        given = event_values(values, self._length_unit(unit))
        event = Event(cycle, self._node.get_name(), Severity.ERROR, number, text, values=given)
        self._events.publish(convert.event_to_message(event, convert.time_message(stamps.at(cycle))))

    def _last_values(self, unit: str) -> LastValues | None:
        if unit not in self._newest:
            return None
        block = self._newest[unit]
        return self._of_axis(unit, block) if isinstance(block, AxisBlock) else self._of_spindle(unit, block)

    def _of_axis(self, unit: str, block: AxisBlock) -> LastValues:
        axis, velocities = self._machine.axes[unit], block.actual_velocity
        position, velocity = block.actual_position[-1], velocities[-1]
        acceleration = (velocity - velocities[-2]) / self._cycle_time if block.count > 1 else block.set_acceleration[-1]
        braking = braking_deceleration(axis, in_step=self._is_coupled(unit))
        profile = axis_stop(axis, position, velocity, acceleration, braking)
        cycle = block.first_cycle + block.count - 1
        return LastValues(cycle, position, velocity, profile, braking)

    def _of_spindle(self, unit: str, block: SpindleBlock) -> LastValues:
        gears = self._machine.spindles[unit].gears
        gear = gears.get(block.gear[-1]) or next(iter(gears.values()))
        position, velocity = block.actual_position_deg[-1], block.actual_speed_rpm[-1] * DEG_S_PER_RPM
        braking = braking_deceleration(gear, in_step=self._is_coupled(unit))
        profile = spindle_stop(position, velocity, braking)
        cycle = block.first_cycle + block.count - 1
        return LastValues(cycle, position, velocity, profile, braking)

    def _is_coupled(self, unit: str) -> bool:
        """It has a master or slaves; they stop on their own ramps, and so does its drive: they stay together."""
        masters = {name: block.master for name, block in self._newest.items()}
        return bool(masters.get(unit)) or unit in masters.values()

    def _name(self, unit: str) -> str:
        return f"axis {unit}" if unit in self._machine.axes else f"spindle {unit}"

    def _length_unit(self, unit: str) -> str:
        return "mm" if unit in self._machine.axes and not self._machine.axes[unit].rotary else "deg"


def is_commanded(block: AxisBlock | SpindleBlock) -> bool:
    """The last setpoint is one of a motion."""
    return bool(block.set_velocity[-1] if isinstance(block, AxisBlock) else block.set_speed_rpm[-1])
