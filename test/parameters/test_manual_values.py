"""The declarations against the manuals, whose values manual_values.yaml has by a second hand.

Every parameter of the manuals is declared as it is printed, and a machine file with it at its limits loads; one step
beyond it is refused, or corrected with the number that the manual gives. Where we differ, the table says why.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import yaml

from cnc_ptp.parameters import ParameterError, catalogue, load_machine
from cnc_ptp.parameters.declare.declarations import Declaration

TABLE = yaml.safe_load(Path(__file__).with_name("manual_values.yaml").read_text(encoding="utf-8"))
DESCRIBED: dict[str, dict[str, Any]] = TABLE["described"]
MENTIONED: dict[str, dict[str, Any]] = TABLE["mentioned"]
ENDS = {
    "MAX(UNS16)": 65535,
    "MAX(UNS32)": 4294967295,
    "MIN(SGN16)": -32768,
    "MAX(SGN16)": 32767,
    "MIN(SGN32)": -2147483648,
    "MAX(SGN32)": 2147483647,
}
BITS = {"UNS16": (0, 65535), "UNS32": (0, 4294967295), "SGN16": (-32768, 32767), "SGN32": (-2147483648, 2147483647)}
TYPES = {"T": "ACHSTYP_TRANSLATOR", "R": "ACHSTYP_ROTATOR", "S": "ACHSTYP_SPINDEL"}
CYCLE_US = 1000
OTHERS = {
    "P-AXIS-00008": 5000,
    "P-AXIS-00127": -1000,
    "P-AXIS-00126": 900000,
    "P-AXIS-00177": -70000,
    "P-AXIS-00178": 80000,
    "P-AXIS-00212": 900000,
    "P-AXIS-00242": 800000,
    "P-AXIS-00265": 70000,
    "P-CHAN-00055": 600,
    "P-COMP-00062": 12,
    "P-TOOL-00014": 3000.0,
}
"""What a parameter that is a limit is set to; the axis must permit it."""
NEEDS: dict[str, dict[str, Any]] = {
    "P-AXIS-00156": {"kenngr.ref_ohne_rev": 1},
    "P-AXIS-00223": {"kenngr.antr_typ": 4},
    "P-COMP-00041": {"frict_comp.table_entries": 1},
    "P-AXIS-00079": {"getriebe.0.kv": 1000, "getriebe.5.kv": 1000},
}
"""What a value needs beside it: another parameter, so that the value itself is judged."""


class Expected(NamedTuple):
    """What we declare: the printed values, with ours where the table gives a reason."""

    number: str
    values: Mapping[str, Any]

    @property
    def type(self) -> str:
        return str(self.values["type"])

    @property
    def integer(self) -> bool:
        return self.type in BITS

    def limit(self, upper: bool) -> tuple[float | int | None, str]:
        """The last permitted value at one end (None: no limit), and the parameter that is the limit."""
        inclusive, exclusive = ("max", "below") if upper else ("min", "above")
        ours = self.values.get("ours", {})
        source = ours if inclusive in ours or exclusive in ours else self.values
        printed = source.get(inclusive, source.get(exclusive))
        other = printed if isinstance(printed, str) and printed.startswith("P-") else ""
        value = OTHERS[printed] if other else ENDS.get(printed, printed)
        if value is not None and inclusive not in source:
            value = value - 1 if upper else value + 1
        return value, other


def expected(number: str) -> Expected:
    return Expected(number, DESCRIBED[number])


def declared(number: str) -> Declaration:
    return catalogue().by_id[number]


def ours(number: str, key: str) -> Any:
    """A value of the table, ours where it differs."""
    row = DESCRIBED[number]
    return row.get("ours", {}).get(key, row.get(key))


# the declarations as data


def test_as_many_as_the_manuals_have() -> None:
    assert (len(DESCRIBED), len(MENTIONED) + len(TABLE["slips"])) == (95, 26)


def test_every_parameter_of_the_manuals_is_declared() -> None:
    assert not {*DESCRIBED, *MENTIONED} - set(catalogue().by_id)


@pytest.mark.parametrize("number", DESCRIBED)
def test_declared_as_printed(number: str) -> None:
    entry = declared(number)
    unit = ours(number, "unit")
    assert entry.name == ours(number, "name")
    assert entry.data_type == ours(number, "type")
    assert entry.axes == (ours(number, "axes") or ("TRS" if number.startswith("P-COMP") else ""))
    assert entry.default == ours(number, "default")
    assert list(entry.unit) == (unit if isinstance(unit, list) else [unit, unit])
    assert sorted(filter(None, entry.drives.split(", "))) == sorted(ours(number, "drives") or ())
    assert entry.since == (ours(number, "since") or "")
    pages = {DESCRIBED[number]["page"], DESCRIBED[number].get("also")} - {None}
    assert any(entry.source.startswith(page) for page in pages), entry.source


@pytest.mark.parametrize("number", [number for number, row in DESCRIBED.items() if row["type"] == "STRING"])
def test_texts_and_constants_as_printed(number: str) -> None:
    entry, row = declared(number), DESCRIBED[number]
    if "choices" in row:
        assert dict(entry.choices) == row["choices"]
    else:
        assert entry.max_length == row["length"]
        assert entry.form.startswith(f"[{row['first']}]" if len(row["first"]) > 1 else row["first"])


@pytest.mark.parametrize("number", MENTIONED)
def test_mentioned_only(number: str) -> None:
    """Those that do nothing here say so when a machine file gives them."""
    entry, row = declared(number), MENTIONED[number]
    assert bool(entry.effective) == row.get("effect", True)
    if row.get("effect", True):
        return
    name = entry.ros_name(tuple([0] * entry.index_count))
    for letter in entry.axes:
        machine = load_machine(machine_text(letter, {name: entry.default}), "m.yaml")
        told = [line.text for line in machine.warnings if line.parameter.startswith(number)]
        assert told == ["accepted, but without effect in this version"]


@pytest.mark.parametrize("number", TABLE["slips"])
def test_a_slip_is_not_declared_as_what_it_is_not(number: str) -> None:
    """Only P-AXIS-00058 is in the vendor's lists as well, as something else."""
    assert (number in catalogue().by_id) == (number == "P-AXIS-00058")


