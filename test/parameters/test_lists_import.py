"""Lists that are read: kinds, units and their names, spellings, values, sections, what the report says."""

from __future__ import annotations

import re

import pytest
from lists_support import SMALL, imported, notes, small, values

from cnc_ptp.parameters import load_machine
from cnc_ptp.parameters.lists.kinds import KINDS, WORDS, by_file_name


def axis(*lines: str) -> dict[str, object]:
    """The values of an axis list with these lines."""
    return values(imported({"achs_mds_x.lis": "\n".join(lines)}).sets["x"])


VALUES = [
    ("getriebe[0].kv 1000 # gain", "getriebe.0.kv", 1000),
    ("getriebe[0].kv\t1000#gain", "getriebe.0.kv", 1000),
    ("  getriebe[0].kv 1000 ( P-AXIS-00099 : gain", "getriebe.0.kv", 1000),
    ("getriebe[0].kv 0x3E8", "getriebe.0.kv", 1000),
    ("getriebe[0].kv 0X3e8", "getriebe.0.kv", 1000),
    ("getriebe[0].kv 001000", "getriebe.0.kv", 1000),
    ("kenngr.swe_neg -0001000", "kenngr.swe_neg", -1000),
    ("getriebe[0].load 4.8E-5", "getriebe.0.load", 4.8e-5),
    ("getriebe[0].load 2", "getriebe.0.load", 2.0),
    ("lr_param.frict_comp 1", "lr_param.frict_comp", True),
    ("lr_param.frict_comp TRUE", "lr_param.frict_comp", True),
    ("vorsteuer.vorsteuerung VEL | ACC # both", "vorsteuer.vorsteuerung", "VEL | ACC"),
    ("vorsteuer.vorsteuerung VEL|ACC", "vorsteuer.vorsteuerung", "VEL | ACC"),
    ("vorsteuer.vorsteuerung 0x3 both", "vorsteuer.vorsteuerung", "VEL | ACC"),
    ('vorsteuer.vorsteuerung "VEL | ACC"', "vorsteuer.vorsteuerung", "VEL | ACC"),
    ("kenngr.achs_mode ACHSMODE_LINEAR | 0x40", "kenngr.achs_mode", 0x41),
    ("kenngr.achs_mode 0x41", "kenngr.achs_mode", 0x41),
    ("kopf.log_achs_name Y", "kopf.log_achs_name", "Y"),
    ('antr.telegram.commands "S-0-0036", S-0-0080', "antr.telegram.commands", ("S-0-0036", "S-0-0080")),
    ("antr.telegram.commands []", "antr.telegram.commands", ()),
]


@pytest.mark.parametrize(("line", "name", "value"), VALUES)
def test_a_value(line: str, name: str, value: object) -> None:
    assert values(imported({"achs_mds_x.lis": line}, incomplete=True).sets["x"])[name] == value


CORRECTED = [
    ("getriebe[].kv 7", "getriebe[].kv is read as getriebe[0].kv (an index was missing)"),
    ("getriebe.kv 7", "getriebe.kv is read as getriebe[0].kv (an index was missing)"),
    ("getriebe[i].kv 7", "getriebe[i].kv is read as getriebe[0].kv (i is no number)"),
    ("kv 7", "kv is read as getriebe[0].kv (its prefix was missing, an index was missing)"),
    ("achs_mode 1", "achs_mode is read as kenngr.achs_mode (its prefix was missing)"),
    ("Getriebe[0].KV 7", "Getriebe[0].KV is read as getriebe[0].kv (names are in small letters)"),
    ("vorsteuer.jerk_fact_nom 7", "vorsteuer.jerk_fact_nom is read as vorsteuer.jerk_fact_num (old spelling)"),
    (
        "getriebe[0].mulit_gain_n 7",
        "getriebe[0].mulit_gain_n is read as getriebe[0].multi_gain_n (old spelling)",
    ),
    ("frict_comp.scaling_factor 5", "it belongs into the compensation list, where an export puts it"),
]


@pytest.mark.parametrize(("line", "text"), CORRECTED)
def test_a_name_that_is_corrected(line: str, text: str) -> None:
    result = imported({"achs_mds_x.lis": f"kopf.achs_nr 1\nkenngr.swe_pos 500\n{line}\n"})
    assert notes(result, "corrected") == [f"f/achs_mds_x.lis:3:1: corrected: {text}"]


