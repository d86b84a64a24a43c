"""Tool tables: a file of its own in mm, records wz[i] in the machine file, what is refused and what a recording keeps."""

from __future__ import annotations

from pathlib import Path

import pytest

from cnc_ptp.parameters import (
    ParameterError,
    Tool,
    ToolTable,
    complete_text,
    load_machine,
    machine_files,
    machine_text,
    read_machine,
)
from cnc_ptp.parameters.read.named_files import split_files

END = "; the node does not start"
MACHINE = """\
/machine: {ros__parameters: {channels: [ch], axes: [x, z, c], spindles: [s]}}
/ch:
  ros__parameters:
    werkz_data: tools.yaml
/c: {ros__parameters: {kenngr.achs_typ: ACHSTYP_ROTATOR}}
"""


def machine(tools: str, *lines: str) -> ToolTable:
    """The tools of a machine with axes X, Z (mm), C (deg) and this table; further lines for the channel."""
    text = MACHINE.replace("tools.yaml\n", "tools.yaml\n" + "".join(f"    {line}\n" for line in lines))
    return load_machine(f"{text}--- # file of the machine: tools.yaml\n{tools}", "dir/m.yaml").channels["ch"].tool_table


def refusal(tools: str, *lines: str) -> str:
    with pytest.raises(ParameterError) as caught:
        machine(tools, *lines)
    return str(caught.value).removeprefix("P-ERR-").replace(END, "").replace("tools.yaml", "t")


def test_values_in_mm_and_degrees() -> None:
    table = machine(
        """
5: {name: finishing, type: turning, orientation: 3, radius: 0.4, offsets: {X: 20.5, z: -41, C: 90},
    wear: {length: -0.1, radius: -0.02, X: 0.03}, length: 12.3456, fixed: yes, valid: false}
6:
  type: grinding
  radius: 2
  d:
    6: {length: 10}
    16: {length: 11, radius: 2.5}
7:
"""
    )
    grinding = Tool(6, 10.0, 2.0, (0.0, 0.0, 0.0), wear=(0.0, 0.0, 0.0), type=2)
    assert table == ToolTable(
        {
            5: Tool(
                5, 12.3456, 0.4, (20.5, -41.0, 90.0), -0.1, -0.02, (0.03, 0.0, 0.0), 3, 1, True, False, (), "finishing"
            ),
            6: grinding,
            7: Tool(7, offsets=(0.0, 0.0, 0.0), wear=(0.0, 0.0, 0.0)),
            16: grinding._replace(length=11.0, radius=2.5),
        },
        present=True,
        complete=True,
    )


def test_limits_for_the_spindle() -> None:
    tools = "5: {spindle: 4, min_speed: 10, max_speed: 500, max_acceleration: 3000}"
    text = f"{MACHINE}--- # file of the machine: tools.yaml\n{tools}"
    channel = load_machine(text, "m.yaml").channels["ch"]
    assert channel.tools[5] == ("s", 10.0, 500.0, 3000.0)


def test_records_in_the_machine_file_by_the_names_of_the_lists() -> None:
    """P-TOOL-00003 to 00008: 0.1 µm, or 0.0001 inch; degrees stay degrees."""
    mm = "wz.1: {laenge: 600000, radius: 200000, ax_versatz: {0: 2050000, 1: -1}, param: {2: 7}, typ: 1, srk_lage: 3}"
    inch = (
        "wz.2: {mass_einheit: 1, laenge: 10000, wear_length: -100, ax_versatz: {2: 900000}, tool_fixed: 1, gueltig: 0}"
    )
    table = machine("", mm, inch, "einrechnen_mit_t: 1", "move_tool_offsets_directly: 1")
    none = (0.0, 0.0, 0.0)
    first = Tool(1, 60.0, 20.0, (205.0, -0.0001, 0.0), wear=none, orientation=3, type=1, values=(0.0, 0.0, 7.0))
    second = Tool(2, 25.4, offsets=(0.0, 0.0, 90.0), wear_length=-0.254, wear=none, fixed=True, valid=False)
    assert table == ToolTable({1: first, 2: second}, present=True, with_t=True, at_once=True, complete=True)


def test_records_with_limits_alone_are_no_tool_table() -> None:
    text = MACHINE.replace("werkz_data: tools.yaml", "wz.5: {log_ax_nr_spdl: 4, vb_max: 6000, a_max: 10}")
    assert load_machine(text, "m.yaml").channels["ch"].tool_table == ToolTable(
        {5: Tool(5, offsets=(0.0,) * 3, wear=(0.0,) * 3, spindle=4)}, complete=True
    )


