"""What refuses an import or export of lists, word for word: the line, what is wrong with it, what mends it."""

from __future__ import annotations

import pickle

import pytest
from lists_support import END, SMALL, axis_refusal, imported, notes, refusal, small, small_refusal

from cnc_ptp.parameters import ParameterError, errors
from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.lists.exporting import export_lists
from cnc_ptp.parameters.lists.kinds import WORDS
from cnc_ptp.parameters.lists.problems import ListError, ListProblem

KV = "axis list, P-AXIS-00099 getriebe[0].kv of /x"
FEEDFORWARD = "axis list, P-AXIS-00223 vorsteuer.vorsteuerung of /x"
MODES = "NONE, VEL, ACC, JERK, ADD_VEL, ADD_ACC, ADD_JERK"
LINES = [
    ("getriebe[0].kv 1o00 # gain", 25007, 16, f"{KV}: value '1o00' is text, an integer is needed"),
    ("getriebe[0].kv 10.5", 25007, 16, f"{KV}: value 10.5 is a number, an integer is needed"),
    ("getriebe[0].kv 5000000000", 25008, 16, f"{KV}: value 5000000000 is above the maximum 4294967295 (0.01/s)"),
    ("getriebe[0].kv -1", 25008, 16, f"{KV}: value -1 is not above 0 (0.01/s)"),
    (
        "getriebe[0].load 0,45",
        25007,
        18,
        "axis list, P-AXIS-00391 getriebe[0].load of /x: value '0,45' is text, a number is needed",
    ),
    (
        "kenngr.max_vb_override 2001",
        25008,
        24,
        "axis list, P-AXIS-00109 kenngr.max_vb_override of /x: value 2001 is above the maximum 2000 (0.1 %)",
    ),
    (
        "lr_param.frict_comp 2",
        25007,
        21,
        "axis list, P-AXIS-00522 lr_param.frict_comp of /x: value 2 is an integer, true or false (1 or 0) is needed",
    ),
    (
        "vorsteuer.vorsteuerung VEL | ACCC # two",
        25008,
        24,
        f"{FEEDFORWARD}: value 'VEL | ACCC' has 'ACCC', which is none of {MODES}",
    ),
    ("vorsteuer.vorsteuerung VEL |", 25043, 24, "vorsteuer.vorsteuerung: a constant is missing behind |"),
    (
        "vorsteuer.vorsteuerung | VEL",
        25043,
        24,
        "vorsteuer.vorsteuerung: its value cannot be read; write a name, a number or a text in quotes",
    ),
    ("getriebe[6].kv 1000", 25006, 16, "axis list, P-AXIS-00099 getriebe[6].kv of /x: index 6 is outside 0 to 5"),
    ("getriebe[-1].kv 1000", 25006, 1, "getriebe[-1].kv: index '-1' is none; write a number from 0"),
    ("getriebe[1.5].kv 1000", 25006, 1, "getriebe[1.5].kv: index '1.5' is none; write a number from 0"),
    (
        "getriebe[9999999999].kv 1",
        25006,
        1,
        "getriebe[9999999999].kv: index '9999999999' is none; write a number from 0",
    ),
    ("getriebe[0].kv", 25043, 15, "getriebe[0].kv: it has no value; write one behind the name, or delete the line"),
    (
        "getriebe[0].kv # fast",
        25043,
        16,
        "getriebe[0].kv: it has no value; write one behind the name, or delete the line",
    ),
    (
        'antr.sercos.mdt[0].nc_ref "S-0-0036',
        25043,
        27,
        'antr.sercos.mdt[0].nc_ref: a quote is not closed, or no blank is behind it; write "text" and "" for a quote in it',
    ),
    ("end", 25043, 1, "`end` without `beg`; delete it, or write `beg NAME` before the first line"),
]


@pytest.mark.parametrize(("line", "number", "column", "text"), LINES)
def test_a_line(line: str, number: int, column: int, text: str) -> None:
    assert axis_refusal(line) == f"P-ERR-{number} f/achs_mds_x.lis:2:{column}: {text}, in '{line}'{END}"


