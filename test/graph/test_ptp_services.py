"""The PTP functions as a PLC or a script sees them: services with what may be left out, the topic of setpoints."""

import math

import pytest
from client_support import beside_composed_run
from graph_support import PTP

from cnc_ptp import msg
from cnc_ptp.nodes.topics import COUPLING_SERVICES, SERIES_SERVICES, SERVICES
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.commands import COMMANDS, OF_CHANNELS

NAN = math.nan
QUICK = {"velocity": 2000.0, "acceleration": 5000.0, "deceleration": 5000.0, "jerk": 50_000.0}
FROM_THE_AXIS = dict.fromkeys(QUICK, NAN)
ONLY_RAMPS = dict.fromkeys(("acceleration", "deceleration", "jerk"), NAN)
COMPENSATING, EXTERNAL, HAS_JOB, STOPPED, IN_TARGET = 1 << 13, 1 << 14, 1 << 8, 1 << 7, 1 << 4


@pytest.mark.parametrize("kind", SERVICES)
def test_fields_of_services_are_the_arguments_of_commands(kind):
    for command, service in SERVICES[kind].items():
        fields = {name for name in service.Request.get_fields_and_field_types() if not name.startswith("has_")}
        known = COMMANDS[kind][command].keys() - OF_CHANNELS - {"files"}
        assert fields - {"file_names", "file_texts"} == known, command
        assert ("file_names" in fields) == ("files" in COMMANDS[kind][command]), command


def test_fields_of_coupling_services():
    filled_in = {"above", "master_stands", "master_start", "master_lost", "table"}
    for command, service in COUPLING_SERVICES.items():
        fields = service.Request.get_fields_and_field_types()
        points = {"master_points", "slave_points"} if "table" in COMMANDS["axis"][command] else set()
        assert set(fields) - points == COMMANDS["axis"][command].keys() - filled_in, command
        assert points <= set(fields), command


def test_every_answer_has_the_values_of_a_refusal():
    services = [s for group in (*SERVICES.values(), COUPLING_SERVICES, SERIES_SERVICES) for s in group.values()]
    assert all("values_json" in service.Response.get_fields_and_field_types() for service in services)


@pytest.fixture(scope="module")
def client():
    with beside_composed_run(PTP) as node:
        yield node


def stands_at(client, axis, position):
    def there(block):
        return block.set_velocity[-1] == 0.0 and abs(block.set_position[-1] - position) <= 1e-6

    return client.wait_last(axis, there, f"standstill at {position}")


def test_starts(client):
    client.done("x", "move_absolute", target=100.0, **FROM_THE_AXIS)
    stands_at(client, "x", 100.0)
    client.done("x", "move_relative", distance=-100.0, **dict.fromkeys(QUICK, 0.0))
    block = stands_at(client, "x", 0.0)
    assert block.status_bits[-1] & IN_TARGET
    client.done("c", "move_modulo", position=-450.0, **FROM_THE_AXIS)
    stands_at(client, "c", -630.0)
    client.refused(
        "x",
        "move_modulo",
        23024,
        "axis x: move_modulo refused: the axis does not count modulo (P-AXIS-00015); nothing was changed",
        position=90.0,
        **FROM_THE_AXIS,
    )


def test_motions_of_plcopen(client):
    """Buffered, aborting, at a velocity, superimposed, other coordinates: each by its service, with the number of its job."""
    first = client.call("x", "move_absolute", target=4000.0, **QUICK)
    second = client.call("x", "move_relative", distance=100.0, buffer_mode="buffered", **FROM_THE_AXIS)
    assert second.accepted and second.job == first.job + 1
    assert client.call("x", "move_velocity", velocity=5.0, buffer_mode="buffered", **ONLY_RAMPS).error_id == 23063
    client.done("x", "move_superimposed", distance=50.0, velocity_difference=0.0, **ONLY_RAMPS)
    stands_at(client, "x", 4150.0)
    client.done("x", "move_velocity", velocity=-2000.0, buffer_mode="", **ONLY_RAMPS)
    client.wait_last("x", lambda block: block.set_velocity[-1] == -2000.0, "the velocity")
    client.done("x", "move_absolute", target=0.0, buffer_mode="aborting", **QUICK)
    stands_at(client, "x", 0.0)
    client.done("x", "set_position", position=7.0, relative=True)
    client.done("x", "move_additive", distance=-7.0, **FROM_THE_AXIS)
    stands_at(client, "x", 0.0)
    client.done("x", "set_position", position=-7.0, relative=True)
    client.done("x", "move_absolute", target=0.0, **FROM_THE_AXIS)
    stands_at(client, "x", 0.0)


def test_new_target_and_new_velocity(client):
    client.done("x", "move_absolute", target=10_000.0, **QUICK)
    client.done("x", "new_velocity_and_target", velocity=1000.0, target=1500.0, activation_position=700.0)
    client.wait_last("x", lambda block: block.set_velocity[-1] == 1000.0, "the new velocity")
    client.done("x", "new_target", target=0.0)
    stands_at(client, "x", 0.0)
    text = "axis x: new_target refused: no positioning is active (the axis is in Standstill); start one"
    client.refused("x", "new_target", 23014, f"{text}; nothing was changed", target=5.0)


