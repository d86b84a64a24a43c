"""Pitch and phase error of threads and tapping in channel blocks, against closed forms of positions and angles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from long_support import long, long_sets
from machine_support import ROOT, MachineBench
from numpy.typing import NDArray
from thread_support import LATHE, column, cut

from cnc_ptp.parameters import read_machine

FIELDS = (
    "axis",
    "spindle",
    "lead",
    "set_pitch_error",
    "actual_pitch_error",
    "set_phase_error_deg",
    "actual_phase_error_deg",
)
MILL = read_machine(ROOT / "config" / "mill.yaml")
THREAD = "G33 Z48 K1.5"
DIP = "- {at: 3.0, to: s, do: set_override, percent: 90}\n- {at: 4.5, to: s, do: set_override, percent: 100}"
Floats = NDArray[np.float64]


def errors(bench: MachineBench) -> dict[str, Floats]:
    """Each field by cycle of the run, NaN where no block has it."""
    cycles = len(bench.column("channel", "line"))
    found = {name: np.full(cycles, np.nan) for name in FIELDS}
    for block in bench.blocks["channel"]:
        begin = block.first_cycle - len(block.thread_lead) - bench.blocks["channel"][0].first_cycle
        for name, values in found.items():
            part = getattr(block, f"thread_{name}")
            values[begin : begin + len(part)] = part
    return found


def recomputed(bench: MachineBench, lead: float, which: str, *, offset: float = 0.0, begin: float = 105.0) -> Floats:
    """Phase error from way and angle: the thread begins at a multiple of 360 deg + OFFSET, one turn for each lead."""
    way = column(bench, "z", f"{which}_position") - begin
    angle = column(bench, "s", "actual_position_deg") - offset
    return (360.0 * way / lead - angle + 180.0) % 360.0 - 180.0


def in_the_last_turn(bench: MachineBench, name: str, inside: NDArray[np.bool_]) -> Floats:
    """mm by which Z has changed since the spindle was one turn before, NaN in the first turn."""
    angle, position = column(bench, "s", "actual_position_deg")[inside], column(bench, "z", name)[inside]
    return position - np.interp(angle - 360.0, angle, position, left=np.nan)


@pytest.mark.parametrize(("scenario", "least", "most"), [(DIP, 0.0019, 0.0022), *long_sets([("", 0.0, 1e-9)])])
def test_errors_are_those_of_positions_and_angles(scenario, least, most):
    """A dip of 10 % costs 2.0 µm, as the path is where the spindle was expected before it slowed down."""
    bench = cut(THREAD, scenario)
    found = errors(bench)
    inside = ~np.isnan(found["lead"])
    assert inside.sum() == pytest.approx((57.0 - 2.0 * 0.141) / 10.0 / 0.001, rel=0.03)  # 10 mm/s
    assert found["lead"][inside] == pytest.approx(-1.5, abs=1e-12)
    for which in ("set", "actual"):
        phase = recomputed(bench, -1.5, which)[inside]
        assert found[f"{which}_phase_error_deg"][inside] == pytest.approx(phase, abs=1e-7)
        pitch = in_the_last_turn(bench, f"{which}_position", inside) + 1.5
        assert np.isnan(pitch).sum() == pytest.approx(150, abs=1)
        assert found[f"{which}_pitch_error"][inside] == pytest.approx(pitch, abs=2e-6, nan_ok=True)
    assert least <= np.nanmax(abs(found["set_pitch_error"][inside])) < most


def test_they_begin_behind_the_run_up_and_end_before_the_run_out():
    bench = cut(THREAD)
    inside = np.nonzero(~np.isnan(errors(bench)["set_phase_error_deg"]))[0]
    assert np.all(np.diff(inside) == 1)
    way = 105.0 - column(bench, "z", "set_position")
    step = 1.5 * 400.0 / 60.0 * 0.001
    assert way[inside[0]] == pytest.approx(0.141, abs=step)
    assert way[inside[-1]] == pytest.approx(57.0 - 0.141, abs=step)


def test_offset_and_other_direction():
    head = "%T\nN10 G18 G90 M04 S400\nG00 X36 Z105\n"
    bench = cut("G33 Z48 K3 S.OFFSET=33", head=head)
    found = errors(bench)
    inside = ~np.isnan(found["lead"])
    assert found["lead"][inside] == pytest.approx(3.0, abs=1e-12)
    phase = recomputed(bench, 3.0, "set", offset=33.0)[inside]
    assert found["set_phase_error_deg"][inside] == pytest.approx(phase, abs=1e-7)
    assert abs(phase).max() < 1e-6


def test_a_face_counts_along_x_and_a_chain_has_the_lead_of_each_block():
    bench = cut("G33 Z90 K1.5\nZ70 K3\nX60 Z68 I2")
    found, lines = errors(bench), column(bench, "channel", "line")
    leads = [float(np.nanmedian(found["lead"][lines == line])) for line in (4, 5, 6)]
    assert leads == pytest.approx([-1.5, -3.0, 2.0], abs=1e-9)
    x, z = (LATHE.axes[name].number for name in ("x", "z"))
    inside = found["axis"] > 0.0
    assert [set(found["axis"][inside & (lines == line)]) for line in (4, 5, 6)] == [{z}, {z}, {x}]
    assert set(found["spindle"][inside]) == {LATHE.spindles["s"].number}
    assert np.array_equal(inside, ~np.isnan(found["lead"]))
    assert np.nanmax(abs(found["set_phase_error_deg"])) < 1e-6


def test_axes_that_act_later_are_compared_with_the_setpoint_that_acts():
    axes = {n: replace(a, control=replace(a.control, path_delay_cycles=3)) for n, a in LATHE.axes.items()}
    bench = cut(THREAD, machine=replace(LATHE, axes=axes))
    found = errors(bench)
    inside = np.nonzero(~np.isnan(found["lead"]))[0]
    assert abs(found["set_phase_error_deg"][inside]).max() < 1e-6
    angle = column(bench, "s", "actual_position_deg")[inside]
    way = 105.0 - column(bench, "z", "actual_position")[inside]
    phase = (way / 1.5 * 360.0 - angle + 180.0) % 360.0 - 180.0
    assert found["actual_phase_error_deg"][inside] == pytest.approx(phase, abs=1e-7)


@pytest.mark.parametrize("count", [4, *long([1, 25])])
def test_other_block_lengths(count):
    bench = cut(THREAD, DIP, machine=replace(LATHE, block_cycles=count))
    found = errors(bench)
    inside = ~np.isnan(found["lead"])
    phase = recomputed(bench, -1.5, "set")[inside]
    assert found["set_phase_error_deg"][inside] == pytest.approx(phase, abs=1e-7)


def test_a_thread_that_is_broken_off_has_errors_up_to_there():
    scenario = "- {at: 3.0, to: channel, do: reset}"
    bench = MachineBench("%T\nN10 G18 G90 M03 S400\nG00 X36 Z105\nG33 Z48 K1.5\nM30\n", scenario, machine=LATHE).run()
    inside = np.nonzero(~np.isnan(errors(bench)["lead"]))[0]
    assert inside[-1] * 0.001 == pytest.approx(3.0, abs=0.03)


def test_tapping_against_the_spindle():
    """The set value is ahead of the actual angle by the lag of the spindle, ω / Kv, the actual value by nothing."""
    text = "%T\nN10 G17 G90\nM19 S.POS=0 S100\nG00 X10 Y10 Z5\nG63 Z-15 F250 S200\nZ5 S-200\nM30\n"
    bench = MachineBench(text, machine=MILL).run()
    found = errors(bench)
    inside = ~np.isnan(found["lead"])
    assert found["lead"][inside] == pytest.approx(-1.25, abs=1e-12)
    lag = column(bench, "s", "following_error_deg")[inside]
    assert found["set_phase_error_deg"][inside] == pytest.approx(lag, abs=1e-9)
    gear = MILL.spindles["s"].gears[MILL.spindles["s"].gear]
    assert abs(lag).max() == pytest.approx(1200.0 / gear.control.kv, rel=1e-3)
    way = column(bench, "z", "actual_position")[inside] - 5.0
    turned = column(bench, "s", "actual_position_deg")[inside]
    phase = way / -1.25 * 360.0 - turned
    actual = found["actual_phase_error_deg"][inside]
    assert actual - actual[0] == pytest.approx(phase - phase[0], abs=1e-6)
    assert abs(actual[1000:]).max() < 0.01
    assert np.nanmax(abs(found["actual_pitch_error"][inside][1000:])) < 0.0001
    assert np.isnan(found["actual_pitch_error"][inside][[0, -1]]).tolist() == [True, False]


def test_runs_without_a_thread_have_empty_columns():
    bench = MachineBench("%T\nG18 G90 M03 S400\nG01 X36 Z105 F5000\nM30\n", machine=LATHE).run()
    assert all(not getattr(block, f"thread_{name}") for block in bench.blocks["channel"] for name in FIELDS)


def test_a_spindle_that_does_not_report_leaves_them_out():
    from cnc_ptp.channel.thread_errors import ThreadErrors
    from cnc_ptp.path.thread_place import ThreadPlace

    places = ThreadErrors(["z"], {"z": 2, "s": 3}, 0)
    places.note(10, 10, {3: ThreadPlace("s", 0, 1.0, -1.5, 30.0)})
    assert places.take(20, {}) == []


@pytest.mark.parametrize("count", [10, *long([1])])
def test_each_hole_has_a_first_turn_of_its_own(count):
    """Also where a block of cycles ends with the first one: the pitch counts from a whole turn on."""
    text = "%T\nG17 G90\nM19 S.POS=0 S100\nG00 X10 Y10 Z5\nG63 Z-5 F250 S200\nZ5 S-200\nG00 X20\nG63 Z-5 F250 S200\nZ5 S-200\nM30\n"
    bench = MachineBench(text, machine=replace(MILL, block_cycles=count)).run()
    found = errors(bench)
    inside = ~np.isnan(found["lead"])
    starts = np.flatnonzero(np.diff(np.concatenate(([0], inside.astype(int)))) == 1)
    angle = column(bench, "s", "actual_position_deg")
    assert len(starts) == 2
    for start in starts:
        first = np.flatnonzero(~np.isnan(found["set_pitch_error"][start:]))[0] + start
        assert abs(angle[first] - angle[start]) >= 360.0
        assert abs(angle[first - 1] - angle[start]) <= 360.0