REFUSALS = {
    "a typo": ("5: {lenght: 10}", "25005 t:1:5: tool T5 has no value 'lenght'; did you mean length?"),
    "a typo in a set": (
        "5: {d: {6: {oriantation: 3}}}",
        "25005 t:1:13: tool T5 D6 has no value 'oriantation'; did you mean orientation?",
    ),
    "no such value": (
        "5: {q: 10}",
        "25005 t:1:5: tool T5 has no value 'q'; known are: name, type, orientation, length, radius, fixed, valid, "
        "spindle, min_speed, max_speed, max_acceleration, offsets, wear, d",
    ),
    "sets in a set": (
        "5: {d: {6: {d: {7: {}}}}}",
        "25005 t:1:13: tool T5 D6 has no value 'd'; known are: name, type, orientation, length, radius, fixed, valid, "
        "spindle, min_speed, max_speed, max_acceleration, offsets, wear",
    ),
    "a tool twice": ("5: {length: 1}\n6: {}\n5: {radius: 1}", "25002 t:3:1: tool T5 is given twice, first in line 1"),
    "a set twice": ("5: {length: 1}\n6: {d: {5: {}}}", "25002 t:2:9: D5 of tool T6 is given twice, first in line 1"),
    "a value twice": ("5: {radius: 1,\n radius: 2}", "25002 t:2:2: tool T5 has radius twice, first in line 1"),
    "an axis twice": (
        "5: {offsets: {X: 1,\n X: 2}}",
        "25002 t:2:2: tool T5, offsets has X twice, first in line 1",
    ),
    "an axis that is not there": (
        "5: {offsets: {Y: 1}}",
        "25005 t:1:18: tool T5 has no offsets of 'Y'; known are: X, Z, C",
    ),
    "wear of nothing": (
        "5: {wear: {lenght: 1}}",
        "25005 t:1:20: tool T5 has no wear of 'lenght'; did you mean length?",
    ),
    "text for a number": (
        "5: {length: long}",
        "25007 t:1:13: tool T5, length: value 'long' is text, a number is needed",
    ),
    "true for a number": (
        "5: {radius: true}",
        "25007 t:1:13: tool T5, radius: value true is a boolean, a number is needed",
    ),
    "no finite number": ("5: {radius: .inf}", "25008 t:1:13: tool T5, radius: value inf is not a finite number"),
    "larger than any number": (
        f"5: {{radius: {10**400}}}",
        f"25008 t:1:13: tool T5, radius: value {10**56}... is not a finite number",
    ),
    "too long": (
        "5: {length: 214748.4}",
        "25008 t:1:13: tool T5, length: value 214748.4 is above the maximum 214748.3647 mm",
    ),
    "too short": (
        "5: {d: {15: {wear: {C: -300000}}}}",
        "25008 t:1:24: tool T5 D15, wear.C: value -300000 is below the minimum -214748.3648 °",
    ),
    "too slow": (
        "5: {max_speed: 0.0001}",
        "25008 t:1:16: tool T5, max_speed: value 0.0001 is below the minimum 0.00016666666666666666 rpm",
    ),
    "no such cutter": (
        "5: {orientation: 10}",
        "25008 t:1:18: tool T5, orientation: value 10 is above the maximum 9",
    ),
    "half a cutter": (
        "5: {orientation: 1.5}",
        "25007 t:1:18: tool T5, orientation: value 1.5 is a number, an integer is needed",
    ),
    "no such type": (
        "5: {type: miller}",
        "25008 t:1:11: tool T5, type: value 'miller' is none of mill, drill, turning, grinding, wire",
    ),
    "not valid, not invalid": (
        "5: {valid: maybe}",
        "25007 t:1:12: tool T5, valid: value 'maybe' is text, true or false (1 or 0) is needed",
    ),
    "a list": ("5: {length: [1, 2]}", "25007 t:1:13: tool T5, length: value [1, 2] is a list, a number is needed"),
    "T0": ("0: {length: 1}", "25008 t:1:1: tool number '0' must be an integer from 1 to 999999999"),
    "a name for a number": ("drill: {}", "25008 t:1:1: tool number 'drill' must be an integer from 1 to 999999999"),
    "D1000": (
        "5: {d: {1000: {length: 1}}}",
        "25008 t:1:9: tool T5: D number '1000' must be an integer from 1 to 999",
    ),
    "T1000 without D": (
        "1000: {length: 1}",
        "25008 t:1:1: tool T1000 needs D numbers of its own (d: ...), its number is above 999",
    ),
    "a tool that is a number": ("5: 3", "25001 t:1:4: tool T5 must be a mapping"),
    "sets that are a number": ("5: {d: 3}", "25001 t:1:8: tool T5, d must be a mapping"),
    "offsets that are a number": ("5: {offsets: 3}", "25001 t:1:14: tool T5, offsets must be a mapping"),
    "a list of tools": ("- {length: 3}", "25001 t:1:1: a tool table is a mapping of T numbers"),
    "two documents": ("5: {}\n---\n6: {}", "25001 t:2:1: a tool table has one YAML document only"),
    "a tag of a value": ("5: {length: !foo 3}", "25001 t:1:13: tags are not supported: !foo"),
    "a tag of a tool": (
        "5: !!python/object/apply:os.system {length: 3}",
        "25001 t:1:4: tags are not supported: !!python/object/apply:os.system",
    ),
    "no YAML": ("5: {length: 1", "25001 t:2:1: YAML syntax error, did not find expected ',' or '}'"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_refused_tables(name: str) -> None:
    tools, text = REFUSALS[name]
    assert refusal(tools) == text


def test_a_value_in_both_files() -> None:
    text = refusal("5: {length: 10}", "wz.5: {laenge: 1}")
    subject = "tool list, P-TOOL-00003 wz[5].laenge of /ch"
    assert text == f"25002 t:1:13: {subject}: is given twice, also in dir/m.yaml:5:20"


def test_the_unit_of_a_tool_of_the_file_is_mm() -> None:
    text = refusal("5: {length: 10}", "wz.5: {mass_einheit: 1}")
    subject = "tool list, P-TOOL-00008 wz[5].mass_einheit of /ch"
    assert text == f"25002 t:1:1: {subject}: is given twice, also in dir/m.yaml:5:26"


def test_offsets_in_the_machine_file_for_an_axis_that_is_not_there() -> None:
    assert refusal("", "wz.5: {ax_versatz: {3: 1}}") == (
        "25006 dir/m.yaml:5:28: tool list, P-TOOL-00006 wz[5].ax_versatz[3] of /ch: "
        "there is no axis 3, the channel has 3 axes (X, Z, C), the first one is 0"
    )


def test_all_problems_of_both_files_are_told() -> None:
    with pytest.raises(ParameterError) as caught:
        machine("5: {length: x, radius: y}", "wz.5: {typ: 9}")
    assert [(problem.place.file, problem.error_id) for problem in caught.value.problems] == [
        ("dir/m.yaml", 25008),
        ("tools.yaml", 25007),
        ("tools.yaml", 25007),
    ]


def test_the_table_is_read_beside_the_machine_file(tmp_path: Path) -> None:
    (tmp_path / "tools.yaml").write_text("5: {length: 10}", encoding="utf-8")
    file = tmp_path / "m.yaml"
    file.write_text(MACHINE, encoding="utf-8")
    assert read_machine(file).channels["ch"].tool_table.tools[5].length == 10.0


def test_a_file_that_is_missing(tmp_path: Path) -> None:
    file = tmp_path / "m.yaml"
    file.write_text(MACHINE, encoding="utf-8")
    with pytest.raises(ParameterError) as caught:
        read_machine(file)
    subject = "startup list, P-STUP-00010 werkz_data of /ch"
    reason = f"{subject}: file tools.yaml cannot be read, No such file or directory"
    assert str(caught.value) == f"P-ERR-25017 {file}:4:17: {reason}{END}"


def test_the_complete_text_is_that_of_a_recording(tmp_path: Path) -> None:
    """It is complete in itself, and completing it again changes nothing."""
    (tmp_path / "tools.yaml").write_text("5: {length: 10}\n", encoding="utf-8")
    file = str(tmp_path / "m.yaml")
    complete = complete_text(MACHINE, file)
    assert split_files(complete)[1] == {"tools.yaml": "5: {length: 10}\n"}
    assert complete_text(complete, "elsewhere/m.yaml") == complete
    assert load_machine(complete, "r:machine.yaml").channels["ch"].tool_table.tools[5].length == 10.0
    plain = "/machine: {ros__parameters: {axes: [x]}}\n"
    assert complete_text(plain, file) == plain


def test_one_text_has_tools_and_offsets(tmp_path: Path) -> None:
    texts = {"tools.yaml": "5: {length: 10}", "zero.yaml": "G54: {X: 1}", "clamp.yaml": "0: {Z: 2}"}
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    file = tmp_path / "m.yaml"
    file.write_text(
        MACHINE.replace("tools.yaml\n", "tools.yaml\n    nullp_data: zero.yaml\n    pzv_data: clamp.yaml\n")
    )
    channel = load_machine(machine_text(file), "elsewhere.yaml").channels["ch"]
    assert split_files(machine_text(file))[1] == texts
    assert machine_files(file) == [tmp_path / name for name in texts]
    assert (channel.offsets.zero, channel.offsets.clamp) == ({1: (1.0, 0.0, 0.0)}, {0: (0.0, 2.0, 0.0)})
    assert channel.tool_table.tools[5].length == 10.0
    assert machine_files(tmp_path / "nowhere.yaml") == []