def test_all_problems_are_said_at_once() -> None:
    lines = axis_refusal("getriebe[0].kv 1o00", "getriebe[9].kv 1", "getriebe[0].load", "lr_param.frict_comp 0", "end")
    assert [line.split()[:2] for line in lines.splitlines()] == [
        ["P-ERR-25007", "f/achs_mds_x.lis:2:16:"],
        ["P-ERR-25006", "f/achs_mds_x.lis:3:16:"],
        ["P-ERR-25043", "f/achs_mds_x.lis:4:17:"],
        ["P-ERR-25043", "f/achs_mds_x.lis:6:1:"],
    ]


def test_a_line_that_is_given_twice() -> None:
    said = axis_refusal("getriebe[0].kv 1000", "", "getriebe[].kv 1000")
    text = "P-AXIS-00099 getriebe[0].kv is given twice, first in line 2; delete one of the lines"
    assert said == f"P-ERR-25002 f/achs_mds_x.lis:4:15: {text}, in 'getriebe[].kv 1000'{END}"


def test_a_value_in_two_lists_of_an_axis() -> None:
    files = {
        "achs_mds_x.lis": "kopf.achs_nr 1\nfrict_comp.mode 3\ngetriebe[0].kv 5\n",
        "achs_kw_x.lis": "frict_comp.mode 3\n",
    }
    text = "P-COMP-00041 frict_comp.mode is given twice, first in f/achs_mds_x.lis:2:1; delete one of the lines"
    assert f"P-ERR-25002 f/achs_kw_x.lis:1:17: {text}, in 'frict_comp.mode 3'{END}" in refusal(files)


def test_a_long_line_is_cut() -> None:
    said = axis_refusal("getriebe[0].kv " + "9" * 5000)
    assert said.endswith(f", in 'getriebe[0].kv {'9' * 82}...'{END}")


def test_sections_that_are_not_ended_as_they_begin() -> None:
    first, second = axis_refusal("beg getriebe[0]", "end vorsteuer").splitlines()
    assert first == (
        f"P-ERR-25043 f/achs_mds_x.lis:2:1: section getriebe[0] has no end; write `end` behind its last line{END}"
    )
    text = "`end` of vorsteuer, but section getriebe[0] of line 2 is open; end that first"
    assert second == f"P-ERR-25043 f/achs_mds_x.lis:3:1: {text}, in 'end vorsteuer'{END}"
    assert "2:1: the section has no end;" in axis_refusal("beg")
    deep = axis_refusal(*["beg"] * 21, *["end"] * 21)
    assert deep == (
        "P-ERR-25043 f/achs_mds_x.lis:22:1: sections are nested deeper than 20 levels; write whole names, in "
        f"'beg'{END}"
    )


def test_characters_that_no_list_has() -> None:
    said = axis_refusal("getriebe[0].kv 10\x07", "# a\x85b\x0c")
    assert said.splitlines() == [
        f"P-ERR-25042 f/achs_mds_x.lis:2:18: character U+0007 cannot stand in a list; delete it{END}",
        f"P-ERR-25042 f/achs_mds_x.lis:3:4: character U+0085 cannot stand in a list; delete it{END}",
    ]


UNREADABLE = [
    (
        "kopf.achs_nr 3\n".encode("utf-16-le"),
        "it has bytes of zero as UTF-16 has, but no byte order mark; save it as UTF-8, or with the mark",
    ),
    (b"\xff\xfea", "it is not UTF-16 text at byte 0; save it as UTF-8"),
    (b"kopf.achs_nr 3 # \x81\xfc", "it is not UTF-8 or Latin-1 text at byte 17; save it as UTF-8"),
    (b"\xef\xbb\xbf\xfc", "it is not UTF-8 text at byte 0; save it as UTF-8"),
]


@pytest.mark.parametrize(("data", "reason"), UNREADABLE)
def test_bytes_that_are_no_text(data: bytes, reason: str) -> None:
    said = small_refusal("achs_mds_y.lis", data)
    assert said == f"P-ERR-25042 f/achs_mds_y.lis:1:1: the list cannot be read, {reason}{END}"


@pytest.mark.parametrize(
    ("encoding", "said"),
    [
        ("utf-8", ""),
        ("utf-8-sig", ""),
        ("utf-16", ", in UTF-16"),
        ("utf-32", ", in UTF-32"),
        ("latin-1", ", in Latin-1 (Windows-1252)"),
    ],
)
def test_an_encoding_that_is_certain_is_read_and_said(encoding: str, said: str) -> None:
    result = small("achs_mds_y.lis", "kopf.achs_nr 3 # Größe\r\n".encode(encoding))
    assert f"f/achs_mds_y.lis: axis list of /y{said}: 1 lines read" in "\n".join(result.report.lines())
    assert "kopf.achs_nr: 3  # Größe" in result.text


