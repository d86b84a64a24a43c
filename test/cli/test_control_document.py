"""docs/control.md: each error number of its table is one of the code, with its meaning."""

import inspect
import re
from importlib import import_module

import pytest
from commands_support import ROOT

ROW = re.compile(r"^\| ([0-9][0-9a-fx (),–]*) \| [MPWRF] \| (.+) \|$")
HEAD = "## Errors, warnings, faults\n"

NAMES = {
    17744: ("control.faults", "FOLLOWING_ERROR", "following error"),
    23060: ("control.commands", "BAD_WEIGHT", "weight_percent"),
    23061: ("control.commands", "FEEDFORWARD_WAITS", "feedforward waits"),
    23062: ("control.commands", "WEIGHT_LIMITED", "limited to it"),
    25008: ("parameters.errors", "OUT_OF_RANGE", "out of range"),
    25009: ("parameters.errors", "CONTRADICTION", "above max_points"),
    25019: ("parameters.errors", "DENOMINATOR", "denominator"),
    25020: ("parameters.errors", "TELEGRAM", "object"),
    70082: ("control.faults", "TARGET_MISSED", "away from its target"),
    70350: ("parameters.check.control_checks", "NO_ADDITIVE_VELOCITY", "additive velocity"),
    70351: ("parameters.check.control_checks", "NO_ADDITIVE_TORQUE", "additive torque"),
    70495: ("control.commands", "NO_FRICTION_COMPENSATION", "friction compensation"),
    110579: ("parameters.check.control_checks", "GEAR_DENOMINATOR", "denominator of a gear ratio"),
    110591: ("parameters.check.control_checks", "TABLE_NOT_ASCENDING", "ascend"),
    110592: ("parameters.check.control_checks", "TABLE_MISSING", "mode unknown"),
    110641: ("parameters.check.runtime_change", "MEMORY_IS_FIXED", "max_points cannot be changed"),
    27001: ("commissioning.faults", "UNKNOWN_AXIS", "unknown axis"),
    27002: ("commissioning.faults", "NOT_RECORDED", "not recorded"),
    27003: ("commissioning.faults", "TOO_SHORT", "too short"),
    27004: ("commissioning.faults", "NO_MOTION", "does not move"),
    27005: ("commissioning.faults", "NO_TORQUE", "no torque"),
    27006: ("commissioning.faults", "NOT_STEADY", "no steady motion"),
    27007: ("commissioning.faults", "ONE_DIRECTION", "one direction only"),
    27008: ("commissioning.faults", "NO_FRICTION", "no friction"),
    27009: ("commissioning.faults", "NO_SCALE", "no drive unit"),
    27010: ("commissioning.faults", "NO_ROOM", "no room"),
    27011: ("commissioning.faults", "BAD_VELOCITIES", "velocity not above 0"),
    27012: ("commissioning.faults", "NOT_EXCITED", "velocity never changes"),
    27013: ("commissioning.faults", "NO_FIT", "first-order lag"),
    27014: ("commissioning.faults", "NO_COMMAND", "not commanded a velocity"),
    27020: ("commissioning.faults", "BAD_CIRCLE", "number out of range"),
    27022: ("commissioning.faults", "NOT_COVERED", "turn not driven to its end"),
    27023: ("commissioning.faults", "NOTHING_TO_COMPARE", "nothing to compare"),
    27024: ("commissioning.faults", "BAD_PLANE", "plane"),
    27030: ("commissioning.faults", "BAD_OUTPUT", "overwrite an input"),
    27040: ("commands.commissioning.axis_data", "NO_MACHINE", "no machine file"),
}
"""Number: module and name of the constant, and what the document must say of it."""
PROGRAM = {
    21090: ("WEIGHT_RANGE", "weight", "weight below 0"),
    21091: ("WEIGHTS_WITHOUT_AXIS", "without an axis", "no axis"),
    21092: ("WEIGHTS_AND_MOTION", "takes the axis words of its block", "together with a motion"),
    21093: ("FEEDFORWARD_ALONE", "in the brackets", "wrong words in brackets"),
    21094: ("WEIGHT_MISSING", "without a weight", "wrong words in brackets"),
    21095: ("SELECTION_WITH_VALUE", "takes no value", "wrong words in brackets"),
    21096: ("COMP_FIRST", "begin with COMP", "COMP of an axis: order"),
    21097: ("COMP_WORD", "not available after COMP", "unknown word"),
    21098: ("COMP_INCOMPLETE", "does not say", "incomplete"),
    21099: ("COMP_TWICE", "twice in one block", "twice in a block"),
    21110: ("SLOPE_UNKNOWN", "is not known", "unknown type"),
    21111: ("SLOPE_NOT_AVAILABLE", "is not available", "HSC is not available"),
}
"""Faults of the NC language: name, what their text says, what the document says."""
NOTICES = {
    70348: ("ids.VORSTEUER_ACCELERATION_DELAY_TIME: 70348", "P-AXIS-00390"),
    70349: ("ids.VORSTEUER_VELOCITY_DELAY_TIME: 70349", "P-AXIS-00389"),
    110465: ("NO_TORQUE_SCALE = 110465", "no additive torque is output"),
    110473: ("NO_JERK_DENOMINATOR = 110473", "100 is used"),
}
"""Warnings of a machine file: source of parameters/check/control_notices.py, what the document says."""


def documented():
    """Number -> text of its row, ranges number by number."""
    table = (ROOT / "docs" / "control.md").read_text(encoding="utf-8").split(HEAD)[1]
    found = {}
    for line in table.splitlines():
        if row := ROW.match(line):
            for part in re.sub(r"\(.*?\)", "", row[1]).split(","):
                first, *last = (int(number) for number in part.split("–"))
                found |= dict.fromkeys(range(first, last[0] + 1 if last else first + 1), row[2])
    return found


def test_the_table_has_these_numbers_and_no_others():
    assert set(documented()) == {*NAMES, *PROGRAM, *NOTICES}


@pytest.mark.parametrize("number", NAMES)
def test_numbers_of_constants(number):
    module, name, said = NAMES[number]
    assert getattr(import_module(f"cnc_ptp.{module}"), name) == number
    assert said in documented()[number]


@pytest.mark.parametrize("number", PROGRAM)
def test_numbers_of_program_faults(number):
    name, template, said = PROGRAM[number]
    fault = getattr(import_module("cnc_ptp.nc.faults"), name)
    assert fault.number == number and template in fault.template
    assert said in documented()[number]


@pytest.mark.parametrize("number", NOTICES)
def test_numbers_of_warnings(number):
    source, said = NOTICES[number]
    assert source in inspect.getsource(import_module("cnc_ptp.parameters.check.control_notices"))
    assert said in documented()[number]
