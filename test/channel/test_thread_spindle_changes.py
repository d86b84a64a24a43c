"""A thread (G33) whose spindle changes its speed or stops: how far the path is off, and that the axes keep their limits.

`cut` integrates the setpoints of all axes again: positions, velocities and accelerations must fit each other within
the velocity, acceleration and jerk of each axis (`assert_within_limits`).
"""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
import pytest
from long_support import long, long_sets
from thread_support import LATHE, MACHINE, Pass, apart, column, cut

from cnc_ptp.parameters import MachineParameters

FAST = MACHINE
"""18,000 deg/s² of its spindle, three times that of LATHE."""


def without_retract(machine: MachineParameters, *, block_cycles: int = 10) -> MachineParameters:
    channel = replace(machine.channels["channel"], thread_retract_axis="", thread_retract=0.0)
    return replace(machine, channels={"channel": channel}, block_cycles=block_cycles)


# a dip of the speed


def least_error(gain: float, seconds: float, lead: float, jerk: float) -> float:
    """mm that no path can avoid that learns of the acceleration `gain` (deg/s²) of its spindle after some s.

    Until then it is ahead by gain·τ²/2 and faster by gain·τ; with its jerk it becomes as slow as the spindle after
    t, and goes ahead meanwhile: t solves gain·τ + gain·t = J·t²/2.
    """
    j = jerk * 360.0 / lead
    rate = gain * seconds
    t = (gain + (gain * gain + 2.0 * j * rate) ** 0.5) / j
    ahead = 0.5 * gain * seconds**2 + rate * t + 0.5 * gain * t**2 - j * t**3 / 6.0
    return ahead * lead / 360.0


@pytest.mark.parametrize(
    ("machine", "lead", "most_set", "most_actual"),
    [(LATHE, 1.5, 0.00205, 0.0021), *long_sets([(FAST, 1.5, 0.0079, 0.0080), (FAST, 0.5, 0.0021, 0.0022)])],
)
def test_a_dip_of_10_percent(machine, lead, most_set, most_actual):
    """5 µm against the actual angle hold with 6000 deg/s²; with 18,000 even the bound of any path is higher."""
    dip = "- {at: 3.0, to: s, do: set_override, percent: 90}\n- {at: 4.5, to: s, do: set_override, percent: 100}"
    bench = cut(f"G33 Z{105.0 - 38.0 * lead} K{lead}", dip, machine=machine)
    way = 37.0 * lead
    off = Pass(bench, 4, lead).error(1.0, way)
    assert off < most_set
    assert Pass(bench, 4, lead, actual=True).error(1.0, way) < most_actual
    assert off < 1.3 * least_error(machine.spindles["s"].gears[1].acceleration, 0.010, lead, machine.axes["z"].jerk)


def test_the_limit_of_a_tool_keeps_the_dip_within_5_micrometres():
    """`set_limits` is what the D word of a tool with P-TOOL-00015 gives; it counts as the spindle starts behind it."""
    changes = "- {at: 0, to: s, do: set_limits, max_acceleration: 9000}\n"
    dip = "- {at: 3.0, to: s, do: set_override, percent: 90}\n- {at: 4.5, to: s, do: set_override, percent: 100}"
    bench = cut("G33 Z48 K1.5", changes + dip, machine=FAST)
    assert max(map(abs, bench.column("s", "set_acceleration_deg_s2"))) == 9000.0
    off = Pass(bench, 4, 1.5).error(1.0, 55.5)
    assert 0.002 < off < 0.005 and off < 1.3 * least_error(9000.0, 0.010, 1.5, FAST.axes["z"].jerk)
    assert Pass(bench, 4, 1.5, actual=True).error(1.0, 55.5) < 0.010


def test_5_micrometres_are_out_of_reach_with_18000_deg_per_s2():
    """0.010 s late, 1.5 mm: 3.75 µm until the path knows, as much again until its jerk has made it slower."""
    assert least_error(18_000.0, 0.010, 1.5, 1e12) == pytest.approx(0.00375, rel=1e-3)
    assert least_error(18_000.0, 0.010, 1.5, FAST.axes["z"].jerk) > 0.0075


# a spindle that stops


