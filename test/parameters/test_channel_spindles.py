"""The spindles of a channel: topology of the manual's examples, gears, couplings, tools, and their errors."""

from __future__ import annotations

import pytest

from cnc_ptp.parameters import MachineParameters, ParameterError, Synchronisation, ToolLimits, load_machine

NONE = Synchronisation.NO_SYNCH
END = "; the node does not start"
TWO = """\
main_spindle_ax_nr: 11
spdl_anzahl: 2
spindel.0: {bezeichnung: S1, log_achs_nr: 6}
spindel.1: {bezeichnung: S2, log_achs_nr: 11}"""


def machine(*lines: str, second: str = "") -> MachineParameters:
    """Axis x (1), spindles a (6), b (11), c (30); the channel has the lines, from line 4 on."""
    channels = "[ch, ch2]" if second else "[ch]"
    text = f"/machine: {{ros__parameters: {{channels: {channels}, axes: [x], spindles: [a, b, c]}}}}\n"
    text += "/ch:\n  ros__parameters:\n" + "".join(f"    {line}\n" for part in lines for line in part.split("\n"))
    for node, number in (("a", 6), ("b", 11), ("c", 30)):
        gears = "getriebe: {0: {kv: 1000}, 1: {kv: 1000}}"
        text += f"/{node}: {{ros__parameters: {{kopf.achs_nr: {number}, {gears}}}}}\n"
    text += "/x: {ros__parameters: {kopf.achs_nr: 1}}\n"
    return load_machine(text + second, "m.yaml")


def refusal(*lines: str) -> str:
    with pytest.raises(ParameterError) as caught:
        machine(*lines)
    return str(caught.value)


def test_two_channels_with_three_spindles() -> None:
    """TF5200 spindle 2.2.5.2: S1 and the main spindle S2 serve both channels, S3 the first only."""
    second = """/ch2: {ros__parameters: {spdl_anzahl: 2, main_spindle_ax_nr: 11, main_spindle_name: S,
      spindel.0: {bezeichnung: S1, log_achs_nr: 6}, spindel.1: {bezeichnung: S2, log_achs_nr: 11}}}\n"""
    three = TWO.replace("spdl_anzahl: 2", "spdl_anzahl: 3") + "\nspindel.2: {bezeichnung: S3, log_achs_nr: 30}"
    both = machine(three, "gruppe.0.achse.0.log_achs_nr: 1", second=second)
    described = {
        name: [(s.name, s.own_name, s.node, s.number) for s in channel.spindles]
        for name, channel in both.channels.items()
    }
    shared = [("S1", "S1", "a", 6), ("S", "S2", "b", 11)]
    assert described == {"ch": [*shared, ("S3", "S3", "c", 30)], "ch2": shared}
    assert [channel.main_spindle for channel in both.channels.values()] == ["S", "S"]


def test_spindle_that_the_plc_moves() -> None:
    """2.2.2.2: any number that is not taken, no axis list."""
    lines = TWO.replace("log_achs_nr: 11}", "log_achs_nr: 99, plc_control: 1}").replace("nr: 11", "nr: 99")
    spindle = machine(lines).channels["ch"].spindles[1]
    assert (spindle.name, spindle.node, spindle.number, spindle.plc_control) == ("S", "", 99, True)


def test_gears() -> None:
    channel = machine(
        TWO,
        "main_spindle_gear_change: 1",
        "spindel.1.range_table: {0: {min_speed: 50, max_speed: 560}, 1: {min_speed: 400, max_speed: 800}}",
        "spindel.1: {range_way: 1, autom_range: 1}",
    ).channels["ch"]
    first, main = channel.spindles
    assert channel.gear_change
    assert (main.ranges, main.from_top, main.automatic) == (((50.0, 560.0), (400.0, 800.0)), True, True)
    assert (first.ranges, first.from_top, first.automatic) == ((), False, False)
    assert [channel.m_functions[number] for number in range(40, 46)] == [Synchronisation.MVS_SVS] * 6


def test_a_range_above_the_largest_speed_of_its_gear() -> None:
    """The gears of b end at 200 °/s, 33.3 rpm; what is above is refused in motion (24001)."""
    ranges = "spindel.1.range_table: {0: {min_speed: 1, max_speed: 33}, 1: {min_speed: 20, max_speed: 34}}"
    assert tuple(map(str, machine(TWO, "main_spindle_gear_change: 1", ranges).warnings)) == (
        "m.yaml:9:93: P-CHAN-00055 spindel[1].range_table[1].max_speed of /ch: "
        "value 34 (rpm) is above P-AXIS-00212 getriebe[1].vb_max of /b, 33.3333 rpm",
    )
    assert machine(TWO, ranges).warnings == ()


def test_without_gear_change_there_are_no_gear_functions() -> None:
    assert 40 not in machine(TWO).channels["ch"].m_functions