@pytest.mark.parametrize("number", catalogue().by_id)
def test_drive_types_are_those_of_the_drive_type(number: str) -> None:
    assert set(declared(number).drive_types) <= set(catalogue().by_id["P-AXIS-00020"].choices)


# a machine file with one value


def machine_text(letter: str, values: Mapping[str, Any]) -> str:
    """A machine with one axis of a type (T, R, S) and its values, or with a channel of its own (letter C)."""
    where = "spindles: [s]" if letter in "SC" else "axes: [x]"
    lines = [f"/machine: {{ros__parameters: {{channels: [c], {where}, cycle_time_us: {CYCLE_US}}}}}"]
    node = {"S": "s", "C": "c"}.get(letter, "x")
    given = dict(values) if letter == "C" else {"kenngr.achs_typ": TYPES[letter], **values}
    lines.append(f"/{node}: {{ros__parameters: {yaml.safe_dump(given, default_flow_style=True, width=9999).strip()}}}")
    return "\n".join(lines) + "\n"


def outcome(number: str, letter: str, value: Any) -> tuple[set[int], set[int]]:
    """Numbers of the problems and of the warnings about the parameter itself."""
    entry = declared(number)
    name = entry.ros_name(tuple([0] * entry.index_count))
    limits = {declared(other).ros_name((0, 0)): OTHERS[other] for other in of_limits(number)}
    values = {**limits, **NEEDS.get(number, {}), name: value}
    known = {other: given for other, given in values.items() if belongs(other, letter)}
    try:
        machine = load_machine(machine_text(letter, known), "m.yaml")
    except ParameterError as error:
        return {problem.error_id for problem in error.problems if number in problem.text}, set()
    return set(), {line.error_id for line in machine.warnings if line.parameter.startswith(number)}


def of_limits(number: str) -> Iterator[str]:
    yield from (other for _, other in (expected(number).limit(False), expected(number).limit(True)) if other)
    if number == "P-AXIS-00241":
        yield "P-AXIS-00212"
    if number == "P-AXIS-00242":
        yield "P-AXIS-00212"


def belongs(ros_name: str, letter: str) -> bool:
    key = ".".join("*" if part.isdecimal() else part for part in ros_name.split("."))
    kind = {"S": "spindle", "C": "channel"}.get(letter, "axis")
    entry = catalogue().by_key[kind].get(key)
    return entry is not None and (letter == "C" or letter in entry.axes)


def letters_of(number: str) -> str:
    """The axis types that have it; C for one of a channel."""
    return declared(number).axes or "C"


RANGE = (25008, 25009)
"""Out of range; beyond the limit that another parameter is."""


def steps() -> Iterator[Any]:
    """Parameter, axis type, value at a limit, value one step beyond; for each end and axis type."""
    for number in DESCRIBED:
        row = expected(number)
        if row.type in ("STRING", "BOOLEAN") or "choices" in row.values:
            continue
        for letter in letters_of(number):
            for upper in (False, True):
                limit, other = row.limit(upper)
                if limit is None or (other and not belongs(declared(other).ros_name((0, 0)), letter)):
                    continue
                beyond = (
                    limit + (1 if upper else -1) if row.integer else math.nextafter(limit, math.inf * (2 * upper - 1))
                )
                yield pytest.param(number, letter, limit, beyond, id=f"{number}-{letter}-{'max' if upper else 'min'}")