UNKNOWN = [
    ("getriebe[0].kvv 7", "getriebe[0].kvv: no list has it; did you mean getriebe[i].kv (P-AXIS-00099)?"),
    ("handbetrieb.hb.vb 7", "handbetrieb.hb.vb: no list has it"),
    ("kopf[0].achs_nr 7", "kopf[0].achs_nr: kopf has no such index; did you mean kopf.achs_nr?"),
    ("getriebe[0][1].kv 7", "getriebe[0][1].kv: getriebe has no such index; did you mean getriebe[i].kv?"),
    ("wz[1].laenge 7", "wz[1].laenge: P-TOOL-00003 belongs to the lists of channel nodes"),
    ("cycle_time_us 7", "cycle_time_us: P-MACH-00001 belongs to the lists of machine nodes"),
    (
        "getriebe[0].vb_min_null 7",
        "getriebe[0].vb_min_null: only spindles have P-AXIS-00216, this is one of the linear axes",
    ),
    ("1 getriebe", "no name of a parameter begins it"),
    ("getriebe[0].kv=7", "no name of a parameter begins it"),
]


@pytest.mark.parametrize(("line", "text"), UNKNOWN)
def test_an_unknown_line_is_kept(line: str, text: str) -> None:
    result = imported({"achs_mds_x.lis": f"kopf.achs_nr 1\nkenngr.swe_pos 500\n  {line}\n"})
    assert notes(result, "unknown") == [f"f/achs_mds_x.lis:3:3: unknown: {text}; kept"]
    assert f"    #? {line}\n" in result.text


def test_sections_stand_for_the_beginning_of_names() -> None:
    lines = ["beg getriebe[0] # gear", "kv 7", "beg dynamik", "a_max 9", "what 1", "end dynamik", "end", "BEGIN", "END"]
    result = imported({"achs_mds_x.lis": "\n".join(["kopf.achs_nr 1", *lines])})
    found = values(result.sets["x"])
    assert (found["getriebe.0.kv"], found["getriebe.0.dynamik.a_max"]) == (7, 9)
    assert "# gear\n" in result.text
    assert "#? getriebe[0].dynamik.what 1\n" in result.text


def test_the_report_counts_lists_and_lines() -> None:
    files = {**SMALL, "notes.txt": "", "achs_mds_x.lis": SMALL["achs_mds_x.lis"] + "kvv 1\nachs_mode 1\n"}
    result = imported(files)
    lines = [re.sub(r"\d+ defaults", "N defaults", line) for line in result.report.lines()]
    assert lines == [
        "f/sda_mds_channel.lis: channel list of /channel: 8 lines read, N defaults",
        "f/achs_mds_x.lis: axis list of /x: 3 lines read, 1 corrected, 1 unknown, N defaults",
        "f/achs_mds_s.lis: axis list of /s: 3 lines read, N defaults",
        "f/achs_mds_x.lis:4:1: unknown: kvv: no list has it; did you mean getriebe[i].kv (P-AXIS-00099)?; kept",
        "f/achs_mds_x.lis:5:1: corrected: achs_mode is read as kenngr.achs_mode (its prefix was missing)",
        "f/notes.txt:1:1: not read: no list, its name does not end in .lis",
        "3 lists: 14 lines read, 1 corrected, 1 unknown, N defaults, 0 notices",
    ]
    full = list(imported(files).report.lines(full=True))
    assert "f/achs_mds_x.lis:3:1: read: getriebe[0].kv 5000 # 50 1/s" in full
    assert "f/achs_mds_x.lis:1:1: default: P-AXIS-00103 getriebe[0].lose 0" in full
    given_values = {node: parameters.given for node, parameters in result.sets.items()}
    defaults = sum(
        name not in given_values[node] for node in ("channel", "x", "s") for name in values(result.sets[node])
    )
    assert len(full) == len(lines) + 14 + defaults


