"""Descriptors with which nodes declare their parameters in ROS."""

import pytest

from cnc_ptp.parameters import RosDescriptor, load_machine, ros_descriptors
from cnc_ptp.parameters.declare.declarations import NODE_KINDS, catalogue

TEXT = """\
/machine: {ros__parameters: {channels: [ch], axes: [x], spindles: [s]}}
/x: {ros__parameters: {getriebe: {"0": {kv: 5000}, "2": {kv: 300}}, kenngr.swe_neg: -500}}
/ch: {ros__parameters: {m_synch.8: 2}}
"""


@pytest.fixture(scope="module")
def descriptors() -> dict[str, dict[str, RosDescriptor]]:
    machine = load_machine(TEXT, "m.yaml")
    return {
        node: {entry.ros_name: entry for entry in ros_descriptors(machine.raw(node))}
        for node in ("x", "s", "ch", "machine")
    }


def test_one_descriptor_in_full(descriptors: dict[str, dict[str, RosDescriptor]]) -> None:
    descriptor = descriptors["x"]["getriebe.0.kv"]
    assert descriptor == RosDescriptor(
        ros_name="getriebe.0.kv",
        value=5000,
        type="int",
        minimum=1,
        maximum=4294967295,
        unit="0.01/s",
        text="Gain of the proportional position controller.",
        number="P-AXIS-00099",
        read_only=False,
        constraints="0 < … ≤ 4294967295",
    )
    assert descriptor.description == "P-AXIS-00099 [0.01/s] Gain of the proportional position controller."
    assert descriptors["x"]["kopf.achs_nr"].description.startswith("P-AXIS-00016 Logical axis number")


def test_array_elements_in_use(descriptors: dict[str, dict[str, RosDescriptor]]) -> None:
    assert [name for name in descriptors["x"] if name.endswith(".kv")] == ["getriebe.0.kv", "getriebe.2.kv"]
    assert [name for name in descriptors["s"] if name.endswith(".kv")] == ["getriebe.0.kv"]
    assert descriptors["ch"]["m_synch.8"].value == "MVS_SVS"
    assert not [name for name in descriptors["ch"] if name.startswith(("spindel.", "gruppe.", "wz."))]


def test_only_what_the_axis_type_has(descriptors: dict[str, dict[str, RosDescriptor]]) -> None:
    assert "kenngr.vb_prozent" in descriptors["s"]
    assert "kenngr.vb_prozent" not in descriptors["x"]
    assert "kenngr.swe_neg" not in descriptors["s"]
    assert descriptors["s"]["kenngr.achs_typ"].value == "ACHSTYP_SPINDEL"
    assert descriptors["s"]["kopf.achs_nr"].value == 2


def test_limits_are_inclusive_and_resolved(descriptors: dict[str, dict[str, RosDescriptor]]) -> None:
    limits = {name: (entry.minimum, entry.maximum) for name, entry in descriptors["x"].items()}
    assert limits["kenngr.swe_neg"] == (-(2**31), 99_999_999)
    assert limits["kenngr.swe_pos"] == (-499, 2**31 - 1)
    assert limits["getriebe.0.vb_eilgang"] == (1, 200_000)
    assert limits["kenngr.antr_typ"] == (1, 32)
    assert limits["kenngr.achs_typ"] == (None, None)
    assert limits["simulation.encoder"] == (None, None)
    assert limits["ptp.reference_velocity"] == (0, None)
    assert descriptors["s"]["getriebe.0.beschl_kennlinie.n_grenz"].minimum == 0


def test_every_value_lies_in_its_limits(descriptors: dict[str, dict[str, RosDescriptor]]) -> None:
    for node in descriptors.values():
        for entry in node.values():
            assert entry.minimum is None or entry.minimum <= entry.value
            assert entry.maximum is None or entry.value <= entry.maximum


def test_machine_node(descriptors: dict[str, dict[str, RosDescriptor]]) -> None:
    machine = descriptors["machine"]
    assert machine["axes"].value == ("x",)
    assert machine["axes"].type == "strings"
    assert set(machine) == {entry.key for entry in catalogue().of_node("machine")}
    assert len(NODE_KINDS) == len(descriptors)
