"""Answers to a change of a parameter while the node runs."""

import pytest

from cnc_ptp.parameters import load_machine
from cnc_ptp.parameters.check.runtime_change import change_refusal
from cnc_ptp.parameters.read.source import Value

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


FIXED = "cannot be written at run time, it is taken over at start-up only"


@pytest.mark.parametrize(
    ("node", "name", "value", "text"),
    [
        ("x", "kopf.achs_nr", 4, f"23095 axis x: P-AXIS-00016 (kopf.achs_nr) {FIXED}, as the manual has it"),
        ("x", "vorsteuer.vorsteuerung", "VEL", f"23095 axis x: P-AXIS-00223 (vorsteuer.vorsteuerung) {FIXED}"),
        ("x", "max_points", 40, "23095 axis x: axis x has no parameter 'max_points'; did you mean frict_comp.max_points (P-COMP-00062)?"),
        ("x", "getriebe.0.kv", 0, "23096 axis x: P-AXIS-00099 getriebe[0].kv: value 0 is not above 0 (0.01/s)"),
        ("x", "getriebe.0.kv", "fast", "23096 axis x: P-AXIS-00099 getriebe[0].kv: value 'fast' is text, an integer is needed"),
        ("s", "getriebe.0.kv", 4000, f"23095 spindle s: P-AXIS-00099 (getriebe[i].kv) {FIXED}"),
        ("ch", "max_vb_override", 1000, f"23095 channel ch: P-CHAN-00056 (max_vb_override) {FIXED}"),
        ("ch", "frict_comp.max_points", 40, "23095 channel ch: channel ch has no parameter 'frict_comp.max_points', P-COMP-00062 belongs to axis and spindle nodes"),
        ("machine", "axes", ("x", "z"), f"23095 machine machine: P-MACH-00005 (axes) {FIXED}"),
        ("machine", "use_sim_time", True, "23095 machine machine: machine has no parameter 'use_sim_time'"),
    ],
)  # fmt: skip
def test_every_refusal_has_number_and_reason(node: str, name: str, value: Value, text: str) -> None:
    error = change_refusal(load_machine(TEXT, "m.yaml").raw(node), name, value)
    assert str(error) == f"P-ERR-{text}; nothing was changed"


@pytest.mark.parametrize("value", [4000, 4000.0])
def test_what_a_unit_may_be_asked(value: Value) -> None:
    assert change_refusal(load_machine(TEXT, "m.yaml").raw("x"), "getriebe.0.kv", value) is None
