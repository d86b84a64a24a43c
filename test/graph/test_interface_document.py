"""docs/interfaces.md lists the services of each unit with the types that the nodes have."""

import re
from pathlib import Path

import pytest

from cnc_ptp.nodes.topics import COUPLING_SERVICES, SERIES_SERVICES, SERVICES
from cnc_ptp.protocol.commands import COMMANDS, INTERNAL

DOCUMENT = (Path(__file__).parents[2] / "docs" / "interfaces.md").read_text(encoding="utf-8")
SPINDLES = (Path(__file__).parents[2] / "docs" / "spindles.md").read_text(encoding="utf-8")


def listed(row: str) -> dict[str, str]:
    """Service -> type of a table row: `stop` `halt` (Execute)."""
    (cells,) = re.findall(rf"^\| {row} \| (`.*) \|$", DOCUMENT, re.MULTILINE)
    return {
        name: kind for names, kind in re.findall(r"((?:`\w+` )+)\((\w+)\)", cells) for name in re.findall(r"\w+", names)
    }


@pytest.mark.parametrize("kind", SERVICES)
def test_services_of_a_unit(kind):
    assert listed(kind) == {name: service.__name__ for name, service in SERVICES[kind].items()}


def test_services_that_the_plc_answers():
    assert listed("axis, answered by the plc") == {
        name: service.__name__ for name, service in (COUPLING_SERVICES | SERIES_SERVICES).items()
    }


def test_commands_without_a_service():
    without = {
        name
        for kind, commands in COMMANDS.items()
        for name in set(commands) - INTERNAL - set(SERVICES[kind])
        if kind != "axis" or name not in COUPLING_SERVICES | SERIES_SERVICES
    }
    assert without == {"jog", "overlay", "serve"}
    (text,) = re.findall(r"^Commands without a service: (.*?)\n\n", DOCUMENT, re.MULTILINE | re.DOTALL)
    assert {name for name in re.findall(r"`(\w+)`", text) if name in without} == without


def test_services_of_the_spindle_document():
    (cells,) = re.findall(r"^\| services `/<spindle>/…` \| (.*) \|$", SPINDLES, re.MULTILINE)
    assert sorted(re.findall(r"`(\w+)`", cells)) == sorted(SERVICES["spindle"])
