"""The JSON schemas of machine files and scenarios: every file that is shipped fits, and what the program refuses does not."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from jsonschema import Draft7Validator

from cnc_ptp.commands.machine_schema import machine_schema, schema_json, up_to
from cnc_ptp.commands.scenario_schema import scenario_schema
from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare.declarations import Declaration, catalogue
from cnc_ptp.parameters.read.source import scalar
from cnc_ptp.parameters.read.values import BadValue, checked_value
from cnc_ptp.plc.scenario import parse_scenario
from cnc_ptp.protocol.commands import COMMANDS, INTERNAL

ROOT = Path(__file__).parents[2]
MACHINE = Draft7Validator(machine_schema())
SCENARIO = Draft7Validator(scenario_schema())
FILES = [
    path
    for folder in ("config", "examples", "test")
    for path in sorted((ROOT / folder).rglob("*.yaml"))
    if "tools" not in path.parts
]


class Reader(yaml.SafeLoader):
    """YAML 1.2 as editors read it: numbers like 1e-6, words like on and y; keys are texts."""


Reader.yaml_implicit_resolvers = {}


def construct(node: yaml.Node) -> Any:
    if isinstance(node, yaml.MappingNode):
        return {key.value: construct(value) for key, value in node.value}
    if isinstance(node, yaml.SequenceNode):
        return [construct(value) for value in node.value]
    value = scalar(node)
    return node.value if isinstance(value, bool) and node.value.lower() not in ("true", "false") else value


def content(text: str) -> Any:
    """What an editor makes of a YAML text."""
    node = yaml.compose(text, Reader)
    return None if node is None else construct(node)


def is_machine(path: Path) -> bool:
    return re.search(r"^/?machine:", path.read_text(encoding="utf-8"), re.MULTILINE) is not None


def is_scenario(path: Path) -> bool:
    text = path.read_text(encoding="utf-8")
    return re.search(r"^- .*\bdo:", text, re.MULTILINE) is not None


MACHINES = [path for path in FILES if is_machine(path)]
SCENARIOS = [path for path in FILES if is_scenario(path)]


def faults(validator: Draft7Validator, text: str) -> list[str]:
    return [error.message for error in validator.iter_errors(content(text))]


@pytest.mark.parametrize(
    ("name", "schema"), [("machine.schema.json", machine_schema()), ("scenario.schema.json", scenario_schema())]
)
def test_the_shipped_schemas_are_up_to_date(name: str, schema: dict[str, Any]) -> None:
    """Otherwise: python -m cnc_ptp.commands.machine_schema > tools/machine.schema.json, and scenario_schema."""
    Draft7Validator.check_schema(schema)
    assert (ROOT / "tools" / name).read_text(encoding="utf-8") == schema_json(schema)
    assert json.loads(schema_json(schema)) == schema


def test_there_are_enough_files() -> None:
    assert len(MACHINES) >= 10 and len(SCENARIOS) >= 20


@pytest.mark.parametrize("path", MACHINES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_machines_fit(path: Path) -> None:
    assert faults(MACHINE, path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_scenarios_fit(path: Path) -> None:
    assert faults(SCENARIO, path.read_text(encoding="utf-8")) == []


HEAD = "/machine: {ros__parameters: {axes: [x], channels: [c]}}\n"


@pytest.mark.parametrize(
    "line",
    [
        '/x: {ros__parameters: {getriebe: {"0": {kv: 1000}}}}',
        "/x: {ros__parameters: {getriebe.0.kv: 1000}}",
        "/x: {ros__parameters: {'getriebe[0].kv': 1000}}",
        "/x: {ros__parameters: {'getriebe[0]': {kv: 1000, dynamik.vb_max: 5000}}}",
        "x: {ros__parameters: {getriebe: {5: {dynamik: {vb_max: 0x10}}}}}",
        "/x:",
        "/x: {ros__parameters: }",
        "/x: {ros__parameters: {kenngr.achs_mode: ACHSMODE_LINEAR | 0x40}}",
        "/x: {ros__parameters: {vorsteuer: {vorsteuerung: VEL|ACC}}}",
        "/x: {ros__parameters: {vorsteuer: {vorsteuerung: 3}}}",
        "/x: {ros__parameters: {getriebe.0.load: 1e-6, getriebe.0.wegaufz: 0, lr_param.frict_comp: true}}",
        "/c: {ros__parameters: {gruppe: {'0': {achse: {'0': {bezeichnung: X}}}}, 'synchro_data.koppel_gruppe[0].paar[15].mode': 1}}",
        "/c: {ros__parameters: {cax_face_id: 0, main_spindle_name: ''}}",
    ],
)
def test_what_the_loader_takes_fits(line: str) -> None:
    assert faults(MACHINE, HEAD + line) == []


@pytest.mark.parametrize(
    "line",
    [
        '/x: {ros__parameters: {getriebe: {"0": {kvv: 1000}}}}',
        '/x: {ros__parameters: {getriebe: {"0": {kv: 0}}}}',
        '/x: {ros__parameters: {getriebe: {"6": {kv: 1000}}}}',
        "/x: {ros__parameters: {getriebe.6.kv: 1000}}",
        "/x: {ros__parameters: {'getriebe[06].kv': 1000}}",
        "/x: {ros__parameters: {getriebe.0.kv: fast}}",
        "/x: {ros__parameters: {getriebe.0.kv: 1.5}}",
        "/x: {ros__parameters: {getriebe.0.kv: 4294967296}}",
        "/x: {ros__parameters: {kenngr.achs_typ: ACHSTYP_X}}",
        "/x: {ros__parameters: {kenngr.antr_typ: 9}}",
        "/x: {ros__parameters: {vorsteuer.vorsteuerung: VEL | AC}}",
        "/x: {ros__parameters: {lr_param.frict_comp: 2}}",
        "/x: {ros_parameters: {getriebe.0.kv: 1000}}",
        "/x: {ros__parameters: [1]}",
        "/x: 5",
        "/X: {}",
        "/c: {ros__parameters: {main_spindle_name: M}}",
        "/c: {ros__parameters: {main_spindle_name: S0123456789ABCDEF}}",
        "/c: {ros__parameters: {wz.1000.vb_max: 5.0}}",
        "/x: {ros__parameters: {cycle_time_us: 1000}}",
    ],
)
def test_what_the_loader_refuses_does_not_fit(line: str) -> None:
    assert faults(MACHINE, HEAD + line)


def values_of(entry: Declaration) -> list[Any]:
    """Values at the limits, beside them, of other types."""
    if entry.type in ("int", "float"):
        numbers = [limit.value for limit in (*entry.lower, *entry.upper) if not isinstance(limit.value, str)]
        around = [number + step for number in (*numbers, *entry.choices) for step in (-1, 0, 1)]
        return [*around, 0, 1, "text", True, None, *entry.names, " | ".join([*entry.names][:2]), "0x5"]
    if entry.type == "bool":
        return [True, False, 0, 1, 2, -1, "on", None]
    if entry.type == "strings":
        return [("a", "b"), (), (1,), "a", 5, None]
    names = [*entry.choices]
    texts = ["", "S1", "s1", "X", "X Y", "A" * 16, "A" * 17, "S_0_0036", "S-0-0036", 5, 0x10000, True, None]
    return [*texts, *names, *entry.choices.values(), " | ".join(names[:2]), "|".join(names[1:3])]


def json_value(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


@pytest.mark.parametrize("number", catalogue().by_id)
def test_a_value_fits_exactly_where_the_loader_takes_it(number: str) -> None:
    """A number of flags may have bits without a constant: that is the only thing that the schema does not see."""
    entry = catalogue().by_id[number]
    validator = Draft7Validator(machine_schema_definition(number))
    for value in values_of(entry):
        try:
            checked_value(entry, value, "")
            taken = True
        except BadValue:
            taken = False
        bits = entry.flags and type(value) is int
        if not bits:
            assert validator.is_valid(json_value(value)) == taken, value


def machine_schema_definition(number: str) -> dict[str, Any]:
    return MACHINE.schema["definitions"][number]


@pytest.mark.parametrize("number", catalogue().by_id)
def test_an_editor_shows_text_default_and_range(number: str) -> None:
    entry, shown = catalogue().by_id[number], machine_schema_definition(number)
    assert shown["description"].startswith(f"{number} {entry.name}\n{entry.text}")
    assert shown["default"] == json_value(entry.default)


@pytest.mark.parametrize("largest", [0, 3, 5, 9, 10, 15, 31, 96, 149, 999])
def test_indexes_as_an_expression(largest: int) -> None:
    found = [number for number in range(1200) if re.fullmatch(up_to(largest), str(number))]
    assert found == list(range(largest + 1))
    assert not re.fullmatch(up_to(largest), "00")


KINDS = {"x": "axis", "y": "axis", "s": "spindle", "c": "channel", "plc": "plc"}


@pytest.mark.parametrize(
    "entry",
    [
        "- {at: 0, to: x, do: move_absolute, target: 5}",
        "- {at: 0.5, to: x, do: move_absolute, target: 5, velocity: 1e3, buffer_mode: buffered}",
        "- {at: 0, to: x, do: power, enabled: on}",
        "- {at: 0, to: x, do: power, on: on}",
        "- {at: 0, to: x, do: couple, master: y, factor: 2}",
        "- {at: 0, to: s, do: start, direction: cw, speed_rpm: 100}",
        "- {at: 0, to: c, do: start}",
        "- {at: 0, to: c, do: mdi, text: G0 X5}",
        "- {at: 0, to: plc, do: acknowledge, id: 3}",
        "",
    ],
)
def test_scenarios_that_run_fit(entry: str) -> None:
    parse_scenario(entry, "s.yaml", KINDS)
    assert faults(SCENARIO, entry) == []


@pytest.mark.parametrize(
    "entry",
    [
        "- {at: 0, to: x, do: move_absolut, target: 5}",
        "- {at: 0, to: x, do: move_absolute}",
        "- {at: 0, to: x, do: move_absolute, target: far}",
        "- {at: 0, to: x, do: move_absolute, target: 5, speed: 4}",
        "- {at: 0, to: x, do: move_absolute, target: 5, buffer_mode: soon}",
        "- {at: -1, to: x, do: reset}",
        "- {at: soon, to: x, do: reset}",
        "- {to: x, do: reset}",
        "- {at: 0, do: reset}",
        "- {at: 0, to: x}",
        "- {at: 0, to: x, do: power, enabled: 1}",
        "- {at: 0, to: x, do: external_setpoints}",
        "- {at: 0, to: s, do: start, direction: left, speed_rpm: 100}",
        "{at: 0, to: x, do: reset}",
    ],
)
def test_scenarios_that_are_refused_do_not_fit(entry: str) -> None:
    with pytest.raises(CncError):
        parse_scenario(entry, "s.yaml", KINDS, read=None)
    assert faults(SCENARIO, entry)


def test_every_command_has_its_entry() -> None:
    names = {name for kind in COMMANDS.values() for name in kind} - INTERNAL
    entry = SCENARIO.schema["items"]
    assert set(entry["properties"]["do"]["enum"]) == names
    assert len(entry["properties"]["do"]["enumDescriptions"]) == len(names)
    assert [rule["if"]["properties"]["do"]["const"] for rule in entry["allOf"]] == entry["properties"]["do"]["enum"]