def test_two_axes_with_one_number() -> None:
    said = small_refusal("achs_mds_y.lis", "# second\nkopf.achs_nr 1\n")
    text = "axis list, P-AXIS-00016 kopf.achs_nr of /y: value 1 is the logical axis number of /x already"
    assert said == f"P-ERR-25010 f/achs_mds_y.lis:2:14: {text}, in 'kopf.achs_nr 1'{END}"


def test_two_axes_with_one_number_that_have_compensation_lists() -> None:
    """What is wrong is the number, not the compensation lists."""
    compensation = "kopf.achs_nr 1\nfrict_comp.scaling_factor 3\n"
    files = {
        **SMALL,
        "achs_mds_y.lis": "kopf.achs_nr 1\n",
        "achs_kw_x.lis": compensation,
        "achs_kw_y.lis": compensation,
    }
    text = "axis list, P-AXIS-00016 kopf.achs_nr of /y: value 1 is the logical axis number of /x already"
    assert refusal(files) == f"P-ERR-25010 f/achs_mds_y.lis:1:14: {text}, in 'kopf.achs_nr 1'{END}"


def test_a_limit_that_another_line_has() -> None:
    said = axis_refusal("kenngr.swe_pos 5", "# a comment", "kenngr.swe_neg 5")
    text = (
        "axis list, P-AXIS-00177 kenngr.swe_neg of /x: value 5 is not below 5 (0.1 µm) of P-AXIS-00178 kenngr.swe_pos"
    )
    assert said == f"P-ERR-25009 f/achs_mds_x.lis:4:16: {text} in line 2, in 'kenngr.swe_neg 5'{END}"


def test_a_limit_that_another_list_has() -> None:
    """A misplaced line of an axis in its compensation list."""
    scale = "frict_comp.scaling_factor 3\n"
    files = {
        **SMALL,
        "achs_mds_x.lis": "kopf.achs_nr 1\nkenngr.swe_pos 5\n",
        "achs_kw_x.lis": "kenngr.swe_neg 5\n" + scale,
    }
    assert "P-AXIS-00178 kenngr.swe_pos in line 2, in" in refusal(files)
    files = {
        **SMALL,
        "achs_mds_x.lis": "kopf.achs_nr 1\nkenngr.swe_neg 5\n",
        "achs_kw_x.lis": "kenngr.swe_pos 5\n" + scale,
    }
    assert "P-AXIS-00178 kenngr.swe_pos in f/achs_kw_x.lis, line 1, in" in refusal(files)


def test_what_follows_from_a_missing_list_is_not_said() -> None:
    startup = "axes x, t\nachs_mds[0] achs_mds_x.lis\nachs_mds[1] achs_mds_s.lis\nachs_mds[2] achs_mds_t.lis\n"
    files = {**SMALL, "hochlauf.lis": startup, "achs_kw_t.lis": "kopf.achs_nr 7\nfrict_comp.scaling_factor 3\n"}
    assert refusal(files) == (
        "P-ERR-25017 f/hochlauf.lis:4:13: achs_mds[2]: file achs_mds_t.lis is not in f; did you mean achs_mds_x.lis?; "
        f"copy it there, or delete the line, in 'achs_mds[2] achs_mds_t.lis'{END}"
    )


def test_files_that_the_start_up_list_names() -> None:
    startup = (
        "achs_mds[0] ..\\listen\\achs_mds_x.lis\nachs_mds[1] achs_mds_t.lis\nachs_mds[2] ACHS_MDS_X.LIS\nachs_mds[3]\n"
    )
    assert small_refusal("hochlauf.lis", startup).splitlines() == [
        "P-ERR-25017 f/hochlauf.lis:2:13: achs_mds[1]: file achs_mds_t.lis is not in f; did you mean achs_mds_x.lis?; "
        f"copy it there, or delete the line, in 'achs_mds[1] achs_mds_t.lis'{END}",
        "P-ERR-25002 f/hochlauf.lis:3:13: achs_mds[2]: file achs_mds_x.lis is named twice, first in line 1; "
        f"delete one of the lines, in 'achs_mds[2] ACHS_MDS_X.LIS'{END}",
        "P-ERR-25043 f/hochlauf.lis:4:12: achs_mds[3]: it has no value; write one behind the name, or delete the line, "
        f"in 'achs_mds[3]'{END}",
    ]


