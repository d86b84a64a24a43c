"""Units of measurement of all arguments of commands and of all fields of states."""

import pytest

from cnc_ptp.protocol.commands import COMMANDS
from cnc_ptp.recording.command_words import argument_words
from cnc_ptp.recording.reader import STATE_TYPES, THREAD_STATE
from cnc_ptp.recording.units import BY_NAME, BY_SUFFIX, MODULO, unit_of, without_role
from cnc_ptp.wire.schemas import load_schema

NUMBERS = {
    name
    for commands in COMMANDS.values()
    for arguments in commands.values()
    for name, argument in arguments.items()
    if argument.kind == "number"
}
TYPES = (*STATE_TYPES, THREAD_STATE)
FIELDS = {field.name: field.type for type_name in TYPES for field in load_schema(type_name).fields}
RATIOS = {"factor", "factor_num", "factor_den", "master_scaling", "slave_scaling"}
OF_THE_MASTER = {"master_position", "master_offset"}
OF_AN_AXIS_BY_NAME = {"value"}


def test_every_number_of_a_command_has_a_unit():
    assert {name for name in NUMBERS if not unit_of(name, "mm", "Nm")} == RATIOS | OF_THE_MASTER | OF_AN_AXIS_BY_NAME


def test_every_measured_field_of_a_state_has_a_unit():
    assert [name for name, kind in FIELDS.items() if kind == "float64" and not unit_of(name, "mm", "Nm")] == []


def test_every_name_and_every_ending_is_in_use():
    names = {*NUMBERS, *FIELDS}
    assert set(BY_NAME) <= {without_role(name).removesuffix(MODULO) for name in names}
    assert [ending for ending in BY_SUFFIX if not any(name.endswith(ending) for name in names)] == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ('{"difference_limit": 1, "master": "x"}', "difference limit = 1 deg, master = x"),
        (
            '{"factor": 2, "master_position": 10, "slave_position": 20}',
            "factor = 2, master position = 10, slave position = 20 deg",
        ),
        ('{"master_offset": 5, "slave_offset": 7}', "master offset = 5, slave offset = 7 deg"),
    ],
)
def test_couplings_count_in_the_unit_of_the_slave(arguments, words):
    assert argument_words(arguments, "deg") == words
