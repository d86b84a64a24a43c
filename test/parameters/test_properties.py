"""Random machine files: a value inside its range comes back unchanged; any text loads or raises ParameterError."""

import re
from pathlib import Path
from typing import Any

import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from long_support import examples

from cnc_ptp.parameters import Declaration, MachineParameters, ParameterError, catalogue, load_machine, ros_descriptors

MILL = (Path(__file__).parents[2] / "config" / "mill.yaml").read_text(encoding="utf-8")
SETTINGS = settings(
    max_examples=examples(150), deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
UNITS = {"machine": "machine", "channel": "ch", "axis": "x", "spindle": "s"}
OF_THE_MANUALS = {70350, 70351, 110579, 110591, 110592}
"""Errors that keep the number that a manual gives them."""
TYPES = {"T": "ACHSTYP_TRANSLATOR", "R": "ACHSTYP_ROTATOR", "S": "ACHSTYP_SPINDEL"}
DECLARATIONS = [
    declaration
    for declaration in catalogue().by_id.values()
    if declaration.id not in ("P-AXIS-00018", "P-MACH-00004", "P-MACH-00005", "P-MACH-00006")
]


def machine_with(declaration: Declaration, kind: str, value: Any) -> str:
    """A machine file whose node of the kind has one value besides its axis type."""
    node = UNITS[kind]
    name = declaration.ros_name((0,) * declaration.index_count)
    sections: dict[str, dict[str, Any]] = {node: {} for node in UNITS.values()}
    sections["machine"] = {"channels": ["ch"], "axes": ["x"], "spindles": ["s"]}
    if kind == "axis":
        sections["x"]["kenngr.achs_typ"] = TYPES[declaration.axes[0]]
    sections[node][name] = value
    return yaml.safe_dump({f"/{node}": {"ros__parameters": values} for node, values in sections.items()})


def kind_of(declaration: Declaration) -> str:
    kinds = ["spindle" if declaration.axes.startswith("S") else "axis"] if declaration.axes else ["machine", "channel"]
    return next(kind for kind in kinds if declaration.belongs_to(kind))


def values_of(declaration: Declaration) -> st.SearchStrategy[Any]:
    if declaration.choices:
        return st.sampled_from(list(declaration.choices))
    if declaration.type == "bool":
        return st.booleans()
    if declaration.type == "strings":
        return st.lists(st.sampled_from(["S-0-0036", "S-0-0051", "60B2", "nothing"]))
    if declaration.type in ("int", "float"):
        low, high = (
            [limit.value + (0 if limit.inclusive else step) for limit in limits if not isinstance(limit.value, str)]
            for limits, step in ((declaration.lower, 1), (declaration.upper, -1))
        )
        minimum, maximum = max(low, default=None), min(high, default=None)
        if declaration.type == "int":
            return st.integers(minimum, maximum)
        return st.floats(minimum, maximum, allow_nan=False, allow_infinity=False)
    return st.from_regex(declaration.form or "[A-Z]{1,16}", fullmatch=True).filter(lambda text: len(text) <= 16)


@SETTINGS
@given(st.data())
def test_values_inside_the_range_come_back(data: st.DataObject) -> None:
    declaration = data.draw(st.sampled_from(DECLARATIONS))
    value = data.draw(values_of(declaration))
    kind = kind_of(declaration)
    try:
        machine = load_machine(machine_with(declaration, kind, value), "m.yaml")
    except ParameterError as error:
        crossed = {25009, 25010, 25011, 25012, 25013, 25014, 25015, 25016, 25017, 25019, 25020}
        assert {problem.error_id for problem in error.problems} <= crossed | OF_THE_MANUALS
        return
    parameters = machine.raw(UNITS[kind])
    wanted = tuple(value) if isinstance(value, list) else value
    assert parameters.value(declaration.id, *(0,) * declaration.index_count) == wanted


def test_every_default_round_trips() -> None:
    """A file that gives the default of a parameter is the file that does not give it."""
    for declaration in DECLARATIONS:
        if declaration.index_count and declaration.list_name == "channel" and declaration.id != "P-CHAN-00041":
            continue  # giving it makes an element of the list
        kind = kind_of(declaration)
        default = list(declaration.default) if isinstance(declaration.default, tuple) else declaration.default
        if declaration.id == "P-AXIS-00016":
            assert (kind, default) == ("axis", 1)
        machine = load_machine(machine_with(declaration, kind, default), "m.yaml")
        entry = machine.raw(UNITS[kind]).find(declaration.ros_name((0,) * declaration.index_count))
        assert entry.value == declaration.default


def load_or_refuse(text: str) -> MachineParameters | None:
    try:
        machine = load_machine(text, "m.yaml")
    except ParameterError as error:
        numbers = [problem.error_id for problem in error.problems]
        assert all(25000 < number < 25021 or number in OF_THE_MANUALS for number in numbers)
        assert all(re.match(r"P-ERR-\d+ m\.yaml:\d+:\d+: ", line) for line in str(error).splitlines())
        return None
    for node in machine.sets:
        ros_descriptors(machine.raw(node))
    return machine


@SETTINGS
@given(st.text())
def test_any_text(text: str) -> None:
    load_or_refuse(text)
    load_or_refuse("/machine: " + text)


@SETTINGS
@given(st.text(alphabet="{}[]:,-?&*!|>'\"%@`#~ \n\tax0", max_size=40))
def test_any_yaml_punctuation(text: str) -> None:
    load_or_refuse("/machine: {ros__parameters: {axes: [x]}}\n/x: " + text)


SCALARS = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.sampled_from(["MOS", "S", "0x4"])
)
NAMES = st.sampled_from(sorted({part for entry in catalogue().by_id.values() for part in entry.name.split(".")}))
KEYS = NAMES | st.integers(-1, 40) | st.text(max_size=4)
TREES = st.recursive(SCALARS | st.lists(SCALARS, max_size=3), lambda inner: st.dictionaries(KEYS, inner, max_size=4))
NODES = st.sampled_from(["/machine", "/x", "x", "/y", "/s", "/ch", "/**", ""])
LISTS = st.lists(st.sampled_from(["x", "y", "s", "ch", "X", "plc", "/x", ""]), max_size=3)


@SETTINGS
@given(st.dictionaries(NODES, st.fixed_dictionaries({"ros__parameters": TREES})), LISTS, LISTS, LISTS)
def test_any_tree(tree: dict[str, Any], channels: list[str], axes: list[str], spindles: list[str]) -> None:
    tree.setdefault("/machine", {"ros__parameters": {"channels": channels, "axes": axes, "spindles": spindles}})
    load_or_refuse(yaml.safe_dump(tree, allow_unicode=True))


@SETTINGS
@given(st.integers(0, len(MILL)), st.integers(0, 12), st.text(alphabet="abc019.[]{}:|-\n ", max_size=5))
def test_any_slip_in_a_real_machine(position: int, length: int, slip: str) -> None:
    load_or_refuse(MILL[:position] + slip + MILL[position + length :])
