"""The emergency stop of a machine: everything stops at once, is locked, and moves again only when it was reset."""

from __future__ import annotations

import pytest
from machine_support import PTP, MachineBench, assert_axis_smooth, machine
from slave_support import SlaveBench

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

PROGRAM = "%P\nN10 M3 S3000\nN20 G01 X100 F6000\nM30"
PRESS = "- {at: 1.0, to: plc, do: emergency_stop, enabled: on}\n"
RELEASE = "- {at: 2.0, to: plc, do: emergency_stop, enabled: off}\n"
RESET = "- {at: 2.1, to: plc, do: reset}\n"
AFTER = "- {at: 2.2, to: z, do: move_absolute, target: -5}\n- {at: 6.0, to: channel, do: start}"


def test_everything_stops_in_the_same_cycle_and_stays_until_it_is_released_and_reset() -> None:
    bench = MachineBench(PROGRAM, PRESS).run(1.8)
    for unit in ("x", "z", "s"):
        states = bench.column(unit, "state")
        assert states[999] != S.ERROR_STOP and states[1000] == S.ERROR_STOP
        assert set(bench.column(unit, "error_id")[1000:]) == {26168}
    assert bench.column("channel", "state")[1001:] == [C.ERROR] * len(bench.column("channel", "state")[1001:])
    assert bench.last("z").set_velocity[-1] == bench.last("s").set_speed_rpm[-1] == 0.0
    assert bench.last("x").set_velocity[-1] == 0.0
    assert bench.refused("z", "move_absolute", target=0.0).startswith("P-ERR-23005 axis z: move_absolute refused")
    for unit, kind in (("z", "axis"), ("s", "spindle"), ("channel", "channel")):
        text = f"{kind} {unit}: reset refused: the emergency stop holds; release it first; nothing was changed"
        assert bench.refused(unit, "reset") == f"P-ERR-26169 {text}"
    assert bench.refused("plc", "reset") == (
        "P-ERR-26169 plc plc: reset refused: the emergency stop holds; release it first; nothing was changed"
    )
    assert bench.errors()[:5] == [
        "P-ERR-26168 plc plc: emergency stop; axes stop on their emergency ramps, spindles on their own, programs are "
        "aborted",
        "P-ERR-26168 channel channel: emergency stop; the path stops on its ramp and the program is aborted",
        "P-ERR-26168 spindle s: emergency stop; the spindle stops on its ramp (ErrorStop)",
        "P-ERR-26168 axis x: emergency stop; the axis stops on its emergency ramp (ErrorStop)",
        "P-ERR-26168 axis y: emergency stop; the axis stops on its emergency ramp (ErrorStop)",
    ]


def test_after_release_and_reset_everything_works_again() -> None:
    bench = MachineBench(PROGRAM, PRESS + RELEASE + RESET + AFTER).run()
    assert not bench.failed and bench.position("z") == -5.0 and bench.position("x") == 100.0
    error = bench.column("z", "error_id")
    assert [error.index(26168), error.index(0, 1000)] == [1000, 2100]
    assert bench.refusals() == []


def test_a_release_alone_moves_nothing() -> None:
    bench = MachineBench(PROGRAM, PRESS + RELEASE).run(2.5)
    assert bench.last("z").state[-1] == S.ERROR_STOP
    assert bench.refused("z", "move_absolute", target=0.0).startswith("P-ERR-23005 axis z: move_absolute refused")


@pytest.mark.parametrize(("strongest", "used"), [(0.0, 5000.0), (3000.0, 5000.0), (8000.0, 8000.0)])
def test_an_axis_stops_on_its_emergency_ramp(strongest: float, used: float) -> None:
    """From 2000 mm/s in closed form: v/a + a/J, as v is above a²/J; the jerk 50,000 mm/s³ is that of the axis."""
    bench = SlaveBench(machine=machine(PTP, x={"emergency_deceleration": strongest}))
    bench.do("x", "move_absolute", target=5000.0, velocity=2000.0)
    bench.run(1.0)
    pressed = len(bench.column("x", "state"))
    bench.give("plc", "emergency_stop", enabled=True)
    bench.run(1.0)
    v, a = bench.column("x", "set_velocity"), bench.column("x", "set_acceleration")
    assert v[pressed] == 2000.0 and max(map(abs, a[pressed:])) == pytest.approx(used)
    stands = next(cycle for cycle in range(pressed, len(v)) if v[cycle] == 0.0)
    assert (stands - pressed) * 0.001 == pytest.approx(2000.0 / used + used / 50_000.0, abs=0.002)
    assert_axis_smooth(bench.blocks["x"], acceleration=max(used, 5000.0), jerk=50_000.0)


def test_a_ramp_of_an_error_becomes_stronger() -> None:
    stopped = []
    for emergency in (False, True):
        bench = SlaveBench(machine=machine(PTP, x={"emergency_deceleration": 8000.0}))
        bench.do("x", "move_absolute", target=5000.0, velocity=2000.0)
        bench.run(1.0)
        bench.give("x", "upstream_lost", source="plc")
        bench.run(0.1)
        if emergency:
            bench.give("plc", "emergency_stop", enabled=True)
        bench.run(1.0)
        assert bench.last("x").error_id[-1] == 26101
        stopped.append(bench.position("x"))
    assert stopped[1] < stopped[0] - 10.0


def test_pressed_twice_and_released_twice() -> None:
    bench = MachineBench()
    bench.run(0.1)
    answers = [bench.give("plc", "emergency_stop", enabled=on) for on in (True, True, False, False)]
    assert [answer.message for answer in answers] == [
        "",
        "plc plc: the emergency stop is pressed already",
        "",
        "plc plc: the emergency stop is released already",
    ]


def test_a_unit_that_is_disabled_is_locked_too() -> None:
    bench = MachineBench(None, "- {at: 0, to: z, do: power, enabled: off}\n" + PRESS.replace("1.0", "0.1")).run(0.3)
    assert bench.last("z").state[-1] == S.ERROR_STOP
    bench.give("plc", "emergency_stop", enabled=False)
    bench.run(0.05)
    bench.give("plc", "reset")
    bench.run(0.05)
    assert bench.last("z").state[-1] == S.DISABLED


def test_a_gantry_pair_stops_together() -> None:
    bench = SlaveBench()
    bench.do("y", "couple_gantry", master="x", difference_limit=0.5)
    bench.do("x", "move_absolute", target=500.0)
    bench.run(0.5)
    bench.give("plc", "emergency_stop", enabled=True)
    bench.run(2.0)
    x, y = bench.column("x", "set_position"), bench.column("y", "set_position")
    assert x == y and bench.last("y").error_id[-1] == 26168 and bench.last("y").set_velocity[-1] == 0.0