def test_stops(client):
    client.done("x", "move_absolute", target=50_000.0, **QUICK)
    client.wait_last("x", lambda block: block.set_velocity[-1] == 2000.0, "full velocity")
    weak = client.call("x", "emergency_stop", deceleration=4000.0, jerk=NAN)
    assert weak.accepted and weak.message == (
        "P-WARN-23016 axis x: emergency_stop: deceleration 4000.0 mm/s² is less than 5000.0 mm/s² of the start, which is "
        "used; jerk is not given; 50000.0 mm/s³ of the start is used"
    )
    client.wait_last("x", lambda block: block.state[-1] == 1, "Standstill")
    client.done("x", "move_absolute", target=-50_000.0, **QUICK)
    client.wait_last("x", lambda block: block.set_velocity[-1] == -2000.0, "full velocity")
    client.done("x", "emergency_stop", deceleration=20_000.0, jerk=500_000.0)
    block = client.wait_last("x", lambda block: block.state[-1] == 1, "Standstill")
    assert block.status_bits[-1] & STOPPED
    client.done("x", "move_absolute", target=-50_000.0, **QUICK)
    client.done("x", "halt")
    client.wait_last("x", lambda block: block.state[-1] == 1, "Standstill")
    client.done("x", "move_absolute", target=0.0, **QUICK)
    stands_at(client, "x", 0.0)


def test_override_type(client):
    client.done("x", "set_override_type", type=2)
    assert client.call("x", "set_override_type", type=5).error_id == 23035
    client.done("x", "set_override_type", type=1)


def test_compensation(client):
    client.done("x", "move_absolute", target=6000.0, **QUICK)
    client.wait_last("x", lambda block: block.set_velocity[-1] == 2000.0, "full velocity")
    values = {"length": 2000.0, "difference": 100.0, "process_velocity": 2000.0, "velocity_increase": 300.0}
    client.done("x", "compensation_start", acceleration=0.0, deceleration=NAN, **values)
    block = client.wait_last("x", lambda block: block.status_bits[-1] & COMPENSATING, "compensation")
    assert block.status_bits[-1] & HAS_JOB
    stands_at(client, "x", 6100.0)
    client.done("x", "move_absolute", target=0.0, **QUICK)
    client.wait_last("x", lambda block: block.set_velocity[-1] == -2000.0, "full velocity")
    client.done("x", "compensation_start", acceleration=500.0, deceleration=500.0, **values)
    client.done("x", "compensation_stop")
    client.wait_last("x", lambda block: block.state[-1] == 1, "Standstill")
    client.done("x", "move_absolute", target=0.0, **QUICK)
    stands_at(client, "x", 0.0)


def packet(client, axis, position, direction, cycle=0, **fields):
    values = {"valid": True, "velocity": 0.0, "acceleration": 0.0, **fields}
    client.write(
        f"/{axis}/external_setpoint",
        msg.ExternalSetpoint,
        cycle=cycle,
        position=position,
        direction=direction,
        **values,
    )


def test_external_setpoints_by_topic(client):
    client.done("y", "external_enable", mode="absolute", target=NAN)
    client.shows("y", "state", 4)
    packet(client, "y", 2.0, 1)
    stands_at(client, "y", 2.0)
    packet(client, "y", 4.0, 1, sequence=7)
    packet(client, "y", 6.0, 1, sequence=7)  # the same number again: not looked at
    stands_at(client, "y", 4.0)
    cycle = client.blocks["y"][-1].first_cycle + 500
    packet(client, "y", 5.0, 1, cycle=cycle)
    assert client.state_at("y", cycle - 1, "set_position") == 4.0
    assert client.state_at("y", cycle, "set_position") == 5.0
    packet(client, "y", 5.5, 1, valid=False)
    packet(client, "y", 8.0, 0)
    stands_at(client, "y", 5.5)
    client.done("y", "external_disable")
    client.shows("y", "state", 1)
    assert not client.blocks["y"][-1].status_bits[-1] & EXTERNAL
    client.done("y", "move_absolute", target=0.0, **QUICK)
    stands_at(client, "y", 0.0)


def test_a_target_of_0_is_a_target(client):
    """NaN leaves a target out, 0 does not: 70082 comes when the axis is elsewhere."""
    client.done("z", "external_enable", mode="absolute", target=0.0)
    packet(client, "z", 3.0, 1, velocity=0.001)
    packet(client, "z", 3.0, 0)
    stands_at(client, "z", 3.0)
    client.spin_until(lambda: any(event.error_id == 70082 for event in client.events), "the target window warning")


def test_feed_releases_by_service_and_topic(client):
    """Withheld by the service, the axis waits; the topic's last value holds, `valid: false` releases both."""
    withheld = 1 << 17
    client.call("z", "external_disable")
    standstill = AxisStateCode.STANDSTILL
    begin = client.wait_last("z", lambda block: block.state[-1] == standstill, "standstill of z").set_position[-1]
    client.done("z", "set_feed_release", forward=False, backward=True)
    client.done("z", "move_relative", distance=20.0, **FROM_THE_AXIS)
    client.wait_last("z", lambda block: block.status_bits[-1] & withheld, "z waits")
    client.write("/z/feed_release", msg.FeedRelease, valid=True, forward=True, backward=False)
    stands_at(client, "z", begin + 20.0)
    client.done("z", "move_relative", distance=-20.0, **FROM_THE_AXIS)
    client.wait_last("z", lambda block: block.status_bits[-1] & withheld, "z waits for the return")
    client.write("/z/feed_release", msg.FeedRelease, valid=False)
    stands_at(client, "z", begin)
