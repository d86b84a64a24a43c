"""What moved, from a recording: standstill at the end, limits on the way, what is coupled stays together.

The checks are their own: differences of recorded values, no formula of the kernel.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from campaign.cases import Link
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import Severity
from cnc_ptp.recording.motion_check.check import check_recording
from cnc_ptp.recording.motion_check.inputs import NO_SETPOINTS
from cnc_ptp.recording.reader import Recorded

Values = npt.NDArray[np.float64]

ROUNDING = 1e-6
OF_ACTUAL = 1.15
"""Actual values may exceed the acceleration of the set values by so much: a controller that catches up."""
RPM = 6.0
"""deg/s"""
IN_STEP = 0.01
"""deg; of the set values of a thread."""


class Track(NamedTuple):
    """Set and actual values of a unit, mm or deg; actual ones with what its drive did on its own."""

    cycles: npt.NDArray[np.uint64]
    set_position: Values
    set_velocity: Values
    actual_position: Values
    actual_velocity: Values
    own_stop: int
    """Cycles in which the drive has braked on its own."""


def tracks(recorded: Recorded) -> dict[str, Track]:
    """Of every axis and spindle."""
    found = {}
    for topic, rows in recorded.states.items():
        unit = topic.split("/")[1]
        names = rows.dtype.names or ()
        if "set_position" in names:
            columns = [rows[name] for name in ("set_position", "set_velocity", "actual_position", "actual_velocity")]
        elif "set_speed_rpm" in names:
            speeds = [rows[name] * RPM for name in ("set_speed_rpm", "actual_speed_rpm")]
            columns = [rows["set_position_deg"], speeds[0], rows["actual_position_deg"], speeds[1]]
        else:
            continue
        stop = next((each for each in recorded.drive_stops if each.unit == unit), None)
        if stop is not None:
            followed = int(np.searchsorted(rows["cycle"], stop.first_cycle))
            columns[2] = np.concatenate([columns[2][:followed], stop.actual_position])
            columns[3] = np.concatenate([columns[3][:followed], stop.actual_velocity])
        found[unit] = Track(rows["cycle"], *columns, own_stop=0 if stop is None else len(stop.actual_position))
    return found


def problems(
    recorded: Recorded, machine: MachineParameters, *, ended: bool, stopped_in: Collection[str] = ()
) -> Iterator[str]:
    """What is wrong with the motions of a recording; `ended`: it goes on to the standstill.

    `stopped_in`: units whose process may have been held up while it sent a block, so that some have it and its drive
    has not.
    """
    cycle = machine.cycle_time_us * 1e-6
    for unit, track in tracks(recorded).items():
        if len(track.cycles) and np.any(np.diff(track.cycles.astype(np.int64)) != 1):
            yield f"{unit}: cycles are missing"
        stop = next((each for each in recorded.drive_stops if each.unit == unit), None)
        permitted = machine.block_cycles if unit in stopped_in else 0
        if stop is not None and not 0 <= int(track.cycles[-1]) + 1 - stop.first_cycle <= permitted:
            yield f"{unit}: the drive stops in cycle {stop.first_cycle}, the last setpoint is of {track.cycles[-1]}"
        if ended and stop is None and track.set_velocity[-1] != 0.0:
            yield f"{unit}: still moves at the end with {track.set_velocity[-1]:.3f}"
        if ended and stop is not None and track.actual_velocity[-1] != 0.0:
            yield f"{unit}: its drive still moves at the end"
        velocity, acceleration = limits(machine, unit)
        steps = np.abs(np.diff(track.set_velocity)) / cycle
        if steps.max(initial=0.0) > acceleration * (1.0 + ROUNDING) + ROUNDING:
            yield f"{unit}: set acceleration {steps.max():.1f} above {acceleration:.1f} at {int(steps.argmax())}"
        steps = np.abs(np.diff(track.actual_velocity)) / cycle
        if steps.max(initial=0.0) > acceleration * OF_ACTUAL + ROUNDING:
            yield f"{unit}: actual acceleration {steps.max():.1f} above {acceleration:.1f} at {int(steps.argmax())}"
        moved = np.abs(np.diff(track.actual_position)) / cycle
        if moved.max(initial=0.0) > velocity * OF_ACTUAL + ROUNDING:
            yield f"{unit}: its position jumps ({moved.max():.1f} per second at {int(moved.argmax())})"


def seen_problems(seen: Recorded, machine: MachineParameters) -> Iterator[str]:
    """What a witness has seen of a machine that has ended: of every axis and spindle."""
    for unit in {*machine.axes, *machine.spindles} - {*tracks(seen)}:
        yield f"{unit}: nothing"
    yield from problems(seen, machine, ended=True)


def violations(recording: Path) -> list[str]:
    """What the checker of all recordings finds (cnc_ptp verify --motion); it knows nothing of drives alone.

    One that it refuses is a problem, but for one in which nothing has moved yet.
    """
    try:
        return [str(violation) for violation in check_recording(recording).violations]
    except CncError as error:
        return [] if error.number == NO_SETPOINTS else [f"the motion cannot be checked: {error}"]


def limits(machine: MachineParameters, unit: str) -> tuple[float, float]:
    """Velocity and acceleration that it can have at most."""
    if unit in machine.axes:
        axis = machine.axes[unit]
        return axis.max_velocity, max(axis.max_acceleration, axis.emergency_deceleration)
    gears = machine.spindles[unit].gears.values()
    curves = [gear.curve.maximum for gear in gears if gear.curve is not None]
    accelerations = [max(gear.max_acceleration, gear.emergency_deceleration) for gear in gears]
    return max(gear.max_speed for gear in gears), max([*accelerations, *curves])


def torn(
    recorded: Recorded, link: Link, machine: MachineParameters, *, above: Link | None = None
) -> tuple[float, float]:
    """How far actual positions of a master and its slave have left their relation, and how far they may, mm (deg).

    Each may be behind its setpoints. Somebody that is lost is noticed with the next block or the one after it: until
    then the others go on. Then each brakes on its own ramp (P-AXIS-00002): with a factor other than 1 their distances
    differ. A master that is a slave itself, by the link `above`, may also come to rest on the ramp of its own master.
    A spindle has another ramp than the axis that follows it: one of them may be at rest at once.
    """
    found = tracks(recorded)
    master, slave = found[link.master], found[link.slave]
    lengths = len(master.actual_position), len(slave.actual_position)
    count = max(lengths) if recorded.complete else min(lengths)  # of a cut recording: as far as it has both
    leads, follows = (held(each.actual_position[:count], count) for each in (master, slave))
    apart = follows - follows[0] - link.factor * (leads - leads[0])
    factor = abs(link.factor)
    fastest = max(np.abs(slave.actual_velocity).max(), factor * np.abs(master.actual_velocity).max())
    lag = largest_lag(slave) + factor * largest_lag(master)
    leading = [longest_ramp(master, link.master, machine)]
    if above is not None:
        leading.append(abs(above.factor) * longest_ramp(found[above.master], above.master, machine))
    following = longest_ramp(slave, link.slave, machine)
    if link.master in machine.spindles:
        ramps = max(factor * leading[0], following)
    else:
        ramps = max(abs(factor * ramp - following) for ramp in leading)
    return float(np.abs(apart).max()), float(lag + fastest * reaction(machine) + ramps)


def reaction(machine: MachineParameters) -> float:
    """Seconds of machine time in which somebody goes on without one that is lost: two blocks and a cycle."""
    return (2 * machine.block_cycles + 1) * machine.cycle_time_us * 1e-6


def out_of_step(recorded: Recorded, links: Sequence[Link], machine: MachineParameters) -> Iterator[str]:
    """Axes that have left the angle of their spindle, by set values, as far as both are recorded.

    Tapping by the `links` of spindles: both follow set values. Without one by the phase of threads, whose axis follows
    the actual angle. Nothing but rounding is permitted until the first fault, then what the spindle turns until it is
    noticed.
    """
    found = tracks(recorded)
    tapping = [link for link in links if link.master in machine.spindles and {link.master, link.slave} <= {*found}]
    for link in tapping:
        spindle, axis = found[link.master], found[link.slave]
        cycles, *both = np.intersect1d(spindle.cycles, axis.cycles, assume_unique=True, return_indices=True)
        positions = [each.set_position[at] for each, at in zip((spindle, axis), both, strict=True)]
        turned, moved = (each - each[:1] for each in positions)
        yield from steps_left(link.slave, spindle, cycles, turned - moved / link.factor, recorded, machine)
    names = {spindle.number: name for name, spindle in machine.spindles.items()}
    for rows in () if tapping else recorded.threads.values():
        followed = rows[~np.isnan(rows["set_phase_error_deg"])]
        for number in set(followed["spindle"].tolist()):
            own = followed[followed["spindle"] == number]
            errors = own["set_phase_error_deg"]
            yield from steps_left("thread", found[names[number]], own["cycle"], errors, recorded, machine)


def steps_left(
    name: str, spindle: Track, cycles: Any, errors: Values, recorded: Recorded, machine: MachineParameters
) -> Iterator[str]:
    """What is wrong with distances from the angle of a spindle, deg."""
    faults = [event.cycle for event in recorded.events if event.severity == Severity.ERROR]
    before = cycles < min(faults, default=np.inf)
    turning = float(np.abs(spindle.set_velocity).max(initial=0.0)) * reaction(machine)
    for which, permitted in ((before, IN_STEP), (~before, IN_STEP + turning)):
        apart = np.abs(errors[which]).max(initial=0.0)
        if apart > permitted:
            yield f"{name}: {apart:.3f} deg out of step with its spindle, {permitted:.3f} permitted"


def largest_lag(track: Track) -> float:
    """The largest following error while setpoints came, mm (deg)."""
    count = min(len(track.cycles), len(track.actual_position) - track.own_stop)
    return float(np.abs(track.set_position[:count] - track.actual_position[:count]).max(initial=0.0))


def longest_ramp(track: Track, unit: str, machine: MachineParameters) -> float:
    """Distance of a stop from the largest velocity, with deceleration and jerk of an axis, of a spindle in its gear."""
    velocity = float(np.abs(track.actual_velocity).max())
    if unit in machine.spindles:
        return 0.5 * velocity**2 / min(gear.max_acceleration for gear in machine.spindles[unit].gears.values())
    own = machine.axes[unit]
    return 0.5 * velocity**2 / own.deceleration + 0.5 * velocity * own.deceleration / own.jerk


def held(values: Values, count: int) -> Values:
    """Extended by the last value."""
    return np.concatenate([values, np.full(count - len(values), values[-1])])
