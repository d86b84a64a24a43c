"""A spindle that the path of a channel wants while another channel has it, or that has no power: #CAX, G63, G33."""

from __future__ import annotations

import pytest
from machine_support import ROOT, MachineBench

from cnc_ptp.parameters import MachineParameters, load_machine

SECOND = """
/second:
  ros__parameters:
    gruppe: {"0": {achse: {"0": {bezeichnung: U, log_achs_nr: 9}}}}
    spdl_anzahl: 1
    main_spindle_ax_nr: 3
    main_spindle_name: S
    default_ax_name_of_spindle: C
    spindel: {"0": {bezeichnung: S1, log_achs_nr: 3, m3_synch: MVS_SVS, m5_synch: MVS_SVS, m19_synch: MVS_SVS, s_synch: MVS_SVS}}
/u:
  ros__parameters:
    kopf: {achs_nr: 9}
"""


@pytest.fixture(scope="module")
def machine() -> MachineParameters:
    """The lathe with a second channel, which has an axis of its own and the same main spindle."""
    text = (
        (ROOT / "config" / "lathe.yaml").read_text(encoding="utf-8").replace("    werkz_data: tools/lathe.yaml\n", "")
    )
    text = text.replace("channels: [channel]", "channels: [channel, second]").replace("axes: [x, z]", "axes: [x, z, u]")
    return load_machine(text + SECOND, "two.yaml")


def run(machine: MachineParameters, *blocks: tuple[str, str, float]) -> MachineBench:
    """Manual blocks: channel, text, seconds until the next one."""
    bench = MachineBench(machine=machine, end_when_idle=False).run(0.1)
    for channel, text, seconds in blocks:
        assert bench.give(channel, "mdi", text=text).accepted
        bench.run(seconds)
    return bench


def told(bench: MachineBench, number: int) -> list[str]:
    return [f"{number} {event.text}" for event in bench.all_events if event.error_id == number]


TURNS = "it must be at a standstill (M05 or M19 before)"


@pytest.mark.parametrize("text", ["#CAX", "G63 Z290 F125 S100"])
def test_another_channel_turns_it(machine, text):
    bench = run(machine, ("second", "M03 S100", 1.0), ("channel", text, 0.2))
    assert told(bench, 22060) == [
        f"22060 channel channel: spindle s turns at 100 rpm; {TURNS} in mdi line 1 '{text}';"
        " the path stops on its ramp and the program is aborted"
    ]
    assert bench.position("z") == 300.0
    assert bench.column("s", "set_speed_rpm")[-1] == pytest.approx(100.0)


@pytest.mark.parametrize("text", ["#CAX", "G63 Z290 F125 S100"])
def test_the_path_of_another_channel_moves_it(machine, text):
    """Nothing moves here, and that path keeps its spindle."""
    bench = run(machine, ("second", "#CAX\nG01 C5000 F1000", 2.0), ("channel", text, 0.2))
    assert told(bench, 22062) == [
        f"22062 channel channel: the path of another channel moves spindle s (#CAX or tapping) in mdi line 1 '{text}';"
        " the path stops on its ramp and the program is aborted"
    ]
    assert bench.position("z") == 300.0
    assert bench.column("s", "set_speed_rpm")[-1] == pytest.approx(1000.0 / 360.0)


def test_both_channels_have_it_one_after_the_other(machine):
    """It is free as soon as the other one has given it back; its own path takes it again at once."""
    bench = run(
        machine,
        ("channel", "#CAX\nG01 C90 F6000\n#CAX OFF\n#CAX\nG01 C0\n#CAX OFF", 3.0),
        ("second", "#CAX\nG01 C180 F6000", 3.0),
        ("channel", "G63 Z290 F125 S100\nZ300 S-100", 14.0),
    )
    assert bench.errors() == []
    assert bench.column("s", "set_position_deg")[-1] == pytest.approx(180.0, abs=1e-6)
    assert bench.position("z") == 300.0


def test_a_thread_follows_the_spindle_of_another_channel_until_it_is_stopped(machine):
    bench = run(
        machine,
        ("second", "M03 S400", 0.5),
        ("channel", "G18 G00 X36 Z105", 1.5),
        ("channel", "G33 Z48 K1.5", 2.0),
        ("second", "M05", 1.0),
    )
    assert told(bench, 51109) == [
        "51109 channel channel: spindle s is in Stopping within a thread (G33) in mdi line 1 'G33 Z48 K1.5'; axis X retracts"
        " by 5 mm while the path follows spindle s, then the path stops and the program is aborted"
    ]
    assert bench.position("x") == 41.0


@pytest.mark.parametrize("text", ["#CAX", "G63 Z290 F125 S100"])
def test_a_spindle_without_power_is_no_silent_wait(machine, text):
    bench = MachineBench(machine=machine, end_when_idle=False).run(0.1)
    assert bench.give("s", "power", enabled=False).accepted
    assert bench.give("channel", "mdi", text=text).accepted
    bench.run(0.2)
    refused = "spindle s: follow_path refused: the spindle is in Disabled; power it on; nothing was changed"
    assert told(bench, 22018) == [
        f"22018 channel channel: s has refused a command, P-ERR-24003 {refused};"
        " the path stops on its ramp and the program is aborted"
    ]
