"""The exact text and the values of the refusals of a spindle: the one place to change when a text gets better."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from machine_support import UnitBench, spindle_bench, spindle_parameters
from spindle_support import bench_of, two_gears

Ask = Callable[[], UnitBench]
SPINDLES = ("s", "t", "u")
KNOWN = (
    "couple, decouple, feed_hold, gear_changed, hold_stop, home, orient, overlay, power, reset, reset_feedforward, reset_limits, "
    "select_gear, "
    "set_feedforward, set_limits, set_override, set_speed, start, stop, stop_at_program_end, suppress_override"
)
SENSORLESS = {"feedback": "SPEED", "open_loop": True, "referenced_at_start": False}
START = {"direction": "cw", "speed_rpm": 500.0}


def standing(**parameters: Any) -> Ask:
    return lambda: spindle_bench(**parameters)


def turning(**parameters: Any) -> Ask:
    def bench() -> UnitBench:
        bench = spindle_bench(**parameters)
        bench.accepted("start", direction="cw", speed_rpm=1200.0)
        bench.run(300)
        return bench

    return bench


def in_error() -> UnitBench:
    bench = turning()()
    bench.accepted("upstream_lost", source="channel")
    bench.run(50)
    return bench


def at_work() -> UnitBench:
    """For the channel "one"."""
    bench = spindle_bench()
    bench.accepted("start", **START, source="one")
    return bench


def among_others() -> UnitBench:
    return bench_of(spindle_parameters(), spindles=SPINDLES)


def slave() -> UnitBench:
    """Of t."""
    bench = among_others()
    bench.accepted("couple", master="t")
    bench.accepted("coupling_answer", granted=True, reason="")
    return bench


def gears() -> UnitBench:
    return bench_of(two_gears(second={"max_speed": 600.0}))


CASES: list[tuple[int, Ask, str, dict[str, Any], str, dict[str, Any]]] = [
    # what every command is asked
    (
        22002,
        spindle_bench,
        "turn",
        {},
        f"spindle s: unknown command 'turn'; nothing was changed. Known: {KNOWN}",
        {"command": "turn"},
    ),
    (
        22001,
        spindle_bench,
        "start",
        {"direction": "left", "speed_rpm": 1.0},
        "spindle s: start refused: direction = 'left' is not cw or ccw; nothing was changed",
        {"argument": "direction"},
    ),
    (
        22001,
        spindle_bench,
        "start",
        {"direction": "cw"},
        "spindle s: start refused: argument 'speed_rpm' is missing; nothing was changed",
        {"argument": "speed_rpm"},
    ),
    # speeds
    (
        24001,
        spindle_bench,
        "start",
        {"direction": "cw", "speed_rpm": -1.0},
        "spindle s: start refused: speed -1.0 rpm must not be negative; the direction is cw or ccw; nothing was changed",
        {"speed": -1.0},
    ),
    (
        24001,
        spindle_bench,
        "orient",
        {"position_deg": 0.0, "speed_rpm": 0.0},
        "spindle s: orient refused: speed 0 rpm must be greater than 0 for a positioning; nothing was changed",
        {"speed": 0.0},
    ),
    (
        24002,
        spindle_bench,
        "start",
        {"direction": "cw", "speed_rpm": 12_000.5},
        "spindle s: start refused: speed 12000.5 rpm is above the maximum 12000 rpm (P-AXIS-00212); nothing was changed",
        {"speed": 12_000.5, "limit": 12_000.0, "gear": 1},
    ),
    (
        24002,
        gears,
        "start",
        {"direction": "cw", "speed_rpm": 12_000.5},
        "spindle s: start refused: speed 12000.5 rpm is above the maximum 12000 rpm of gear 1 (P-AXIS-00212); nothing "
        "was changed",
        {"speed": 12_000.5, "limit": 12_000.0, "gear": 1},
    ),
    (
        24005,
        spindle_bench,
        "set_override",
        {"percent": -0.5},
        "spindle s: set_override refused: percent = -0.5 is not within 0 ... 150 (P-AXIS-00109); nothing was changed",
        {"percent": -0.5, "limit": 150.0},
    ),
    (
        24018,
        spindle_bench,
        "set_limits",
        {"max_acceleration": 0.5},
        "spindle s: set_limits refused: max_acceleration = 0.5 is not within 1 ... 1e+08 (P-TOOL-00015); nothing was "
        "changed",
        {"argument": "max_acceleration", "value": 0.5, "low": 1.0, "high": 1e8},
    ),
    (
        24018,
        spindle_bench,
        "set_limits",
        {"min_speed_rpm": 500.0, "max_speed_rpm": 400},
        "spindle s: set_limits refused: min_speed_rpm = 500.0 is above max_speed_rpm = 400.0; nothing was changed",
        {"low": 500.0, "high": 400},
    ),
    (
        60254,
        standing(preferred_direction=1),
        "start",
        {"direction": "ccw", "speed_rpm": 500.0},
        "spindle s: start refused: ccw contradicts the preferred direction of rotation (P-AXIS-00224, P-AXIS-00031: "
        "positive); the spindle is in ErrorStop",
        {"direction": "ccw", "preferred": "positive"},
    ),
    # states
    (
        24003,
        in_error,
        "start",
        START,
        "spindle s: start refused: the spindle is in ErrorStop (P-ERR-26101); reset it first; nothing was changed",
        {"state": "ErrorStop", "error": 26101},
    ),
    (
        24003,
        standing(powered_at_start=False),
        "start",
        START,
        "spindle s: start refused: the spindle is in Disabled; power it on; nothing was changed",
        {"state": "Disabled"},
    ),
    (
        24004,
        in_error,
        "reset",
        {},
        "spindle s: reset refused: the spindle still turns on its error ramp; wait for standstill; nothing was changed",
        {},
    ),
    (
        24012,
        at_work,
        "start",
        {**START, "source": "two"},
        "spindle s: start refused: the spindle works for 'one', 'two' must wait until that is finished; nothing was "
        "changed",
        {"owner": "one", "source": "two"},
    ),
    # positions
    (
        24006,
        spindle_bench,
        "orient",
        {"position_deg": 1e12},
        "spindle s: orient refused: position 1000000000000.0 deg is not within ±214748.3647 deg; nothing was changed",
        {"position": 1e12, "limit": 214_748.3647},
    ),
    (
        24007,
        standing(automatic_homing=False, referenced_at_start=False),
        "orient",
        {"position_deg": 0.0},
        "spindle s: orient refused: the spindle has no reference point and does not home automatically (P-AXIS-00015 "
        "0x100); home it first (G74); the spindle is in ErrorStop",
        {},
    ),
    (
        70252,
        standing(**SENSORLESS),
        "orient",
        {"position_deg": 0.0},
        "spindle s: orient refused: the spindle has no actual position (P-AXIS-00320, P-SIM-00050) and cannot be "
        "positioned; nothing was changed",
        {},
    ),
    (
        24008,
        standing(**SENSORLESS),
        "home",
        {},
        "spindle s: home refused: the spindle has no actual position (P-AXIS-00320, P-SIM-00050) and cannot be homed; "
        "nothing was changed",
        {},
    ),
    (
        24009,
        turning(automatic_homing=False),
        "home",
        {},
        "spindle s: home refused: the drive homes the spindle from standstill only (P-AXIS-00015 0x100); stop it first; "
        "nothing was changed",
        {},
    ),
    # gears
    (
        24014,
        gears,
        "select_gear",
        {"stage": 3},
        "spindle s: select_gear refused: gear 3 has no record getriebe[i]; known are: 1, 2; nothing was changed",
        {"gear": 3},
    ),
    (
        24015,
        gears,
        "gear_changed",
        {},
        "spindle s: gear_changed refused: no gear change waits for its acknowledgement; nothing was changed",
        {},
    ),
    # synchronous operation
    (
        24019,
        among_others,
        "couple",
        {"master": "s"},
        "spindle s: couple refused: a spindle cannot be its own master; nothing was changed",
        {},
    ),
    (
        24020,
        among_others,
        "couple",
        {"master": "x"},
        "spindle s: couple refused: 'x' is not a spindle of the machine (s, t, u); nothing was changed",
        {"master": "x"},
    ),
    (
        24021,
        among_others,
        "couple",
        {"master": "t", "factor_den": 0.0},
        "spindle s: couple refused: factor_den = 0.0 must not be 0; nothing was changed",
        {"argument": "factor_den", "value": 0.0},
    ),
    (
        24021,
        among_others,
        "couple",
        {"master": "t", "factor_num": 1e9},
        "spindle s: couple refused: factor_num / factor_den = 1e+09 is not within ±1e-06 ... ±1e+06; nothing was changed",
        {"ratio": 1e9, "low": 1e-6, "high": 1e6},
    ),
    (
        24027,
        slave,
        "couple",
        {"master": "u"},
        "spindle s: couple refused: the spindle is a slave of t; decouple it first; nothing was changed",
        {"master": "t"},
    ),
    (
        24022,
        slave,
        "start",
        START,
        "spindle s: start refused: the spindle is a slave of t; command t or decouple the spindle; nothing was changed",
        {"master": "t"},
    ),
    (
        24023,
        among_others,
        "decouple",
        {},
        "spindle s: decouple refused: the spindle is not coupled; nothing was changed",
        {},
    ),
    # below the setpoint
    (
        23060,
        spindle_bench,
        "set_feedforward",
        {"weight_percent": -1.0},
        "spindle s: set_feedforward refused: weight_percent = -1.0 must be a number of 0 or more (G136); nothing was "
        "changed",
        {"weight_percent": -1.0},
    ),
]


@pytest.mark.parametrize(
    ("number", "bench", "command", "arguments", "text", "values"), CASES, ids=[str(case[0]) for case in CASES]
)
def test_refusals_of_a_spindle(
    number: int, bench: Ask, command: str, arguments: dict[str, Any], text: str, values: dict[str, Any]
) -> None:
    record = bench().give(command, **arguments)
    assert (record.accepted, record.error_id, record.message) == (False, number, text)
    assert record.values == pytest.approx(values)