def test_what_the_machine_says_of_a_value_has_its_line() -> None:
    result = small("achs_kw_x.lis", "frict_comp.position_delay 30\n")
    text = "P-COMP-00043 frict_comp.position_delay of /x: value 30 is above the 10 of the manual, accepted"
    assert notes(result, "notice") == [f"f/achs_kw_x.lis:1:27: notice: {text}"]


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("MOS 0x00000001", ""),
        ("0x00000001 MOS", ""),
        ("PLC_INFO | MVS_SVS 0x00020002 # both", ""),
        ("MOS 0x00000002", "the remark says MVS_SVS, the value is MOS; the value counts"),
        ("0x20002 MVS_SVS", "the remark says MVS_SVS, the value is 0x20002; the value counts"),
        ("MOS 5 of them", ""),
        ("MOS (no PLC)", ""),
    ],
)
def test_a_remark_that_says_another_constant(written: str, said: str) -> None:
    content = f"spindel[0].s_synch {written}\n"
    result = imported({"sda_mds_channel.lis": content}, incomplete=True)
    found = [note for note in notes(result, "notice") if "remark" in note]
    assert found == ([f"f/sda_mds_channel.lis:1:20: notice: spindel[0].s_synch: {said}"] if said else [])


def test_a_number_of_files_that_is_not_theirs_is_said() -> None:
    startup = "zahl_mds {} # axes\nachs_mds[0] achs_mds_x.lis\nachs_mds[1] achs_mds_s.lis\n"
    assert not notes(small("hochlauf.lis", startup.format(2)), "notice")
    text = "zahl_mds is 3, but the start-up list names 2; all that it names are read"
    assert notes(small("hochlauf.lis", startup.format(3)), "notice") == [f"f/hochlauf.lis:1:10: notice: {text}"]


def test_a_compensation_list_with_the_number_of_no_axis_is_said() -> None:
    assert not notes(small("achs_kw_x.lis", "kopf.achs_nr 1\n"), "notice")
    text = "kopf.achs_nr is 7, but no axis has this number; this is taken as the list of number 1"
    assert notes(small("achs_kw_x.lis", "kopf.achs_nr 7\n"), "notice") == [f"f/achs_kw_x.lis:1:14: notice: {text}"]


def test_the_text_is_a_machine_file() -> None:
    result = imported()
    machine = load_machine(result.text, "m.yaml")
    assert (list(machine.channels), list(machine.axes), list(machine.spindles)) == (["channel"], ["x"], ["s"])
    assert {node: values(machine.raw(node)) for node in machine.sets} == {
        node: values(parameters) for node, parameters in result.sets.items()
    }


def nodes(files: dict[str, str], **options: object) -> list[str]:
    return list(imported(files, **options).sets)


def test_units_are_called_by_the_files_of_their_lists() -> None:
    assert nodes(SMALL) == ["machine", "channel", "x", "s"]


def test_units_are_called_by_their_channel_where_a_file_has_a_number() -> None:
    numbered = {
        "achsmds1.lis": "achs_mds_x.lis",
        "achsmds2.lis": "achs_mds_s.lis",
        "sda_mds1.lis": "sda_mds_channel.lis",
    }
    assert nodes({name: SMALL[other] for name, other in numbered.items()}) == ["machine", "channel", "x", "s1"]


def test_units_are_called_by_their_numbers_otherwise() -> None:
    files = {"achsmds1.lis": "kopf.achs_nr 7\n", "achsmds2.lis": "kopf.achs_nr 8\nachs_typ 4\n"}
    assert nodes(files) == ["machine", "axis7", "spindle8"]
    assert nodes({"achsmds_plc.lis": ""}) == ["machine", "axis"]


def test_units_are_called_as_the_start_up_list_says() -> None:
    startup = "channels c\naxes x_front, x_back\nspindles []\nzahl_mds 2\nachs_mds[0] b.lis\nachs_mds[1] a.lis # old\nsda_mds[0] k.lis\n"
    files = {
        "hochlauf.lis": startup,
        "a.lis": "kopf.achs_nr 2\n",
        "b.lis": "kopf.achs_nr 1\n",
        "k.lis": "spdl_anzahl 0\n",
    }
    result = imported(files)
    assert list(result.sets) == ["machine", "c", "x_front", "x_back"]
    assert result.sets["x_front"].value("P-AXIS-00016") == 1
    assert "    # achs_mds[1]: old\n" in result.text


