"""The HLI of a whole machine, without ROS: messages in, commands in blocks, functions, life sign, status out."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from hli_support import AXIS, SPINDLE, message
from machine_support import MILL, PTP, MachineBench
from spindle_support import two_gears

from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units, unit_kinds
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.hli.hli import Hli
from cnc_ptp.plc.hli.status import status
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.protocol.axis_states import AxisStateCode as A
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

TWO_M = "%P\nN10 M08\nN20 G01 X5 F3000\nM30"


class Machine(MachineBench):
    """A machine with an HLI; `say` is a message of a PLC."""

    def __init__(self, program: str | None = None, *, machine: MachineParameters = MILL, **options: Any) -> None:
        super().__init__(program, machine=machine, **options)
        plc = self.units["plc"]
        assert isinstance(plc, PlcUnit)
        self.plc = plc
        kinds = unit_kinds(machine)
        numbers = {name: unit.number for name, unit in (*machine.axes.items(), *machine.spindles.items())}
        self.hli = Hli(plc, kinds=kinds, largest_overrides=dict.fromkeys(kinds, 100.0), timeout=0.5, numbers=numbers)
        self._kinds = kinds
        self.now = 0.0

    def say(self, unit: str, source: str = "p1", **served: Any) -> None:
        self.now += 0.01
        self.hli.take(unit, message(self._kinds[unit], source, **served), self.now)

    def shown(self, unit: str) -> dict[str, Any]:
        return status(self.hli.objects[unit], self.plc.reported[unit])  # type: ignore[arg-type]

    def texts(self) -> list[str]:
        return [f"{event.error_id} {event.text}" for event in self.events if event.source == "plc"]


def test_a_command_of_the_plc_acts_in_the_next_block_and_is_recorded() -> None:
    bench = Machine(end_when_idle=False).run(0.1)
    bench.say("x", override=40.0)
    bench.run(0.01)
    assert bench.last("x").override_percent == [40.0] * 10
    (record,) = [record for record in bench.records if record.command == "overlay"]
    assert record.arguments_json == '{"control_unit": "override", "enabled": true, "holder": "p1", "value": 40.0}'
    assert (record.cycle, record.target) == (100, "x")
    bench.run(0.01)
    assert bench.shown("x")["override"] == {
        "enable_r": True, "request_r": 100.0, "state_r": 40.0, "request_hli": 1000, "state_hli": 400,
    }  # fmt: skip


def test_what_a_plc_commanded_is_computed_again_from_the_records_alone() -> None:
    """Also an edge that a client was refused, and what it had asked for meanwhile."""
    bench = Machine(TWO_M, end_when_idle=False)
    for step in range(80):
        if step == 5:
            bench.say("channel", override=30.0, reset=0.0)
        if step == 20:
            bench.give("channel", "set_override", percent=90.0)
            assert not bench.give("channel", "reset").accepted
        if step == 40:
            bench.say("channel", valid=False)
        bench.run(0.01)
    again = OfflineMachine(MILL, build_units(MILL, end_when_idle=False))
    by_block: dict[int, dict[str, list[Command]]] = {}
    for record in bench.records:
        if record.target != "plc":
            by_block.setdefault(record.cycle, {}).setdefault(record.target, []).append(Command.from_record(record))
    for block in range(80):
        outputs = again.replay_tick(by_block.get(block * 10, {}))
        assert outputs["x"].block.set_position == bench.blocks["x"][block].set_position  # type: ignore[union-attr]
        assert outputs["channel"].block.override_percent == bench.blocks["channel"][block].override_percent  # type: ignore[union-attr]
    assert bench.last("channel").override_percent[-1] == 90.0


def test_an_edge_and_an_external_command_are_answered() -> None:
    bench = Machine(end_when_idle=False).run(0.1)
    bench.say("x", reset=1.0, external=AXIS)
    bench.run(0.01)
    assert bench.shown("x")["external"]["command_semaphore"]
    bench.run(0.01)
    shown = bench.shown("x")
    assert shown["external"] == {"command_semaphore": False, "count_r": 1, "error_id": 0, "job": 1}
    assert shown["reset"] == {"enable_r": True, "request_r": False, "count_r": 1, "error_id": 0} and shown["job"] == 1
    bench.run(3.0)
    shown = bench.shown("x")
    assert (shown["set_position"], shown["set_position_hli"], shown["job"]) == (12.5, 125_000, 0)
    bench.say("x", reset=0.0, external={**AXIS, "semaphore": 0})
    bench.say("x", reset=0.0, external={**AXIS, "position": 1e6})
    bench.run(0.02)
    assert bench.shown("x")["external"]["error_id"] == 120002


def test_external_commands_of_a_spindle_are_counted_for_the_plc() -> None:
    bench = Machine(end_when_idle=False).run(0.1)
    bench.say("s", external=SPINDLE)
    bench.run(1.0)
    shown = bench.shown("s")
    assert (shown["set_speed_rpm"], shown["set_speed_hli"], shown["mode"]) == (600.0, 3_600_000, 2)
    assert (shown["plc_commands"], shown["plc_acknowledged"], shown["stopped"]) == (1, 1, False)


def external(bench: Machine, unit: str, **fields: float) -> None:
    """One external command by its semaphore, and the block in which it is carried out."""
    of = SPINDLE if unit == "s" else AXIS
    for semaphore in (1, 0):
        bench.say(unit, external={**of, **fields, "semaphore": semaphore})
        bench.run(0.03)


def test_an_external_command_suppresses_the_override_of_a_spindle() -> None:
    """G167 and G166: 600 rpm although the override is 50 %."""
    bench = Machine(end_when_idle=False).run(0.1)
    bench.give("s", "set_override", percent=50.0)
    external(bench, "s", type=2)
    bench.run(1.0)
    assert bench.last("s").set_speed_rpm[-1] == 300.0
    external(bench, "s", type=8)
    bench.run(1.0)
    assert bench.last("s").set_speed_rpm[-1] == 600.0
    external(bench, "s", type=9)
    bench.run(1.0)
    assert bench.last("s").set_speed_rpm[-1] == 300.0 and bench.shown("s")["plc_commands"] == 1


def test_an_external_command_limits_a_spindle() -> None:
    bench = Machine(end_when_idle=False).run(0.1)
    external(bench, "s", type=10, speed=200.0)
    external(bench, "s", type=2, speed=900.0)
    bench.run(1.0)
    assert bench.last("s").set_speed_rpm[-1] == 200.0
    external(bench, "s", type=1)
    bench.run(1.0)
    external(bench, "s", type=11)
    external(bench, "s", type=2, speed=900.0)
    bench.run(1.0)
    assert bench.last("s").set_speed_rpm[-1] == 900.0


def test_external_commands_couple_and_decouple_an_axis() -> None:
    """By the logical number of the master; the coupling outlives the PLC, which is free to go."""
    bench = Machine(machine=PTP, end_when_idle=False).run(0.1)
    external(bench, "y", type=15, factor=0.5, master=PTP.axes["x"].number)
    assert bench.last("y").master == "x" and bench.shown("y")["external"]["error_id"] == 0
    assert not bench.shown("y")["held"]
    external(bench, "x", type=3, position=100.0, velocity=200.0)
    bench.hli.watch(bench.now + 0.51)
    bench.run(2.0)
    assert not [text for text in bench.texts() if "HLI of y" in text] and bench.last("y").master == "x"
    external(bench, "y", type=17, factor=2.0)
    external(bench, "x", type=1)
    external(bench, "y", type=16)
    assert bench.last("y").master == ""
    external(bench, "y", type=15, factor=0.5, master=99)
    assert bench.shown("y")["external"]["error_id"] == 26164
    reason = "master = 99 is the logical number (P-AXIS-00016) of no axis"
    assert bench.texts()[-1] == f"26164 plc: HLI of y: external command: {reason}; nothing was changed"


def test_a_superimposed_motion_ends_with_its_plc_and_the_motion_below_goes_on() -> None:
    bench = Machine(machine=PTP, end_when_idle=False).run(0.1)
    bench.give("x", "move_absolute", target=500.0, velocity=100.0)
    bench.run(0.5)
    external(bench, "x", type=10, position=400.0, velocity=20.0)
    bench.run(0.5)
    assert bench.shown("x")["holder"] == "p1"
    bench.hli.watch(bench.now + 0.51)
    bench.run(8.0)
    assert [record.command for record in bench.records if record.target == "x"][-1] == "halt_superimposed"
    assert 500.0 + 0.5 * 20.0 < bench.position("x") < 500.0 + 20.0
    text = "no message of 'p1' for 500 ms; its motion is halted; its values hold until others command them"
    assert bench.texts() == [f"26165 plc: HLI of x: {text}, and another PLC may take it"]


# ---------------------------------------------------------------- functions


def test_functions_of_a_served_channel_wait_for_the_plc() -> None:
    bench = Machine(TWO_M, end_when_idle=False)
    bench.say("channel", functions=True)
    bench.run(0.3)
    assert bench.last("channel").state[-1] == C.WAITING
    (request,) = bench.plc.requests_of("channel")
    assert (request.kind, request.number, bench.shown("channel")["acknowledge_enable_r"]) == ("M", 8, True)
    bench.say("channel", functions=True, done=(request.id,))
    bench.run(1.0)
    assert bench.position("x") == 5.0 and bench.plc.requests_of("channel") == []
    bench.say("channel", functions=True)
    bench.say("channel", functions=True, done=(request.id,))  # twice
    bench.run(0.02)
    text = f"plc plc: acknowledge refused: no request {request.id} waits; nothing was changed. Waiting: none"
    assert bench.texts()[-1] == f"22013 {text}"


def test_functions_that_are_never_acknowledged_abort_the_program() -> None:
    bench = Machine(TWO_M, machine=replace(MILL, handshake_timeout_ms=300), end_when_idle=False)
    bench.say("channel", functions=True)
    bench.run(0.6)
    text = "the PLC has not acknowledged request 1 (M08 in line 2) within 0.3 s (P-MACH-00060)"
    effect = "the path stops on its ramp and the program is aborted"
    assert bench.errors() == [f"P-ERR-22016 channel channel: {text}; {effect}"]


def test_a_plc_that_gives_the_channel_back_leaves_its_functions_to_the_machine() -> None:
    bench = Machine(TWO_M, end_when_idle=False)
    bench.say("channel", functions=True)
    bench.run(0.3)
    bench.say("channel", valid=False)
    bench.run(1.0)
    assert bench.position("x") == 5.0
    serves = [record.arguments_json for record in bench.records if record.command == "serve"]
    assert serves == ['{"enabled": true, "unit": "channel"}', '{"enabled": false, "unit": "channel"}']


def test_a_request_of_another_channel() -> None:
    bench = Machine(TWO_M, end_when_idle=False)
    bench.say("channel", functions=True)
    bench.run(0.3)
    bench.hli.objects["channel"].name = "other"
    bench.say("channel", functions=True, done=(1,))
    bench.run(0.01)
    assert bench.texts() == ["26166 plc: HLI of other: request 1 is one of channel; nothing was changed"]


@pytest.mark.parametrize("served", [False, True])
def test_gear_changes_of_a_served_spindle_wait_for_the_plc(served: bool) -> None:
    bench = Machine(machine=replace(MILL, spindles={"s": two_gears()}), end_when_idle=False).run(0.05)
    if served:
        bench.say("s", gear_changed=0.0)
    bench.run(0.01)
    bench.give("s", "select_gear", stage=2)
    bench.run(1.0)
    assert bench.shown("s")["gear_request"] == (2 if served else 0)
    bench.say("s", gear_changed=1.0)
    bench.run(0.1)
    assert (bench.shown("s")["gear"], bench.shown("s")["gear_request"]) == (2, 0)


def test_only_channels_and_spindles_have_functions() -> None:
    bench = MachineBench().run(0.05)
    text = "plc plc: serve refused: unit = 'x' is no channel or spindle; known are: channel, s; nothing was changed"
    record = bench.offline.runner("plc").command(Command("plc", "serve", {"unit": "x", "enabled": True}))
    assert (record.error_id, record.message) == (22001, text)


# ---------------------------------------------------------------- status


def test_objects_whose_plc_is_silent_become_free() -> None:
    bench = Machine(end_when_idle=False).run(0.05)
    bench.say("x", override=40.0)
    bench.hli.watch(9.0)
    bench.run(0.02)
    assert not bench.shown("x")["held"] and bench.shown("x")["override"]["enable_r"]
    text = "no message of 'p1' for 500 ms; its values hold until others command them, and another PLC may take it"
    assert bench.texts() == [f"26165 plc: HLI of x: {text}"]


def test_an_endless_motion_ends_on_its_ramp_when_its_plc_falls_silent() -> None:
    """Closed form of a ramp that does not reach its deceleration: v·sqrt(v / j)."""
    bench = Machine(end_when_idle=False).run(0.1)
    bench.say("x", external={**AXIS, "type": 6, "velocity": 40.0})
    bench.run(1.5)
    bench.hli.watch(bench.now + 0.51)
    bench.run(0.02)
    (halt,) = [record for record in bench.records if record.command == "halt"]
    begin = bench.blocks["x"][halt.cycle // 10 - 1].set_position[-1]  # type: ignore[union-attr]
    bench.run(2.0)
    p = MILL.axes["x"]
    assert p.deceleration**2 / p.jerk > 40.0
    assert bench.position("x") - begin == pytest.approx(40.0 * (0.001 + math.sqrt(40.0 / p.jerk)), abs=1e-6)
    assert bench.last("x").set_velocity[-1] == 0.0


def test_an_endless_motion_has_the_ramps_of_its_external_command() -> None:
    """Acceleration as given; the same command again changes the velocity in motion, and 0 ends it."""
    bench = Machine(end_when_idle=False).run(0.1)
    for velocity, at_end in ((40.0, 40.0), (-20.0, -20.0), (0.0, 0.0)):
        bench.say("x", external={**AXIS, "type": 6, "velocity": velocity, "acceleration": 80.0, "deceleration": 60.0})
        bench.run(3.0)
        assert bench.last("x").set_velocity[-1] == at_end
        bench.say("x", external={**AXIS, "semaphore": 0})
        bench.run(0.02)
    accelerations = [a for block in bench.blocks["x"] for a in block.set_acceleration]  # type: ignore[union-attr]
    assert max(accelerations) == pytest.approx(80.0) and -80.0 <= min(accelerations) <= -60.0
    assert bench.texts() == []


def test_a_spindle_stops_when_its_plc_falls_silent() -> None:
    bench = Machine(end_when_idle=False).run(0.1)
    bench.say("s", external=SPINDLE)
    bench.run(2.0)
    bench.hli.watch(bench.now + 0.51)
    bench.run(3.0)
    assert bench.last("s").set_speed_rpm[-1] == 0.0
    text = "no message of 'p1' for 500 ms; its motion is stopped; its values hold until others command them"
    assert bench.texts() == [f"26165 plc: HLI of s: {text}, and another PLC may take it"]


def test_the_motion_of_a_service_goes_on_when_a_plc_falls_silent() -> None:
    bench = Machine(end_when_idle=False).run(0.1)
    bench.say("x", override=50.0)
    bench.give("x", "move_absolute", target=100.0)
    bench.run(0.1)
    bench.hli.watch(bench.now + 0.51)
    bench.run(10.0)
    assert bench.position("x") == 100.0


def test_a_second_plc_stops_the_motion_of_the_first_and_may_move_afterwards() -> None:
    bench = Machine(end_when_idle=False).run(0.1)
    bench.say("x", "p1", external={**AXIS, "position": 100.0, "velocity": 20.0})
    bench.run(0.1)
    bench.say("x", "p1", external={**AXIS, "semaphore": 0})
    bench.run(0.5)
    assert bench.shown("x")["holder"] == "p1"
    bench.say("x", "p2", external={**AXIS, "position": 0.0})
    bench.run(0.1)
    assert bench.last("x").set_velocity[-1] == 20.0
    bench.say("x", "p2", external={**AXIS, "semaphore": 0})
    bench.say("x", "p2", external={**AXIS, "type": 1})
    bench.run(1.0)
    assert bench.last("x").set_velocity[-1] == 0.0 and bench.position("x") < 100.0
    assert bench.shown("x")["holder"] == ""
    refused = "'p2' commands it too and is refused while 'p1' holds it; nothing was changed"
    stopped = "'p2' stops it while 'p1' holds it; the stop is carried out, nothing else was changed"
    assert bench.texts() == [f"26162 plc: HLI of x: {text}" for text in (refused, stopped)]
    bench.say("x", "p2", external={**AXIS, "semaphore": 0})
    bench.say("x", "p2", external=AXIS)
    bench.run(5.0)
    assert bench.position("x") == 12.5


def test_who_is_led_by_another() -> None:
    bench = Machine("%P\nG01 X20 Y20 F3000\nM30", end_when_idle=False).run(0.3)
    assert [unit for unit in ("channel", "x", "y", "s") if bench.plc.is_led(unit)] == ["x", "y"]
    bench.run(2.0)
    assert not bench.plc.is_led("x")
    assert bench.give("x", "external_enable", mode="absolute").accepted
    bench.run(0.02)
    assert bench.plc.is_led("x")


def test_a_plc_that_is_silent_locks_nobody_out() -> None:
    """Edges are free; a value is taken back by a command of others; its next message counts again."""
    bench = Machine(end_when_idle=False).run(0.1)
    bench.say("channel", reset=0.0, start=0.0)
    bench.say("x", reset=0.0, override=30.0, controller_enable=1.0)
    bench.run(0.02)
    bench.hli.watch(bench.now + 0.51)
    bench.run(0.02)
    assert bench.shown("x")["override"]["state_r"] == 30.0
    for unit in ("channel", "x"):
        assert bench.give(unit, "reset").error_id != 26161
    given = bench.give("x", "set_override", percent=80.0)
    taken = "takes override back from the PLC 'p1', which had commanded 30 and is silent"
    assert (given.accepted, given.message) == (True, f"P-WARN-26180 axis x: set_override {taken}")
    bench.run(0.02)
    assert bench.last("x").override_percent[-1] == 80.0
    assert bench.shown("x")["override"]["enable_r"] is False
    assert "takes controller_enable back from the PLC 'p1'" in bench.give("x", "power", enabled=False).message
    bench.run(0.02)
    assert bench.last("x").state[-1] == A.DISABLED
    bench.say("x", override=30.0, controller_enable=1.0)
    bench.run(0.02)
    assert (bench.last("x").override_percent[-1], bench.last("x").state[-1]) == (30.0, A.STANDSTILL)


def test_what_is_no_number_is_0_in_the_integers_of_the_hli() -> None:
    bench = Machine(end_when_idle=False).run(0.05)
    block = bench.plc.reported["s"]
    block.distance_to_go_deg[-1] = float("nan")  # type: ignore[union-attr]
    assert bench.shown("s")["distance_to_go_hli"] == 0
