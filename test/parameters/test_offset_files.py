"""Zero offsets and clamp positions of a machine file and of files that it names, and every error in them, word for word."""

from pathlib import Path

import pytest

from cnc_ptp.nc.radius.radius_state import RadiusSettings, radius_settings
from cnc_ptp.parameters import MachineParameters, ParameterError, load_machine, machine_text, read_machine

MACHINE = """\
/machine: {ros__parameters: {channels: [ch], axes: [x, "y", c]}}
/c: {ros__parameters: {kenngr: {achs_typ: ACHSTYP_ROTATOR}}}
/ch:
  ros__parameters:
"""
END = "; the node does not start"


def machine(*lines: str) -> str:
    """A machine with axes X, Y, C whose channel has the lines, from line 5 on."""
    return MACHINE + "".join(f"    {line}\n" for line in lines)


def read(folder: Path, offsets: str, *lines: str, clamp: str | None = None) -> MachineParameters:
    """The machine of a file in `folder`, with an offset file and the lines."""
    (folder / "offsets.yaml").write_text(offsets)
    names = ["nullp_data: offsets.yaml"]
    if clamp is not None:
        (folder / "clamps.yaml").write_text(clamp)
        names.append("pzv_data: clamps.yaml")
    (folder / "m.yaml").write_text(machine(*names, *lines))
    return read_machine(folder / "m.yaml")


def refusal(folder: Path, offsets: str, *lines: str, clamp: str | None = None) -> str:
    with pytest.raises(ParameterError) as caught:
        read(folder, offsets, *lines, clamp=clamp)
    return str(caught.value).replace(str(folder / "m.yaml"), "m.yaml")


GOOD = """\
# vices of the mill
G54: {name: left vice, X: 100.0001, Y: -50.5}   # mm
G59: {C: 45}                                    # deg
G159=7: {X: 12.5, inactive: [Y, C]}
96: {name: pallet, X: 1}
G53: {Y: 3}
default: G159=7
"""


def test_offsets_of_a_file(tmp_path: Path) -> None:
    offsets = read(tmp_path, GOOD, clamp="0: {name: table, X: 1.5}\n149: {C: -90}\n").channels["ch"].offsets
    assert offsets.zero == {
        0: (0.0, 3.0, 0.0),
        1: (100.0001, -50.5, 0.0),
        6: (0.0, 0.0, 45.0),
        7: (12.5, 0.0, 0.0),
        96: (1.0, 0.0, 0.0),
    }
    assert offsets.inactive == {7: {1, 2}}
    assert offsets.names == {1: "left vice", 96: "pallet"}
    assert (offsets.default, offsets.g53) == (7, True)
    assert offsets.clamp == {0: (1.5, 0.0, 0.0), 149: (0.0, 0.0, -90.0)}


def test_offsets_in_the_machine_file_count_in_units_of_the_lists() -> None:
    text = machine(
        "default_index: 2",
        "np_grp[2].achse[0].versch: 1000001",
        "np_grp: {1: {achse: {2: {versch: -450000, inaktiv: 1}}, bezeichnung: vice}}",
        "pzv_grp[3].achse[1].versatz: 5",
    )
    offsets = load_machine(text, "m.yaml").channels["ch"].offsets
    assert offsets.zero == {1: (0.0, 0.0, -45.0), 2: (100.0001, 0.0, 0.0)}
    assert (offsets.inactive, offsets.names, offsets.default, offsets.g53) == ({1: {2}}, {1: "vice"}, 2, False)
    assert offsets.clamp == {3: (0.0, 0.0005, 0.0)}


def test_file_and_machine_file_complete_each_other(tmp_path: Path) -> None:
    channel = read(tmp_path, "G54: {X: 1}\n", "np_grp[1].achse[1].versch: 20000").channels["ch"]
    assert channel.offsets.zero == {1: (1.0, 2.0, 0.0)}


def test_one_text_has_all_that_a_recording_needs(tmp_path: Path) -> None:
    channel = read(tmp_path, GOOD, clamp="1: {X: 1}").channels["ch"]
    text = machine_text(tmp_path / "m.yaml")
    for file in tmp_path.iterdir():
        file.unlink()
    assert load_machine(text, "m.yaml").channels["ch"].offsets == channel.offsets