def test_a_start_up_list_is_found_by_what_is_in_it() -> None:
    result = imported(
        {
            **SMALL,
            "machine.lis": "konfiguration EIN_KANAL\nachs_mds[0] achs_mds_x.lis\nsda_mds[0] sda_mds_channel.lis\nachs_mds[1] achs_mds_s.lis\n",
            "achs_mds_old.lis": "",
        }
    )
    assert result.report.lists[0].title == "start-up list"
    assert notes(result, "unknown") == ["f/machine.lis:1:1: unknown: konfiguration: no list has it; kept"]
    assert notes(result, "not read") == [
        "f/achs_mds_old.lis:1:1: not read: machine.lis names the axis lists, but not this one"
    ]


def test_files_of_any_name_are_told_by_their_parameters_or_an_option() -> None:
    files = {
        "one.lis": SMALL["achs_mds_x.lis"],
        "two.lis": SMALL["achs_mds_s.lis"],
        "three.lis": SMALL["sda_mds_channel.lis"],
    }
    assert nodes(files) == ["machine", "three", "one", "two"]
    assert nodes({"x.txt": "kopf.achs_nr 1\n"}, chosen={"x.txt": WORDS["axis"]}) == ["machine", "x"]


def test_tables_belong_to_the_channel_of_their_name_or_index() -> None:
    two = {
        "sda_mds_a.lis": "spdl_anzahl 0\n",
        "sda_mds_b.lis": "spdl_anzahl 0\n",
        "pzv_data_a.lis": "pzv_grp[0].bezeichnung A\n",
    }
    assert imported({**two, "werkz_data_b.lis": "wz[3].radius 5\n"}).sets["b"].value("P-TOOL-00004", 3) == 5
    startup = "sda_mds[0] sda_mds_b.lis\nsda_mds[1] sda_mds_a.lis\nwrkz_data[1] tools.lis\n"
    result = imported({**two, "tools.lis": "wz[3].radius 5\n", "hochlauf.lis": startup})
    assert result.sets["a"].value("P-TOOL-00004", 3) == 5
    assert result.sets["a"].value("P-CLMP-00002", 0) == "A"


def test_a_compensation_list_belongs_to_the_axis_of_its_header_name_or_index() -> None:
    text = "frict_comp.scaling_factor 5\n"
    axes = {"achs_mds_x.lis": "kopf.achs_nr 4\n", "achs_mds_y.lis": "kopf.achs_nr 5\n"}
    result = imported({**axes, "achs_kw_x.lis": f"kopf.achs_nr 5 # of y\n{text}"})
    assert result.sets["y"].value("P-COMP-00045") == 5
    assert "    # kopf.achs_nr: of y\n" in result.text
    assert imported({**axes, "achs_kw_y.lis": text}).sets["y"].value("P-COMP-00045") == 5
    startup = "achs_mds[0] achs_mds_x.lis\nachs_mds[1] achs_mds_y.lis\nachs_kw[1] table.lis\n"
    assert imported({**axes, "table.lis": text, "hochlauf.lis": startup}).sets["y"].value("P-COMP-00045") == 5


@pytest.mark.parametrize(
    ("file", "kind", "hint"),
    [
        ("hochlauf.lis", "start-up", ""),
        ("achsmds1.lis", "axis", "1"),
        ("achs_mds_x.lis", "axis", "x"),
        ("AXIS-X.LIS", "axis", "X"),
        ("spindel_s.lis", "axis", "s"),
        ("achskw3.lis", "compensation", "3"),
        ("sda_mds1.lis", "channel", "1"),
        ("channel.lis", "channel", ""),
        ("werkz_d1.lis", "tool", "1"),
        ("nullp_d1.lis", "zero offset", "1"),
        ("pzv_d1.lis", "clamp position", "1"),
    ],
)
def test_names_of_files(file: str, kind: str, hint: str) -> None:
    assert by_file_name(file) == (KINDS[kind], hint)


def test_a_name_that_says_nothing() -> None:
    assert by_file_name("axes.lis") == (None, "axes")
    assert by_file_name("wzx.lis") == (None, "wzx")
