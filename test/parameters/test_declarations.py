"""declarations.yaml itself: every entry is complete, every default is legal, every limit exists."""

import re

import pytest

from cnc_ptp.parameters import Declaration, Synchronisation, catalogue
from cnc_ptp.parameters.declare.declarations import AXIS_LETTERS, DATA_TYPES, LISTS, NODE_KINDS, split_indexes
from cnc_ptp.parameters.read.values import checked_value

IDS = sorted(catalogue().by_id)
PREFIXES = {
    "axis": "P-AXIS-",
    "channel": "P-CHAN-",
    "startup": "P-STUP-",
    "zero": "P-ZERO-",
    "clamp": "P-CLMP-",
    "compensation": "P-COMP-",
    "tool": "P-TOOL-",
    "simulation": "P-SIM-",
    "machine": "P-MACH-",
}
UNITS = {
    "0.1 µm or 0.0001°",
    *(
        "",
        "0.1 µm",
        "0.0001°",
        "µm/s",
        "0.001°/s",
        "mm/s²",
        "°/s²",
        "mm/s³",
        "°/s³",
        "mm/s",
        "°/s",
        "mm",
        "°",
        "µm",
        "0.001°",
        "µs",
        "ms",
    ),
    *(
        "0.01/s",
        "0.1 %",
        "increments",
        "increments/rev",
        "revolutions",
        "rpm",
        "cycles",
        "bit",
        "bytes",
        "Hz",
        "kg·m² (kg)",
        "Nm (N)",
        "1/s",
        "1/°",
        "s/°²",
    ),
    *("kg·m²", "N", "Nm", "drive current"),
}


@pytest.fixture(params=IDS)
def declaration(request: pytest.FixtureRequest) -> Declaration:
    return catalogue().by_id[request.param]


def test_identification(declaration: Declaration) -> None:
    assert re.fullmatch(PREFIXES[declaration.list_name] + "[0-9]{5}", declaration.id)
    assert declaration.list_name in LISTS
    assert declaration.data_type in DATA_TYPES
    assert set(declaration.unit) <= UNITS
    assert set(declaration.axes) <= set(AXIS_LETTERS)
    assert declaration.text.endswith((".", ".)"))
    assert declaration.source
    assert declaration.read_only


def test_default_lies_in_the_range_or_means_not_configured(declaration: Declaration) -> None:
    for letter in declaration.axes or "T":
        value = checked_value(declaration, declaration.default, declaration.unit_for(letter))
        assert value == declaration.default
        assert type(value) is type(declaration.default)


def test_default_keeps_limits_that_are_parameters(declaration: Declaration) -> None:
    for limit in declaration.lower:
        if isinstance(limit.value, str):
            other = catalogue().by_id[limit.value]
            assert declaration.default > other.default or (limit.inclusive and declaration.default == other.default)
    for limit in declaration.upper:
        if isinstance(limit.value, str):
            other = catalogue().by_id[limit.value]
            assert declaration.default < other.default or (limit.inclusive and declaration.default == other.default)


def test_limiting_parameters_have_the_same_unit_and_indexes(declaration: Declaration) -> None:
    for limit in (*declaration.lower, *declaration.upper):
        if isinstance(limit.value, str):
            other = catalogue().by_id[limit.value]
            assert other.unit[1] == declaration.unit[1]
            assert other.index_count <= declaration.index_count
            assert any(other.belongs_to(kind) and declaration.belongs_to(kind) for kind in NODE_KINDS)


def test_names_and_indexes(declaration: Declaration) -> None:
    indexes = tuple(range(declaration.index_count))
    assert len(catalogue().sizes(declaration)) == declaration.index_count
    ros_name = declaration.ros_name(indexes)
    assert "*" not in ros_name and "[" not in ros_name
    assert split_indexes(ros_name) == (declaration.key, indexes)
    assert declaration.list_style_name(indexes).replace("[", ".").replace("]", "") == ros_name


def test_no_node_has_two_parameters_of_one_name() -> None:
    for kind in NODE_KINDS:
        keys = [entry.key for entry in catalogue().by_id.values() if entry.belongs_to(kind)]
        assert len(keys) == len(set(keys))
        assert len(keys) == len(list(catalogue().of_node(kind)))


def test_every_parameter_belongs_to_some_node() -> None:
    assert {entry.id for kind in NODE_KINDS for entry in catalogue().of_node(kind)} == set(IDS)


def test_synchronisation_constants_are_those_of_the_manual() -> None:
    """Values of TF5200_spindle page 27."""
    assert catalogue().by_id["P-CHAN-00045"].choices == {
        "NO_SYNCH": 0,
        "MOS": 1,
        "MVS_SVS": 2,
        "MVS_SNS": 4,
        "MNS_SNS": 8,
        "MNE_SNS": 32,
        "MVS_SLM": 16384,
        "MVS_SLP": 32768,
        "PLC_INFO": 131072,
    }
    assert {flag.name: flag.value for flag in Synchronisation} | {"NO_SYNCH": 0} == catalogue().by_id[
        "P-CHAN-00045"
    ].choices


@pytest.mark.parametrize(
    ("number", "name", "data_type", "default"),
    [
        ("P-AXIS-00001", "getriebe[i].slope_profil.a_beschl", "UNS32", 1000),
        ("P-AXIS-00092", "getriebe[i].incr_per_rev", "UNS32", 1024),
        ("P-AXIS-00099", "getriebe[i].kv", "UNS32", 1000),
        ("P-AXIS-00168", "getriebe[i].slep_max", "SGN32", 100000),
        ("P-AXIS-00177", "kenngr.swe_neg", "SGN32", -100000000),
        ("P-AXIS-00196", "getriebe[i].slope_profil.tr_beschl_zu", "UNS32", 50000),
        ("P-AXIS-00209", "getriebe[i].vb_eilgang", "UNS32", 166666),
        ("P-AXIS-00212", "getriebe[i].dynamik.vb_max", "UNS32", 200000),
        ("P-AXIS-00217", "kenngr.vb_prozent", "UNS16", 100),
        ("P-AXIS-00338", "vorsteuer.jerk_fact_denom", "UNS32", 100),
        ("P-AXIS-00391", "getriebe[i].load", "REAL64", 1e-6),
        ("P-CHAN-00035", "gruppe[i].achse[j].log_achs_nr", "UNS16", 0),
        ("P-CHAN-00041", "m_synch[i]", "STRING", "NOT_VALID"),
        ("P-CHAN-00055", "spindel[i].range_table[j].max_speed", "UNS16", 0),
        ("P-CHAN-00059", "mittelpkt_diff", "REAL64", 20000.0),
        ("P-COMP-00045", "frict_comp.scaling_factor", "SGN16", 1000),
        ("P-TOOL-00014", "wz[i].vb_max", "REAL64", 1.0),
    ],
)
def test_samples_against_the_manuals(number: str, name: str, data_type: str, default: object) -> None:
    declaration = catalogue().by_id[number]
    assert (declaration.name, declaration.data_type, declaration.default) == (name, data_type, default)


def test_aliases_are_spellings_of_parts_of_names():
    parts = {
        part.partition("[")[0] for declaration in catalogue().by_id.values() for part in declaration.name.split(".")
    }
    assert catalogue().aliases
    assert {part for part in catalogue().aliases.values() if part not in parts} == set()
    assert {alias for alias in catalogue().aliases if alias in parts} == set()