def test_a_machine_file_without_others_is_its_own_text(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(machine("max_vb_override: 900")[:-1])
    assert machine_text(tmp_path / "m.yaml") == machine("max_vb_override: 900")[:-1]


@pytest.mark.parametrize(
    ("offsets", "error"),
    [
        ("G60: {X: 1}", "25005 offsets.yaml:1:1: 'G60' is no zero offset, G53 to G59 or G159=0 to G159=96 are"),
        ("g54: {X: 1}", "25005 offsets.yaml:1:1: 'g54' is no zero offset, G53 to G59 or G159=0 to G159=96 are; did you mean G54?"),
        ("vice: {X: 1}", "25005 offsets.yaml:1:1: 'vice' is no zero offset, G53 to G59 or G159=0 to G159=96 are"),
        ("defualt: G54", "25005 offsets.yaml:1:1: 'defualt' is no zero offset, G53 to G59 or G159=0 to G159=96 are; did you mean default?"),
        ("default: G60", "25005 offsets.yaml:1:1: 'G60' is no zero offset, G53 to G59 or G159=0 to G159=96 are"),
        ("G159=97: {X: 1}", "25006 offsets.yaml:1:1: zero offset G159=97 is outside 0 to 96"),
        ("97: {X: 1}", "25006 offsets.yaml:1:1: zero offset 97 is outside 0 to 96"),
        ("-1: {X: 1}", "25005 offsets.yaml:1:1: '-1' is no zero offset, G53 to G59 or G159=0 to G159=96 are"),
        ("G54: {x: 1}", "25005 offsets.yaml:1:10: zero offset G54: 'x' is no axis of /ch (X, Y, C)"),
        ("G54: {XX: 1}", "25005 offsets.yaml:1:11: zero offset G54: 'XX' is no axis of /ch (X, Y, C); did you mean X?"),
        ("G54: {inaktive: [X]}", "25005 offsets.yaml:1:17: zero offset G54: 'inaktive' is no axis of /ch (X, Y, C); did you mean inactive?"),
        ("G54: {inactive: [Z]}", "25005 offsets.yaml:1:17: zero offset G54: 'Z' is no axis of /ch (X, Y, C)"),
        ("G54: {X: 1}\nG54: {Y: 2}", "25002 offsets.yaml:2:1: zero offset G54 is given twice, first in line 1"),
        ("G54: {X: 1}\nG159=1: {Y: 2}", "25002 offsets.yaml:2:1: zero offset G159=1 is given twice, first in line 1"),
        ("G54:\n  X: 1\n  X: 2", "25002 offsets.yaml:3:3: G54 has X twice, first in line 2"),
        ("G54: {X: ten}", "25007 offsets.yaml:1:10: zero offset G54, axis X: value 'ten' is text, a number is needed"),
        ("G54: {X: true}", "25007 offsets.yaml:1:10: zero offset G54, axis X: value true is a boolean, a number is needed"),
        ("G54: {X: }", "25007 offsets.yaml:1:10: zero offset G54, axis X: value null is nothing, a number is needed"),
        ("G54: {X: .nan}", "25008 offsets.yaml:1:10: zero offset G54, axis X: value nan is outside -214748.3647 to 214748.3647"),
        ("G54: {X: 214748.3648}", "25008 offsets.yaml:1:10: zero offset G54, axis X: value 214748.3648 is outside -214748.3647 to 214748.3647"),
        ("G54: {X: 1.00005}", "25008 offsets.yaml:1:10: zero offset G54, axis X: value 1.00005 has more than four decimals"),
        ("G54: {X: {Y: 1}}", "25001 offsets.yaml:1:7: G54, X: a value is expected"),
        ("G54: 5", "25001 offsets.yaml:1:1: zero offset G54: axes with values are expected"),
        ("- G54", "25001 offsets.yaml:1:1: an offset file is a mapping of offsets"),
        ("G54: {X: 1", "25001 offsets.yaml:2:1: YAML syntax error, did not find expected ',' or '}'"),
        ("G54: {X: 1}\n---\nG55: {X: 2}", "25001 offsets.yaml:2:1: an offset file has one YAML document only"),
        (f"G54: {{name: {'v' * 41}}}", f"25008 offsets.yaml:1:13: zero list, P-ZERO-00005 np_grp[1].bezeichnung of /ch: value '{'v' * 41}' is longer than 40 characters"),
        ("G54: {name: 5}", "25007 offsets.yaml:1:13: zero list, P-ZERO-00005 np_grp[1].bezeichnung of /ch: value 5 is an integer, text is needed"),
    ],
)  # fmt: skip
def test_errors_of_an_offset_file(tmp_path: Path, offsets: str, error: str) -> None:
    assert refusal(tmp_path, offsets) == f"P-ERR-{error}{END}"


@pytest.mark.parametrize(
    ("clamp", "error"),
    [
        ("150: {X: 1}", "25006 clamps.yaml:1:1: clamp position 150 is outside 0 to 149"),
        ("G54: {X: 1}", "25005 clamps.yaml:1:1: 'G54' is no clamp position, 0 to 149 are"),
        ("default: 1", "25005 clamps.yaml:1:1: 'default' is no clamp position, 0 to 149 are"),
        ("0: {inactive: [X]}", "25005 clamps.yaml:1:15: clamp position 0: 'inactive' is no axis of /ch (X, Y, C); did you mean name?"),
    ],
)  # fmt: skip
def test_errors_of_a_clamp_position_file(tmp_path: Path, clamp: str, error: str) -> None:
    assert refusal(tmp_path, "", clamp=clamp) == f"P-ERR-{error}{END}"


def test_a_value_in_both_files(tmp_path: Path) -> None:
    told = refusal(tmp_path, "G54: {X: 1}", "np_grp[1].achse[0].versch: 1")
    where = "zero list, P-ZERO-00003 np_grp[1].achse[0].versch of /ch: is given twice, also in m.yaml:6:32"
    assert told == f"P-ERR-25002 offsets.yaml:1:10: {where}{END}"


def test_a_file_that_is_missing_or_no_text(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(machine("nullp_data: nowhere.yaml"))
    subject = "startup list, P-STUP-00011 nullp_data of /ch"
    for name, reason in (("nowhere.yaml", "No such file or directory"), ("bits.yaml", "it is not UTF-8 text")):
        (tmp_path / "bits.yaml").write_bytes(b"\xff\xfe")
        (tmp_path / "m.yaml").write_text(machine(f"nullp_data: {name}"))
        with pytest.raises(ParameterError) as caught:
            read_machine(tmp_path / "m.yaml")
        place = f"{tmp_path / 'm.yaml'}:5:17"
        assert str(caught.value) == f"P-ERR-25017 {place}: {subject}: file {name} cannot be read, {reason}{END}"
    with pytest.raises(ParameterError) as caught:
        load_machine(machine("nullp_data: a.yaml"), "m.yaml")
    assert str(caught.value) == f"P-ERR-25017 m.yaml:5:17: {subject}: the text of file a.yaml is missing{END}"


ZERO = "zero list, P-ZERO-0000"


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("np_grp[97].achse[0].versch: 1", f"25006 m.yaml:5:33: {ZERO}3 np_grp[97].achse[0].versch of /ch: index 97 is outside 0 to 96"),
        ("np_grp[1].achse[3].versch: 1", f"25006 m.yaml:5:32: {ZERO}3 np_grp[1].achse[3].versch of /ch: there is no axis 3, the channel has 3 axes (X, Y, C), the first one is 0"),
        ("np_grp[1].achse[0].versch: 1.5", f"25007 m.yaml:5:32: {ZERO}3 np_grp[1].achse[0].versch of /ch: value 1.5 is a number, an integer is needed"),
        ("np_grp[1].achse[0].versch: 3000000000", f"25008 m.yaml:5:32: {ZERO}3 np_grp[1].achse[0].versch of /ch: value 3000000000 is above the maximum 2147483647 (0.0001°)"),
        ("np_grp[1].achse[0].verschiebung: 1", "25005 m.yaml:5:38: channel /ch has no parameter 'np_grp.1.achse.0.verschiebung'; did you mean np_grp[i].achse[j].versch (P-ZERO-00003)?"),
        ("np_grp[0].achse[0].versch: 1", f"25009 m.yaml:5:32: {ZERO}3 np_grp[0].achse[0].versch of /ch: G53 selects no offset; give P-ZERO-00001 (g53_verfuegbar) = 1 if it shall"),
        ("default_index: 97", f"25008 m.yaml:5:20: {ZERO}2 default_index of /ch: value 97 is above the maximum 96"),
        ("pzv_grp[150].achse[0].versatz: 1", "25006 m.yaml:5:36: clamp list, P-CLMP-00001 pzv_grp[150].achse[0].versatz of /ch: index 150 is outside 0 to 149"),
        ("interpreter.call_depth: 0", "25008 m.yaml:5:29: channel list, P-CHAN-90001 interpreter.call_depth of /ch: value 0 is below the minimum 1"),
        ("interpreter.call_depth: 101", "25008 m.yaml:5:29: channel list, P-CHAN-90001 interpreter.call_depth of /ch: value 101 is above the maximum 100"),
        ("interpreter.repeats: 0", "25008 m.yaml:5:26: channel list, P-CHAN-90002 interpreter.repeats of /ch: value 0 is below the minimum 1"),
        ("interpreter.known_blocks: 1000001", "25008 m.yaml:5:31: channel list, P-CHAN-90003 interpreter.known_blocks of /ch: value 1000001 is above the maximum 1000000"),
        ("interpreter.checked_text: -1", "25008 m.yaml:5:31: channel list, P-CHAN-90005 interpreter.checked_text of /ch: value -1 is below the minimum 0"),
        ("interpreter.blocks_per_cycle: 0", "25008 m.yaml:5:35: channel list, P-CHAN-90006 interpreter.blocks_per_cycle of /ch: value 0 is below the minimum 1"),
        ("interpreter.blocks_per_cycle: 1001", "25008 m.yaml:5:35: channel list, P-CHAN-90006 interpreter.blocks_per_cycle of /ch: value 1001 is above the maximum 1000"),
        ("g81_prog_file: 5", "25007 m.yaml:5:20: channel list, P-CHAN-00161 g81_prog_file of /ch: value 5 is an integer, text is needed"),
        ("g81_prog_file: ../up.nc", "25008 m.yaml:5:20: channel list, P-CHAN-00161 g81_prog_file of /ch: value '../up.nc' must be the name of a file without folder"),
        ("g89_prog_file: ''", "25008 m.yaml:5:20: channel list, P-CHAN-00169 g89_prog_file of /ch: value '' must be the name of a file without folder"),
        (f"g80_prog_file: {'a' * 84}", f"25008 m.yaml:5:20: channel list, P-CHAN-00160 g80_prog_file of /ch: value '{'a' * 56}... is longer than 83 characters"),
        ("g90_prog_file: up.nc", "25005 m.yaml:5:20: channel /ch has no parameter 'g90_prog_file'; did you mean g89_prog_file (P-CHAN-00169)?"),
        ("g81_prog_file: !!python/name:os.system up.nc", "25001 m.yaml:5:20: tags are not supported: !!python/name:os.system"),
        ("g81_prog_file: !foo up.nc", "25001 m.yaml:5:20: tags are not supported: !foo"),
        ("interpreter.folders: cycles", "25007 m.yaml:5:26: channel list, P-CHAN-90004 interpreter.folders of /ch: value 'cycles' is text, a list of names is needed"),
    ],
)  # fmt: skip
def test_errors_of_the_machine_file(line: str, error: str) -> None:
    with pytest.raises(ParameterError) as caught:
        load_machine(machine(line), "m.yaml")
    assert str(caught.value) == f"P-ERR-{error}{END}"