@pytest.mark.parametrize("line", ["zahl_mds", "zahl_mds # axes"])
def test_a_number_of_files_without_a_value(line: str) -> None:
    startup = f"achs_mds[0] achs_mds_x.lis\nachs_mds[1] achs_mds_s.lis\n{line}\n"
    text = "zahl_mds: it has no value; write one behind the name, or delete the line"
    column = len("zahl_mds") + 1 + (" #" in line)
    assert small_refusal("hochlauf.lis", startup) == (
        f"P-ERR-25043 f/hochlauf.lis:3:{column}: {text}, in '{line}'{END}"
    )


def test_names_of_nodes_in_the_start_up_list() -> None:
    said = small_refusal("hochlauf.lis", "axes x, y\nchannels plc\nspindles\n")
    assert said.splitlines() == [
        "P-ERR-25012 f/hochlauf.lis:1:6: axes names 2, the folder has the lists of 1; name each, or none, "
        f"in 'axes x, y'{END}",
        "P-ERR-25015 f/hochlauf.lis:2:10: channels: 'plc' is taken by another node; write another name, "
        f"in 'channels plc'{END}",
    ]


WRONG = [
    (
        "achs_mds_y.lis",
        "kopf.achs_nr 3\nwz[1].laenge 5\nwz[1].radius 4\n",
        "2:1: this should be an axis list, but looks like a tool list: 2 of its 2 lines are of that; put it in the "
        "start-up list under werkz_data or say --as achs_mds_y.lis=tool, in 'wz[1].laenge 5'",
    ),
    (
        "tools.lis",
        "kopf.achs_nr 4\ngetriebe[0].kv 1\n",
        "2:1: this should be a tool list, but looks like an axis list: 1 of its 1 lines are of that; put it in the "
        "start-up list under achs_mds or say --as tools.lis=axis, in 'getriebe[0].kv 1'",
    ),
    (
        "pzv_data.lis",
        "zahl_mds 1\n",
        "1:1: this should be a clamp position list, but looks like a start-up list: 1 of its 1 lines are of that; "
        "rename it to hochlauf.lis or say --as pzv_data.lis=startup, in 'zahl_mds 1'",
    ),
    (
        "other.lis",
        "# nothing\n",
        "1:1: neither its name nor its parameters tell what list it is; add it to the start-up list or say it with "
        "--as other.lis=axis",
    ),
]


@pytest.mark.parametrize(("name", "content", "text"), WRONG)
def test_a_list_of_the_wrong_kind(name: str, content: str, text: str) -> None:
    assert small_refusal(name, content) == f"P-ERR-25041 f/{name}:{text}{END}"


def test_an_option_that_a_list_contradicts() -> None:
    said = small_refusal("a.lis", "wz[1].laenge 5\n", chosen={"a.lis": WORDS["axis"]})
    assert "a.lis:1:1: this should be an axis list, but looks like a tool list" in said
    said = small_refusal("b.txt", "", chosen={"c.txt": WORDS["axis"]})
    assert said == f"P-ERR-25017 f:1:1: --as: the folder has no file c.txt; did you mean b.txt?{END}"


def test_a_folder_without_lists() -> None:
    said = refusal({"readme.txt": ""})
    assert said == f"P-ERR-25040 f:1:1: no list is here (a file *.lis); name the folder with the lists{END}"


def test_two_start_up_lists() -> None:
    said = refusal({**SMALL, "hochlauf.lis": "", "startup.lis": ""})
    assert said == (
        "P-ERR-25041 f/startup.lis:1:1: hochlauf.lis is a start-up list, too; a folder has one, delete or rename the "
        f"other{END}"
    )


def test_a_list_whose_axis_or_channel_is_unknown() -> None:
    said = small_refusal("achs_kw_q.lis", "frict_comp.scaling_factor 3\n")
    assert said == (
        "P-ERR-25044 f/achs_kw_q.lis:1:1: the axis of this compensation list cannot be told; write kopf.achs_nr into "
        f"it, or call it achs_kw_NAME.lis{END}"
    )
    files = {**SMALL, "sda_mds_b.lis": "spdl_anzahl 0\n", "werkz_data_q.lis": "wz[1].laenge 5\n"}
    assert refusal(files) == (
        "P-ERR-25044 f/werkz_data_q.lis:1:1: the channel of this tool list cannot be told; give it an index in the "
        f"start-up list, or call it werkz_data_NAME.lis{END}"
    )