@pytest.mark.parametrize("command", ["do: set_override, percent: 0", "do: stop", "do: power, enabled: false"])
@pytest.mark.parametrize(
    ("machine", "lead", "block_cycles"),
    [(LATHE, 1.5, 10), (FAST, 6.0, 4), *long_sets([(FAST, 1.5, 10), (FAST, 10.0, 10)])],
)
def test_the_path_comes_to_rest_where_its_spindle_does(machine, lead, block_cycles, command):
    """In the groove, without a step of acceleration and without turning back."""
    machine = without_retract(machine, block_cycles=block_cycles)
    head = "%T\nN10 G18 G90 M03 S400\nG00 X36 Z390\n"
    bench = cut(f"G33 Z0 K{lead}", f"- {{at: 3.0, to: s, {command}}}", machine, head)
    z, velocity = column(bench, "z", "set_position"), column(bench, "z", "set_velocity")
    angle = column(bench, "s", "actual_position_deg")
    phases = (390.0 - z) / lead * 360.0 - angle
    rest = apart(0.0, float(phases[-1] % 360.0))
    assert abs(rest) < 0.01, "deg: the tool stands where the groove is"
    assert velocity[3000:].max() <= 1e-9, "it does not turn back"
    assert velocity[-1] == 0.0
    assert np.flatnonzero(velocity)[-1] <= np.flatnonzero(abs(column(bench, "s", "set_speed_rpm")))[-1] + 10


@pytest.mark.long
@pytest.mark.parametrize("seed", range(6))
def test_stops_amid_changes_of_the_speed(seed):
    """Random overrides, leads and blocks of cycles; where the path is still behind, it never turns back."""
    source = random.Random(seed)
    lead = source.choice([0.5, 1.5, 3.0, 6.0])
    machine = without_retract(source.choice([FAST, LATHE]), block_cycles=source.choice([1, 4, 10, 25]))
    changes = [(2.0 + 0.05 * n, source.uniform(80.0, 115.0)) for n in range(20)]
    scenario = "".join(f"- {{at: {at:.3f}, to: s, do: set_override, percent: {p:.1f}}}\n" for at, p in changes)
    head = f"%T\nN10 G18 G90 M03 S{source.uniform(200.0, 900.0):.1f}\nG00 X36 Z390\n"
    bench = cut(f"G33 Z0 K{lead}", scenario + "- {at: 3.1, to: s, do: stop}", machine, head)
    z, angle = column(bench, "z", "set_position"), column(bench, "s", "actual_position_deg")
    phase = ((390.0 - z[-1]) / lead * 360.0 - angle[-1]) % 360.0
    assert abs(apart(0.0, float(phase))) < 0.01
    assert column(bench, "z", "set_velocity")[3000:].max() <= 1e-9


def test_a_path_that_learns_too_late_stops_as_soon_as_it_can():
    """12 mm at 18,000 deg/s² in blocks of 25 ms: the tool passes the place of rest and does not return to it."""
    machine = without_retract(FAST, block_cycles=25)
    bench = cut("G33 Z0 K12", "- {at: 3.0, to: s, do: stop}", machine, "%T\nN10 G18 G90 M03 S300\nG00 X36 Z390\n")
    velocity = column(bench, "z", "set_velocity")
    assert velocity[3000:].max() <= 1e-9
    assert velocity[-1] == 0.0
    angle, z = column(bench, "s", "actual_position_deg"), column(bench, "z", "set_position")
    past = apart(0.0, float(((390.0 - z[-1]) / 12.0 * 360.0 - angle[-1]) % 360.0))
    assert 0.0 < past < 25.0


@pytest.mark.parametrize("block_cycles", [25, *long([40])])
def test_long_blocks_keep_the_limits_while_the_speed_changes(block_cycles):
    """An acceleration of unknown end is taken back gently, not at once."""
    source = random.Random(block_cycles)
    changes = [(2.0 + 0.07 * n, source.uniform(80.0, 115.0)) for n in range(30)]
    scenario = "\n".join(f"- {{at: {at:.3f}, to: s, do: set_override, percent: {p:.1f}}}" for at, p in changes)
    cut("G33 Z0 K6", scenario, replace(FAST, block_cycles=block_cycles), "%T\nN10 G18 G90 M03 S400\nG00 X36 Z390\n")
