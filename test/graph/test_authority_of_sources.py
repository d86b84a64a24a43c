"""Command authority in a graph: services, actions, parameters and topics of a closed axis, each by the way it comes."""

import pytest
from action_msgs.msg import GoalStatus
from authority_support import END, closed_file
from builtin_interfaces.msg import Duration
from client_support import beside_composed_run
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from cnc_ptp import action, msg, srv
from cnc_ptp.nodes.topics import TRAJECTORY_ACTION, TRAJECTORY_TOPIC

SERVICES_RULE = "the machine file closes it to services (closed_to_services, P-MACH-00083)"
TOPICS_RULE = "the machine file closes it to topics (closed_to_topics, P-MACH-00082)"


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    """Beside a machine whose axis x is closed to services and topics."""
    with beside_composed_run(closed_file(tmp_path_factory.mktemp("authority"), "services", "topics")) as client:
        yield client


def refusal(command):
    return f"axis x: {command} refused: {SERVICES_RULE}{END}"


def test_services(client):
    client.refused("x", "move_absolute", 26218, refusal("move_absolute"), target=5.0)
    client.refused("x", "set_override", 26218, refusal("set_override"), percent=50.0)
    client.done("y", "move_absolute", target=5.0)
    client.shows("y", "set_position", 5.0)
    client.shows("x", "set_position", 0.0)
    client.spin_until(lambda: client.commands("x", "move_absolute"), "the record")
    assert [accepted for _, accepted in client.commands("x", "move_absolute")] == [False]


def test_what_stops_is_taken(client):
    assert client.call("x", "halt").error_id != 26218
    assert client.call("x", "feed_hold", enabled=True).accepted


def test_services_that_the_plc_answers(client):
    coupled = client.ask(srv.Couple, "/x/couple", master="y", factor=1.0)
    assert (coupled.accepted, coupled.error_id, coupled.message) == (False, 26218, refusal("couple"))
    given = client.ask(
        srv.GiveExternalSetpoints, "/x/external_setpoints", setpoints=[msg.ExternalSetpoint(direction=1)]
    )
    assert (given.accepted, given.error_id, given.message) == (False, 26218, refusal("external_setpoints"))


def test_actions(client):
    goal, _ = client.action(action.MoveAxis, "/x/move", target=5.0)
    status, result = client.result_of(goal)
    assert (status, result.error_id, result.message) == (GoalStatus.STATUS_ABORTED, 26218, refusal("move_absolute"))
    goal, _ = client.action(action.FunctionBlock, "/x/function_block", function_block="MC_MoveAbsolute", position=5.0)
    status, result = client.result_of(goal)
    assert (result.error, result.error_id, result.error_text) == (True, 26218, refusal("MC_MoveAbsolute"))
    goal, _ = client.action(action.FunctionBlock, "/x/function_block", function_block="MC_Halt")
    status, result = client.result_of(goal)
    assert result.error_id != 26218


def trajectory():
    point = JointTrajectoryPoint(positions=[0.001, 0.001], time_from_start=Duration(sec=1))
    return JointTrajectory(joint_names=["y", "x"], points=[point])


def test_a_trajectory_with_an_axis_that_is_closed(client):
    goal, _ = client.action(action.FollowTrajectory, f"/{TRAJECTORY_ACTION}", trajectory=trajectory())
    _, result = client.result_of(goal)
    text = f"plc plc: follow_trajectory refused: axis x: {SERVICES_RULE}{END}"
    assert (result.error_id, result.error_string) == (26218, text)
    client.write(f"/{TRAJECTORY_TOPIC}", JointTrajectory, joint_names=["x"], points=trajectory().points[:1])
    wanted = f"plc plc: follow_trajectory refused: axis x: {TOPICS_RULE}{END}"
    client.spin_until(lambda: wanted in [event.text for event in client.events], "the event of the topic")


def test_parameters(client):
    value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=900.0)
    wanted = Parameter(name="getriebe.0.kv", value=value)
    [answer] = client.ask(SetParameters, "/x/set_parameters", parameters=[wanted]).results
    assert not answer.successful


def test_topics(client):
    """The first refused message of an axis and command is told."""

    def told(command):
        text = f"axis x: {command} refused: {TOPICS_RULE}{END}"
        return [event.error_id for event in client.events if event.text == text]

    for sequence in range(1, 6):
        client.write("/x/jog", msg.Jog, sequence=sequence, valid=True, velocity=5.0)
        client.write("/x/override", msg.Override, percent=10.0 * sequence, valid=True, sequence=sequence)
        client.write("/x/external_setpoint", msg.ExternalSetpoint, sequence=sequence, valid=True, direction=1)
    for command in ("jog", "set_override", "external_setpoints"):
        client.spin_until(lambda command=command: told(command), command)
        assert told(command) == [26218]
    client.shows("x", "set_position", 0.0)
    client.shows("x", "override_percent", 100.0)
    client.wait_blocks("x", 40)  # longer than a jog may be silent
    assert [event.text for event in client.events if event.error_id == 26134] == [], "it has begun no jog"
    client.write("/y/jog", msg.Jog, sequence=1, valid=True, velocity=5.0)
    client.wait_last("y", lambda block: block.set_position[-1] > 5.0, "a jog of an open axis")