@pytest.mark.parametrize(("number", "letter", "limit", "beyond"), [*steps()])
def test_at_a_limit_and_one_step_beyond(number: str, letter: str, limit: float, beyond: float) -> None:
    problems, _ = outcome(number, letter, limit)
    assert not problems & {*RANGE}
    problems, warnings = outcome(number, letter, beyond)
    zero = DESCRIBED[number].get("zero")
    if beyond == 0 and zero:
        assert zero in problems | warnings
    elif beyond == 0 and "unset" in DESCRIBED[number]:
        assert DESCRIBED[number]["unset"] == 0
        assert not problems & {*RANGE}
    else:
        assert problems & {*RANGE}


@pytest.mark.parametrize("letter", "TRS")
@pytest.mark.parametrize("number", ["P-AXIS-00389", "P-AXIS-00390"])
def test_delays_below_six_cycles(number: str, letter: str) -> None:
    """Beyond six cycles the value is corrected to 0, with the number that the manual gives."""
    row = DESCRIBED[number]
    limit = row["cycles_below"] * CYCLE_US
    assert outcome(number, letter, limit - 1) == (set(), set())
    assert outcome(number, letter, limit) == (set(), {row["warning"]})


@pytest.mark.parametrize(
    "number", [number for number, row in DESCRIBED.items() if isinstance(row.get("choices"), list)]
)
def test_choices(number: str) -> None:
    row = DESCRIBED[number]
    low, high = min(row["choices"]), max(row["choices"])
    for letter in letters_of(number):
        for value in range(max(low - 1, 0), high + 2):
            problems, _ = outcome(number, letter, value)
            permitted = value in row["choices"] or value == row.get("unset", low)
            assert bool(problems & {25008, row.get("refusal")}) != permitted, (letter, value)


@pytest.mark.parametrize(
    "number", [number for number, row in DESCRIBED.items() if isinstance(row.get("choices"), dict)]
)
def test_constants(number: str) -> None:
    """By name and by number; P-AXIS-00018 decides which axis it is, so it is tried on its own axis only."""
    choices = DESCRIBED[number]["choices"]
    for letter in letters_of(number):
        for name, value in choices.items():
            if number != "P-AXIS-00018" or name == TYPES[letter]:
                assert not outcome(number, letter, name)[0] & {25007, 25008}
                assert not outcome(number, letter, value)[0] & {25007, 25008}
        for wrong in ("NO_SUCH_NAME", 0x40000000, f"{next(iter(choices))} | NO_SUCH_NAME"):
            assert 25008 in outcome(number, letter, wrong)[0]
        assert 25007 in outcome(number, letter, 1.5)[0]


@pytest.mark.parametrize("number", [number for number, row in DESCRIBED.items() if "length" in row])
def test_names(number: str) -> None:
    row = DESCRIBED[number]
    for first in row["first"]:
        assert not outcome(number, "C", first + "1" * (row["length"] - 1))[0] & {25007, 25008}
        assert 25008 in outcome(number, "C", first + "1" * row["length"])[0]
    for wrong in ("1S", "M1", "é"):
        assert 25008 in outcome(number, "C", wrong)[0]


@pytest.mark.parametrize("number", [number for number, row in DESCRIBED.items() if row["type"] == "BOOLEAN"])
def test_switches(number: str) -> None:
    for letter in letters_of(number):
        for value in (0, 1, True, False):
            assert not outcome(number, letter, value)[0] & {25007, 25008}
        for value in (2, -1, "on", 0.5):
            assert outcome(number, letter, value)[0] == {25007}


@pytest.mark.parametrize("number", [number for number, row in DESCRIBED.items() if row["type"] in BITS])
def test_beyond_the_data_type(number: str) -> None:
    """Too large for the type, a text, a fraction: named with the line, whatever the range."""
    low, high = BITS[DESCRIBED[number]["type"]]
    for letter in letters_of(number):
        for value in (low - 1, high + 1):
            assert outcome(number, letter, value)[0] & {25008, 25009, DESCRIBED[number].get("refusal")}, (letter, value)
        for value in (1.5, "1,5", None):
            assert outcome(number, letter, value)[0] & {25007, 25008}, (letter, value)


@pytest.mark.parametrize("number", [number for number, row in DESCRIBED.items() if "ours" in row])
def test_what_differs_has_a_reason(number: str) -> None:
    row = DESCRIBED[number]["ours"]
    assert row["why"]
    assert {*row} - {"why"}
