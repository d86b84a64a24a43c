"""Answers to a change of a parameter while the node runs."""

import pytest

from cnc_ptp.parameters import load_machine
from cnc_ptp.parameters.check.runtime_change import change_refusal

TEXT = """\
/machine: {ros__parameters: {channels: [ch], axes: [x], spindles: [s]}}
/x: {ros__parameters: {frict_comp.max_points: 12}}
"""


@pytest.mark.parametrize(("node", "kind", "value"), [("x", "axis", 12), ("s", "spindle", 20)])
def test_the_table_size_has_an_error_of_its_own(node: str, kind: str, value: int) -> None:
    error = change_refusal(load_machine(TEXT, "m.yaml").raw(node), "frict_comp.max_points", 40)
    assert str(error) == (
        f"P-ERR-110641 {kind} {node}: frict_comp.max_points = {value} (P-COMP-00062) cannot be changed to 40 after "
        "start-up; nothing was changed, set it in the machine file and start again"
    )


@pytest.mark.parametrize(
    ("node", "name"),
    [("x", "frict_comp.mode"), ("x", "max_points"), ("ch", "frict_comp.max_points"), ("machine", "watchdog_ms")],
)
def test_other_parameters_have_none(node: str, name: str) -> None:
    assert change_refusal(load_machine(TEXT, "m.yaml").raw(node), name, 40) is None