def test_folders_are_relative_to_the_machine_file(tmp_path: Path) -> None:
    limits = "call_depth: 3, repeats: 10, known_blocks: 5, checked_text: 0, blocks_per_cycle: 7"
    text = machine(f"interpreter: {{folders: [cycles, ../shared], {limits}}}")
    (tmp_path / "m.yaml").write_text(text)
    channel = read_machine(tmp_path / "m.yaml").channels["ch"]
    assert channel.folders == (f"{tmp_path}/cycles", f"{tmp_path}/../shared")
    assert (channel.call_depth, channel.repeats, channel.known_blocks) == (3, 10, 5)
    assert (channel.checked_text, channel.blocks_per_cycle) == (0, 7)


def test_compensation_of_the_tool_radius() -> None:
    text = machine("tool_radius: {look_ahead: 7, other_blocks: 20}", "prog_start: {outer_corners: 25}")
    assert radius_settings(load_machine(text, "m.yaml").channels["ch"]) == RadiusSettings(7, 20, True)
    assert radius_settings(load_machine(machine("m_synch: {}"), "m.yaml").channels["ch"]) == RadiusSettings(
        5, 100, False
    )


@pytest.mark.parametrize(
    ("line", "error"),
    [
        (
            "tool_radius: {look_ahead: 0}",
            "25008 m.yaml:5:31: channel list, P-CHAN-90035 tool_radius.look_ahead of /ch: value 0 is below the minimum 1",
        ),
        (
            "tool_radius: {look_ahead: 51}",
            "25008 m.yaml:5:31: channel list, P-CHAN-90035 tool_radius.look_ahead of /ch: value 51 is above the maximum 50",
        ),
        (
            "tool_radius: {other_blocks: 0}",
            "25008 m.yaml:5:33: channel list, P-CHAN-90036 tool_radius.other_blocks of /ch: value 0 is below the minimum 1",
        ),
        (
            "prog_start: {outer_corners: 27}",
            "25008 m.yaml:5:33: channel list, P-CHAN-90037 prog_start.outer_corners of /ch: value 27 is none of 25 (straight lines), 26 (arcs)",
        ),
    ],
)
def test_errors_of_the_compensation_of_the_tool_radius(line: str, error: str) -> None:
    with pytest.raises(ParameterError) as caught:
        load_machine(machine(line), "m.yaml")
    assert str(caught.value) == f"P-ERR-{error}{END}"
