"""The runs behind figures 9 to 13 of the spindle manual: every arrow of the state graphs, waiting paths, gears by speed.

Machines: analogue.yaml, digital.yaml, synchronisation.yaml and gears.yaml of examples/spindles.
"""

from itertools import pairwise

import numpy as np
import pytest
from figure_support import CYCLE_TIME, SCENARIOS, head_and_scenario, run_of

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from figures.gear_ranges import ranges_of
from figures.kinds import draw
from figures.run import run_figure
from figures.scenario_head import FigureError, read_head
from figures.spindle_and_path import path_of
from figures.spindle_states import changes

STANDSTILL, CONTINUOUS, DISCRETE = S.STANDSTILL, S.CONTINUOUS_MOTION, S.DISCRETE_MOTION
ANALOGUE = {
    (STANDSTILL, CONTINUOUS),  # M3, M4
    (CONTINUOUS, S.STOPPING),  # M5
    (S.STOPPING, STANDSTILL),
    (STANDSTILL, DISCRETE),  # M19
    (CONTINUOUS, DISCRETE),
    (DISCRETE, STANDSTILL),  # done
    (DISCRETE, CONTINUOUS),  # M3, M4
    (DISCRETE, S.STOPPING),  # M5
    (STANDSTILL, S.HOMING),  # M19 without reference, G74
    (CONTINUOUS, S.HOMING),  # G74; M19, M5 after the control limit
    (S.HOMING, DISCRETE),  # of M19
    (S.HOMING, STANDSTILL),  # done
    (S.HOMING, S.STOPPING),  # M5
}
DIGITAL = ANALOGUE - {(CONTINUOUS, S.HOMING), (S.HOMING, DISCRETE)} | {
    (STANDSTILL, S.ERROR_STOP),  # M19 without reference
    (CONTINUOUS, S.ERROR_STOP),
    (S.ERROR_STOP, STANDSTILL),  # reset
}


def spindle(name, field):
    return run_of(name).column("s1", field)


def arrows(name):
    """(before, after, cycle) of each change of the state."""
    return [(S(before), S(after), cycle) for before, after, cycle in changes(spindle(name, "state"))]


def first(values):
    return int(np.flatnonzero(values)[0])


# figures 9 and 10: state graphs


@pytest.mark.parametrize(("name", "graph"), [("analogue", ANALOGUE), ("digital", DIGITAL)])
def test_run_goes_through_every_arrow_and_no_other(name, graph):
    assert {(before, after) for before, after, _ in arrows(f"spindle_states_{name}")} == graph


def test_reference_is_lost_above_the_control_limit_and_found_at_the_zero_pulse():
    """500 rpm; the pulse comes at 120° of the encoder, where the position is P-AXIS-00152, 0°, from then on."""
    referenced, speed = (
        spindle("spindle_states_analogue", "referenced"),
        spindle("spindle_states_analogue", "set_speed_rpm"),
    )
    lost = np.flatnonzero(np.diff(referenced) < 0.0) + 1
    found = np.flatnonzero(np.diff(referenced) > 0.0) + 1
    assert len(lost) == 2 and len(found) == 3 and not referenced[0]
    assert (np.abs(speed[lost]) > 500.0).all() and (np.abs(speed[lost - 1]) <= 500.0).all()
    assert speed[found] == pytest.approx(100.0)
    actual = spindle("spindle_states_analogue", "actual_position_deg")
    way_of_a_cycle = 100.0 * 6.0 * CYCLE_TIME
    assert all(0.0 <= actual[cycle] % 360.0 <= way_of_a_cycle for cycle in found)


def test_homing_out_of_the_rotation_does_not_stand():
    """M19 above the control limit: from 800 rpm to 100 rpm, the pulse, the position."""
    begin = next(
        cycle for a, b, cycle in arrows("spindle_states_analogue") if (a, b) == (CONTINUOUS, S.HOMING) and cycle > 7000
    )
    end = next(cycle for a, b, cycle in arrows("spindle_states_analogue") if a == DISCRETE and cycle > begin)
    speed = spindle("spindle_states_analogue", "set_speed_rpm")
    assert speed[begin] == pytest.approx(800.0)
    homing = spindle("spindle_states_analogue", "state")[begin:end] == S.HOMING
    assert speed[begin:end][homing].min() == pytest.approx(100.0)
    assert spindle("spindle_states_analogue", "actual_position_deg")[end] % 360.0 == pytest.approx(180.0, abs=0.05)


def test_analogue_stop_homes_after_the_control_limit_only():
    def stops(begin, end):
        return [b for a, b, cycle in arrows("spindle_states_analogue") if begin <= cycle <= end and a == CONTINUOUS]

    assert stops(10_000, 10_200) == [S.HOMING]
    assert stops(12_500, 12_700) == [S.STOPPING]


def test_digital_spindle_without_reference_is_an_error():
    errors = spindle("spindle_states_digital", "error_id")
    assert set(errors) == {0.0, 24007.0}
    assert [marker.text for marker in run_of("spindle_states_digital").markers].count("s1: error 24007") == 2
    referenced = spindle("spindle_states_digital", "referenced")
    assert (np.diff(referenced) >= 0.0).all() and referenced[-1]


