"""ids.py: made from the declarations, and used instead of literal ids."""

import ast
from pathlib import Path

import pytest

from cnc_ptp.parameters import catalogue
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.make_ids import FOLDER, constant, declared, ids_module

PACKAGE = FOLDER.parent


def test_ids_are_up_to_date() -> None:
    """Otherwise: make ids"""
    assert (FOLDER / "ids.py").read_text(encoding="utf-8") == ids_module(declared())


def test_every_parameter_has_a_constant_of_its_own() -> None:
    constants = {name: value for name, value in vars(ids).items() if name.isupper()}
    assert sorted(constants.values()) == sorted(catalogue().by_id)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("axes", "AXES"),
        ("m_synch[i]", "M_SYNCH"),
        ("getriebe[i].kv", "GETRIEBE_KV"),
        ("getriebe[i].dynamik.vb_max", "DYNAMIK_VB_MAX"),
        ("synchro_data.koppel_gruppe[i].paar[j].mode", "PAAR_MODE"),
    ],
)
def test_names_of_constants(name: str, expected: str) -> None:
    assert constant(name) == expected


@pytest.mark.parametrize("file", sorted(PACKAGE.rglob("*.py")), ids=lambda file: file.stem)
def test_no_id_is_written_out(file: Path) -> None:
    """In texts for people ids stay as they are; as data they are constants."""
    if file.name == "ids.py":
        return
    nodes = ast.walk(ast.parse(file.read_text(encoding="utf-8")))
    strings = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    assert not strings & set(catalogue().by_id)