def test_default_couplings() -> None:
    group = "synchro_data.koppel_gruppe.0.paar.{}: {{log_achs_nr_slave: {}, log_achs_nr_master: {}, mode: {}}}"
    view = machine(
        TWO, group.format(0, 1, 1, 0), group.format(1, 6, 11, 1), group.replace("0.p", "2.p").format(0, 6, 11, 1)
    )
    assert view.channels["ch"].coupled == (("S1", "S"),)
    assert tuple(map(str, view.warnings)) == (
        "m.yaml:8:94: P-CHAN-00061 synchro_data.koppel_gruppe[0].paar[0].mode of /ch: "
        "a pair of path axes is not coupled",
        "m.yaml:10:62: P-CHAN-00038 synchro_data.koppel_gruppe[2].paar[0].log_achs_nr_slave of /ch: "
        "only coupling group 0 is used",
    )


def test_tools() -> None:
    """The example of 2.8.5: 10 rpm, 500 rpm, 3000 deg/s²."""
    view = machine(
        TWO,
        "wz.5: {log_ax_nr_spdl: 6, vb_min: 60000, vb_max: 3000000, a_max: 3000}",
        "wz.6: {log_ax_nr_spdl: 11, vb_max: 6000}",
        "wz.7: {log_ax_nr_spdl: 0, vb_max: 6000}",
        "wz.8: {log_ax_nr_spdl: 6, vb_min: 60000, a_max: 3000}",
    )
    assert view.channels["ch"].tools == {
        5: ToolLimits("a", 10.0, 500.0, 3000.0),
        6: ToolLimits("b", None, 1.0, None),
        8: ToolLimits("a", 10.0, None, 3000.0),
    }
    assert [str(notice).partition(": ")[2] for notice in view.warnings] == [
        "P-TOOL-00015 wz[6].a_max of /ch: not given, tool 6 has no such limit",
        "P-TOOL-00014 wz[8].vb_max of /ch: not given, tool 8 has no such limit",
    ]


def test_handshake_timeout() -> None:
    assert machine(TWO).handshake_timeout_ms == 60_000