def test_drive_controls_the_velocity_above_one_speed_and_the_position_below_another():
    """On with the command of 800 rpm (P-AXIS-00265: 500 rpm), off below 300 rpm (00266) of the actual speed, + 10 %."""
    bits = spindle("spindle_states_digital", "status_bits").astype(int)
    on = np.flatnonzero(bits & 2)
    command = next(
        cycle
        for cycle in range(6400, 6700)
        if spindle("spindle_states_digital", "programmed_speed_rpm")[cycle] == 800.0
    )
    assert on[0] == command and (np.diff(on) == 1).all()
    actual = spindle("spindle_states_digital", "actual_speed_rpm")
    assert actual[on[-1]] > 300.0 >= actual[on[-1] + 1] - 30.0
    assert ((bits & 1) == ~(bits >> 1) & 1).all()


# figures 11 and 12: spindle and path


def test_path_does_not_wait():
    path = path_of(run_of("spindle_not_synchronised"))
    assert not path.waits.any()
    speed = spindle("spindle_not_synchronised", "set_speed_rpm")
    assert first(path.velocity > 0.0) == 1 and first(speed > 0.0) == 11
    assert speed.max() == pytest.approx(500.0) and speed[4000] == pytest.approx(100.0)


def test_path_waits_for_the_speed():
    """40·√2 mm at 25 mm/s per block; the path is at rest from the command to the block after the speed, and never before."""
    run = run_of("spindle_synchronised")
    path, reached = path_of(run), run.column("s1", "speed_reached")
    given = [round(marker.time / CYCLE_TIME) for marker in run.markers if marker.text.startswith("set speed")]
    for cycle in given:
        when = cycle + 1 + first(reached[cycle + 1 :])
        block_after = 10 * (when // 10 + 1)
        assert not path.velocity[cycle : block_after + 1].any() and path.velocity[block_after + 1] > 0.0
        assert path.waits[cycle:block_after].all() and not path.waits[block_after + 1]
    assert path.velocity.max() == pytest.approx(25.0)
    assert len(given) == 2


def test_both_paths_are_the_same_but_for_the_waiting():
    ways = [
        np.sum(path_of(run_of(f"spindle_{name}")).velocity) * CYCLE_TIME
        for name in ("not_synchronised", "synchronised")
    ]
    assert ways == pytest.approx([2.0 * 40.0 * 2.0**0.5] * 2, rel=1e-6)


# figure 13: gears


def test_ranges_are_those_of_the_manual():
    run = run_of("spindle_gears")
    assert ranges_of(read_head(SCENARIOS / "spindle_gears.yaml"), run, "s1") == (
        (50, 560),
        (400, 800),
        (700, 3500),
        (3501, 4000),
        (3800, 5500),
        (5400, 7000),
    )


def test_each_speed_runs_in_a_gear_that_has_it():
    """From M40 to M41 for S650, M42 for S950, M40 for S500, M41 as programmed; S750 twice, S1050 and S350 without."""
    run = run_of("spindle_gears")
    gear, wanted = run.column("s1", "gear"), run.column("s1", "programmed_speed_rpm")
    assert [int(gear[0]), *(int(new) for old, new in pairwise(gear) if new != old)] == [1, 2, 3, 1, 2]
    given = [
        round(marker.time / CYCLE_TIME) for marker in run.markers if marker.text.startswith(("start", "set speed"))
    ]
    assert [round(wanted[cycle]) for cycle in given] == [650, 750, 950, 1050, 750, 500, 350, 750]
    ranges = ranges_of(read_head(SCENARIOS / "spindle_gears.yaml"), run, "s1")
    for cycle in given:
        low, high = ranges[int(gear[cycle]) - 1]
        assert low <= wanted[cycle] <= high


# pictures that cannot be drawn


def refused(folder, head, scenario="[]\n"):
    figure = read_head(head_and_scenario(folder, head, scenario))
    with pytest.raises(FigureError) as error:
        draw(figure, run_figure(figure))
    return str(error.value)


HEAD = {"title": "T", "caption": "C.", "machine": "examples/spindles/nc_spindle.yaml", "axes": "s1"}
TURN = "- {at: 0, to: s1, do: start, direction: cw, speed_rpm: 60}\n- {at: 0.5, to: s1, do: stop}\n"


def test_path_needs_a_program(tmp_path):
    text = refused(tmp_path, HEAD | {"kind": "spindle_and_path"}, TURN)
    assert text == "figure move.yaml: there is no path without 'program: ...'; no picture was drawn"


def test_ranges_need_a_table(tmp_path):
    text = refused(tmp_path, HEAD | {"kind": "gear_ranges"}, TURN)
    assert text == (
        "figure move.yaml: spindle 's1' has no speed ranges (P-CHAN-00058, P-CHAN-00055); no picture was drawn"
    )


def test_refusal_that_is_no_error_of_the_run_is_not_shown(tmp_path):
    text = refused(tmp_path, HEAD | {"errors": "shown"}, TURN.replace("speed_rpm: 60", "speed_rpm: 60000"))
    assert text.startswith("figure move.yaml: P-ERR-24002 spindle s1: start refused")