def test_two_lists_of_a_kind_for_one_axis() -> None:
    files = {**SMALL, "achs_kw_x.lis": "frict_comp.scaling_factor 3\n", "achs_kw_y.lis": "kopf.achs_nr 1\n"}
    assert refusal(files) == (
        "P-ERR-25044 f/achs_kw_y.lis:1:1: achs_kw_x.lis is the compensation list of axis x already; merge them, or "
        f"delete one{END}"
    )


def test_unknown_lines_are_errors_if_asked_for() -> None:
    content = "kopf.achs_nr 1\ngetriebe[0].kvv 5\n???\nspdl_anzahl 1\na_max 4\n"
    assert refusal({"achs_mds_x.lis": content}, strict=True).splitlines() == [
        "P-ERR-25005 f/achs_mds_x.lis:2:1: getriebe[0].kvv: no list has it; did you mean getriebe[i].kv "
        f"(P-AXIS-00099)?, in 'getriebe[0].kvv 5'{END}",
        f"P-ERR-25005 f/achs_mds_x.lis:3:1: no name of a parameter begins it, in '???'{END}",
        "P-ERR-25005 f/achs_mds_x.lis:4:1: spdl_anzahl: P-CHAN-00082 belongs to the lists of channel nodes, "
        f"in 'spdl_anzahl 1'{END}",
        "P-ERR-25005 f/achs_mds_x.lis:5:1: a_max: it may be getriebe[i].dynamik.a_max or "
        f"getriebe[i].beschl_kennlinie.a_max; write the whole name, in 'a_max 4'{END}",
    ]


def test_an_incomplete_machine_is_read_if_asked_for() -> None:
    files = {"sda_mds_channel.lis": "spdl_anzahl 1\n"}
    text = "channel list, P-CHAN-00082 spdl_anzahl of /channel: value 1, but 0 spindles are listed (spindel[i])"
    assert refusal(files) == f"P-ERR-25012 f/sda_mds_channel.lis:1:13: {text}, in 'spdl_anzahl 1'{END}"
    result = imported(files, incomplete=True)
    assert notes(result, "notice") == [f"f/sda_mds_channel.lis:1:13: notice: P-ERR-25012 {text}"]
    assert "P-ERR-25007" in refusal({"sda_mds_channel.lis": "spdl_anzahl one\n"}, incomplete=True)


MACHINE = "/machine: {ros__parameters: {axes: [x]}}\n"


def test_a_machine_with_what_no_list_can_hold() -> None:
    with pytest.raises(ParameterError, match="P-ERR-25005"):
        export_lists(MACHINE + "/x: {ros__parameters: {kvv: 1}}\n", "m.yaml")
    text = '/machine: {ros__parameters: {channels: [c]}}\n/c:\n  ros__parameters:\n    wz.1.name: "a\\nb"\n'
    with pytest.raises(ListError) as caught:
        export_lists(text, "m.yaml")
    assert str(caught.value) == (
        "P-ERR-25046 m.yaml:4:1: the text of wz[1].name has control characters or ends of lines, which no list can "
        f"hold; change it{END}"
    )


def test_the_exception_has_all_problems() -> None:
    one = ListProblem(errors.LIST_LINE, Place("b", 1, 1), "one")
    two = ListProblem(errors.LIST_TEXT, Place("a", 2, 1), "two", "line")
    error = ListError([one, two, one])
    assert error.problems == (two, one)
    assert error.number == errors.LIST_TEXT
    assert str(error) == f"P-ERR-25042 a:2:1: two, in 'line'{END}\nP-ERR-25043 b:1:1: one{END}"
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.problems) == (str(error), error.problems)


def test_a_comment_with_what_no_list_can_hold() -> None:
    with pytest.raises(ListError) as caught:
        export_lists("/machine: {ros__parameters: {axes: [x]}}  # a\ufeffb\n", "m.yaml")
    text = "a comment has control characters, which no list can hold; change it"
    assert str(caught.value) == f"P-ERR-25046 m.yaml:1:1: {text}{END}"
