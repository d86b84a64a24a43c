"""Notices about friction tables that do not compensate what they should, word for word."""

from __future__ import annotations

from pathlib import Path

import pytest

from cnc_ptp.parameters import ParameterError, load_machine, read_machine

CONFIG = Path(__file__).parents[2] / "config"
MILL = (CONFIG / "mill.yaml").read_text()
LAST = '"8": {in: 500000, out: 262}'


def warnings(text: str) -> list[str]:
    return [*map(str, load_machine(text, "m.yaml").warnings)]


def line_of(text: str, part: str) -> str:
    """m.yaml:line:column of the value behind `part` in the section of x."""
    at = text.index(part, text.index("\n/x:")) + len(part)
    return f"m.yaml:{text.count(chr(10), 0, at) + 1}:{at - text.rindex(chr(10), 0, at)}"


def changed(old: str, new: str) -> str:
    """The mill with the first `old` of x replaced."""
    at = MILL.index(old, MILL.index("\n/x:"))
    return MILL[:at] + new + MILL[at + len(old) :]


@pytest.mark.parametrize(
    ("old", "new", "place", "text"),
    [
        (
            "{in: 1000, out: 278}",
            "{in: 1000}",
            '"2": {in: ',
            "P-COMP-00046 frict_comp.table[2].in of /x: its current P-COMP-00047 is not given, 0 is used",
        ),
        (
            LAST,
            LAST.replace("262", "262000"),
            "500000, out: ",
            "P-COMP-00047 frict_comp.table[8].out of /x: current 262000 is 1048 Nm, above the 4 Nm of the motor "
            "(P-AXIS-00392)",
        ),
        (
            "out: 278",
            "out: -278",
            "in: 1000, out: ",
            "P-COMP-00047 frict_comp.table[2].out of /x: current -278 is negative, it brakes like the friction",
        ),
        (
            "table_entries: 9",
            "table_entries: 7",
            "table_entries: ",
            "P-COMP-00042 frict_comp.table_entries of /x: value 7 leaves table[7], table[8] unused",
        ),
        (
            "mode: 3",
            "mode: 3\n      scaling_factor: 0",
            "scaling_factor: ",
            "P-COMP-00045 frict_comp.scaling_factor of /x: value 0 scales all currents of the table to 0",
        ),
    ],
)
def test_notice(old: str, new: str, place: str, text: str) -> None:
    machine = changed(old, new)
    assert warnings(machine) == [f"{line_of(machine, place)}: {text}"]


def test_the_scaling_factor_counts() -> None:
    """Times -1 all of them brake. 3 times 345 digits would be 4.14 Nm."""
    negative = warnings(changed("mode: 3", "mode: 3\n      scaling_factor: -1000"))
    assert len(negative) == 9 and all("is negative, it brakes" in text for text in negative)
    tripled = changed("mode: 3", "mode: 3\n      scaling_factor: 3000")
    assert warnings(tripled) == []
    assert [text.split(": ", 1)[1] for text in warnings(tripled.replace("out: 300}", "out: 345}", 1))] == [
        "P-COMP-00047 frict_comp.table[0].out of /x: current 1035 is 4.14 Nm, above the 4 Nm of the motor "
        "(P-AXIS-00392)"
    ]


def test_a_force_of_a_linear_motor() -> None:
    table = "frict_comp: {mode: 3, table_entries: 1, table: {'0': {out: 600}}}"
    motor = "antr: {acc_reference_value: 500, torque_scale_num: 500}"
    text = (
        f"/machine: {{ros__parameters: {{axes: [x]}}}}\n/x: {{ros__parameters: {{lr_param: {{frict_comp: 1}}, {table}"
    )
    assert [warning.split(": ", 1)[1] for warning in warnings(f"{text}, {motor}}}}}\n")] == [
        "P-COMP-00047 frict_comp.table[0].out of /x: current 600 is 600 N, above the 500 N of the motor (P-AXIS-00392)"
    ]
    assert warnings(f"{text}}}}}\n") == []  # nobody said what the motor has


def test_a_wrong_index_is_reported_at_the_number_of_entries() -> None:
    machine = changed('"2": {', '"22": {')
    with pytest.raises(ParameterError) as caught:
        load_machine(machine, "m.yaml")
    assert str(caught.value) == (
        f"P-ERR-110591 {line_of(machine, 'table_entries: ')}: compensation list, P-COMP-00042 frict_comp.table_entries "
        "of /x: value 9, but the velocity (P-COMP-00046) of entry 2 is not given; the node does not start"
    )


@pytest.mark.parametrize(("old", "new"), [("mode: 3", "mode: 0"), ("frict_comp: 1}", "frict_comp: 0}")])
def test_a_table_that_is_off_needs_no_remark(old: str, new: str) -> None:
    machine = changed(old, new)
    assert warnings(machine.replace("out: 278", "out: -278", 1)) == []


@pytest.mark.parametrize("name", ["mill", "friction"])
def test_the_examples_have_no_notices(name: str) -> None:
    assert not [text for text in read_machine(CONFIG / f"{name}.yaml").warnings if "frict_comp" in str(text)]