PLC = TWO.replace("log_achs_nr: 6}", "log_achs_nr: 99, plc_control: 1}")
GROUP = "synchro_data.koppel_gruppe.0.paar.{}: {{log_achs_nr_slave: {}, log_achs_nr_master: {}, mode: 1}}"
CHANNEL = "channel list, "
WRONG = {
    "plc spindle with the number of a spindle": (
        (TWO.replace("log_achs_nr: 6}", "log_achs_nr: 30, plc_control: 1}"),),
        "P-ERR-25010 m.yaml:6:47: channel list, P-CHAN-00036 spindel[0].log_achs_nr of /ch: "
        "value 30 is /c, a spindle with P-CHAN-00069 (plc_control) has a number of its own",
    ),
    "plc spindle twice": (
        (PLC.replace("l: 2", "l: 3"), "spindel.2: {bezeichnung: S3, log_achs_nr: 99, plc_control: 1}"),
        "P-ERR-25010 m.yaml:8:47: channel list, P-CHAN-00036 spindel[2].log_achs_nr of /ch: "
        "value 99 is listed twice in the channel",
    ),
    "plc spindle without a name": (
        (PLC.replace("bezeichnung: S1, ", ""),),
        "P-ERR-25015 m.yaml:2:1: channel /ch: a spindle with P-CHAN-00069 (plc_control) has no node name: "
        "give spindel[i].bezeichnung",
    ),
    "own name of the main spindle": (
        (TWO.replace("S2", "S1"),),
        "P-ERR-25015 m.yaml:7:30: channel /ch: program name S1 is used twice",
    ),
    "name of the main spindle": (
        (TWO.replace("S1", "S"),),
        "P-ERR-25015 m.yaml:7:30: channel /ch: program name S is used twice",
    ),
    "gear function with another synchronisation": (
        (TWO, "main_spindle_gear_change: 1", "m_synch.41: MVS_SNS"),
        "P-ERR-25009 m.yaml:9:17: channel list, P-CHAN-00041 m_synch[41] of /ch: "
        "value MVS_SNS must be MVS_SVS, M41 selects a gear (P-CHAN-00052)",
    ),
    "two synchronisation types": (
        (TWO, "spindel.0.m3_synch: MVS_SVS | MVS_SLM | PLC_INFO"),
        "P-ERR-25009 m.yaml:8:25: channel list, P-CHAN-00045 spindel[0].m3_synch of /ch: "
        "value MVS_SVS | MVS_SLM | PLC_INFO has 2 synchronisation types, one is possible (PLC_INFO may be added)",
    ),
    "two synchronisation types of an H function": (
        (TWO, "h_synch.5: MVS_SVS | MOS"),
        "P-ERR-25009 m.yaml:8:16: channel list, P-CHAN-00027 h_synch[5] of /ch: "
        "value MOS | MVS_SVS has 2 synchronisation types, one is possible (PLC_INFO may be added)",
    ),
    "gear without a record": (
        (TWO, "main_spindle_gear_change: 1", "spindel.1.range_table.3: {min_speed: 1, max_speed: 2}"),
        "P-ERR-25009 m.yaml:9:56: channel list, P-CHAN-00055 spindel[1].range_table[3].max_speed of /ch: "
        "gear stage M43 has no record getriebe[3] in the list of /b",
    ),
    "range upside down": (
        (TWO, "spindel.1.range_table.1: {min_speed: 3, max_speed: 2}"),
        "P-ERR-25009 m.yaml:8:42: channel list, P-CHAN-00058 spindel[1].range_table[1].min_speed of /ch: "
        "value 3 is above the maximum 2 rpm of P-CHAN-00055 spindel[1].range_table[1].max_speed in line 8",
    ),
    "slave not in the channel": (
        (TWO, GROUP.format(0, 30, 6)),
        "P-ERR-25014 m.yaml:8:62: channel list, P-CHAN-00038 "
        "synchro_data.koppel_gruppe[0].paar[0].log_achs_nr_slave of /ch: value 30 is not one of the channel's spindles (6, 11)",
    ),
    "master that the plc moves": (
        (PLC, GROUP.format(0, 11, 99)),
        "P-ERR-25014 m.yaml:8:86: channel list, P-CHAN-00037 synchro_data.koppel_gruppe[0].paar[0].log_achs_nr_master "
        "of /ch: value 99 is a spindle with P-CHAN-00069 (plc_control)",
    ),
    "its own master": (
        (TWO, GROUP.format(0, 6, 6)),
        "P-ERR-25009 m.yaml:8:62: channel list, P-CHAN-00038 synchro_data.koppel_gruppe[0].paar[0].log_achs_nr_slave "
        "of /ch: value 6 is its own master (P-CHAN-00037)",
    ),
    "slave twice": (
        (
            TWO.replace("l: 2", "l: 3") + "\nspindel.2.log_achs_nr: 30\nspindel.2.bezeichnung: S3",
            GROUP.format(0, 6, 11),
            GROUP.format(1, 6, 30),
        ),
        "P-ERR-25009 m.yaml:11:62: channel list, P-CHAN-00038 synchro_data.koppel_gruppe[0].paar[1].log_achs_nr_slave "
        "of /ch: value 6 is slave of two masters",
    ),
    "slave and master": (
        (
            TWO.replace("l: 2", "l: 3") + "\nspindel.2.log_achs_nr: 30\nspindel.2.bezeichnung: S3",
            GROUP.format(0, 6, 11),
            GROUP.format(1, 30, 6),
        ),
        "P-ERR-25009 m.yaml:11:86: channel list, P-CHAN-00037 synchro_data.koppel_gruppe[0].paar[1].log_achs_nr_master "
        "of /ch: value 6 is slave and master in one coupling group",
    ),
    "tool of another spindle": (
        (TWO, "wz.5: {log_ax_nr_spdl: 30, vb_max: 5000, a_max: 10}"),
        "P-ERR-25014 m.yaml:8:28: tool list, P-TOOL-00012 wz[5].log_ax_nr_spdl of /ch: "
        "value 30 is not one of the channel's spindles (6, 11)",
    ),
    "tool upside down": (
        (TWO, "wz.5: {log_ax_nr_spdl: 6, vb_min: 5000, vb_max: 10, a_max: 10}"),
        "P-ERR-25009 m.yaml:8:39: tool list, P-TOOL-00013 wz[5].vb_min of /ch: "
        "value 5000.0 is above the maximum 10.0 (0.001°/s) of P-TOOL-00014 wz[5].vb_max",
    ),
}


@pytest.mark.parametrize(("lines", "text"), WRONG.values(), ids=WRONG)
def test_refusal(lines: tuple[str, ...], text: str) -> None:
    assert refusal(*lines) == text + END


def test_c_axis() -> None:
    channel = machine(TWO, "default_ax_name_of_spindle: C\ncax_face_id: 2\nc_axis.ramp_time: 50").channels["ch"]
    assert (channel.c_axis, channel.path_axes, channel.face_kind, channel.c_axis_ramp) == ("C", ("X", "C"), 2, 0.05)
    assert machine(TWO).channels["ch"].path_axes == ("X",)


def test_name_of_the_c_axis_is_that_of_another_axis() -> None:
    assert refusal(TWO, "default_ax_name_of_spindle: X") == (
        "P-ERR-25009 m.yaml:8:33: channel list, P-CHAN-00010 default_ax_name_of_spindle of /ch: value X is the name of an"
        " axis of the channel (P-CHAN-00006)" + END
    )


def test_c_axis_without_a_spindle() -> None:
    text = """/machine: {ros__parameters: {channels: [ch], axes: [x], spindles: []}}
/ch: {ros__parameters: {default_ax_name_of_spindle: C}}
/x: {ros__parameters: {kopf.achs_nr: 1}}
"""
    with pytest.raises(ParameterError) as caught:
        load_machine(text, "m.yaml")
    assert str(caught.value) == (
        "P-ERR-25009 m.yaml:2:53: channel list, P-CHAN-00010 default_ax_name_of_spindle of /ch: value C, but the channel"
        " has no spindle" + END
    )
