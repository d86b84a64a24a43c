"""The action /<unit>/function_block in a running graph: motion, abort by another block, refusals, cancel, couplings."""

import math

import pytest
from action_msgs.msg import GoalStatus
from client_support import beside_composed_run
from graph_support import PTP
from rcl_interfaces.msg import Parameter as RosParameter
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.msg import ParameterValue as RosValue
from rcl_interfaces.srv import GetParameters, SetParametersAtomically

from cnc_ptp import action
from cnc_ptp.nodes.bridge.function_blocks import INPUTS, POINTS
from cnc_ptp.nodes.topics import SERVICES
from cnc_ptp.plc.plcopen.catalogue import BLOCK_TYPES, OF_AXIS
from cnc_ptp.protocol.axis_states import AxisStateCode as S

QUICK = {"velocity": 2000.0, "acceleration": 5000.0, "deceleration": 5000.0, "jerk": 50_000.0}
SUCCEEDED, CANCELED, ABORTED = GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_CANCELED, GoalStatus.STATUS_ABORTED
DONE, COMMAND_ABORTED = (True, False, False, 0, ""), (False, True, False, 0, "")


@pytest.fixture(scope="module")
def client():
    with beside_composed_run(PTP) as node:
        yield node


def begin(client, unit, name, **inputs):
    """A goal and its feedback."""
    return client.action(action.FunctionBlock, f"/{unit}/function_block", function_block=name, **inputs)


def ended(client, goal):
    """Status of the goal, outputs of its block."""
    status, result = client.result_of(goal)
    return status, (result.done, result.command_aborted, result.error, result.error_id, result.error_text)


def refusal(client, unit, name, **inputs):
    goal, _ = begin(client, unit, name, **inputs)
    status, (done, aborted, error, error_id, text) = ended(client, goal)
    assert (status, done, aborted, error) == (ABORTED, False, False, True)
    return error_id, text


def test_the_goal_has_the_inputs_of_all_blocks_and_an_empty_one_has_none(client):
    of_blocks = {name for types in BLOCK_TYPES.values() for t in types.values() for name in (*t.needed, *t.optional)}
    assert {*INPUTS} == of_blocks - {"cam_table"}
    fields = action.FunctionBlock.Goal.get_fields_and_field_types()
    assert {*fields} == {*INPUTS, *POINTS, "function_block"}
    assert refusal(client, "x", "") == (
        22002, f"axis x: unknown function block ''; nothing was changed. Known: {', '.join(OF_AXIS)}"
    )  # fmt: skip


def test_a_motion_and_what_it_tells(client):
    goal, feedback = begin(client, "x", "MC_MoveAbsolute", position=400.0, **QUICK)
    assert ended(client, goal) == (SUCCEEDED, DONE)
    client.shows("x", "set_position", 400.0)
    told = [message.feedback for message in feedback]
    assert [(f.busy, f.active) for f in told[:2]] == [(True, False), (True, True)]
    assert len(told) >= 4 and all(f.busy for f in told)
    moving = [f for f in told if f.state == S.DISCRETE_MOTION]
    assert moving and all(0.0 <= f.set_position <= 400.0 for f in told) and max(f.set_velocity for f in told) > 100.0
    goal, _ = begin(client, "x", "MC_MoveRelative", distance=-400.0)
    assert ended(client, goal) == (SUCCEEDED, DONE)
    client.shows("x", "set_position", 0.0)


def test_another_block_aborts_it_and_one_waits(client):
    first, told = begin(client, "x", "MC_MoveVelocity", velocity=1000.0)
    client.spin_until(lambda: any(message.feedback.in_velocity for message in told), "the velocity")
    second, _ = begin(client, "x", "MC_MoveAbsolute", position=0.0, buffer_mode="aborting", **QUICK)
    third, waits = begin(client, "x", "MC_MoveRelative", distance=50.0, buffer_mode="buffered", **QUICK)
    assert ended(client, first) == (ABORTED, COMMAND_ABORTED)
    assert ended(client, second) == (SUCCEEDED, DONE)
    assert ended(client, third) == (SUCCEEDED, DONE)
    assert not waits[0].feedback.active and waits[-1].feedback.active
    client.shows("x", "set_position", 50.0)


def test_a_cancel_halts_on_the_ramp(client):
    goal, told = begin(client, "x", "MC_MoveVelocity", velocity=1000.0)
    client.spin_until(lambda: any(message.feedback.in_velocity for message in told), "the velocity")
    at = client.blocks["x"][-1].set_position[-1]
    asked = goal.cancel_goal_async()
    client.spin_until(asked.done, "the answer to the cancel")
    assert len(asked.result().goals_canceling) == 1
    assert ended(client, goal) == (CANCELED, COMMAND_ABORTED)
    block = client.wait_last("x", lambda block: block.set_velocity[-1] == 0.0, "standstill")
    assert block.set_position[-1] > at + 50.0 and not block.error_id[-1]
    goal, _ = begin(client, "x", "MC_MoveAbsolute", position=0.0, **QUICK)
    assert ended(client, goal) == (SUCCEEDED, DONE)


def test_what_is_refused_changes_nothing(client):
    number = len(client.records)
    nothing = "nothing was changed"
    for value in (math.nan, 1e300):
        assert refusal(client, "x", "MC_MoveAbsolute", position=value) == (
            22001, f"axis x: MC_MoveAbsolute refused: input 'position' is missing; {nothing}"
        )  # fmt: skip
    assert refusal(client, "x", "MC_Halt", position=0.0) == (
        22001, f"axis x: MC_Halt refused: unknown input 'position'; {nothing}. Known: none"
    )  # fmt: skip
    assert refusal(client, "x", "MC_Reset", relative=True)[0] == 22001
    assert refusal(client, "x", "MC_GearIn", master="y", periodic=False)[0] == 22001
    assert refusal(client, "x", "MC_MoveRelativ", distance=1.0)[1].startswith(
        f"axis x: unknown function block 'MC_MoveRelativ'; did you mean MC_MoveRelative?; {nothing}. Known: MC_Reset, "
    )
    assert refusal(client, "y", "MC_CamIn", master="x", master_points=[0.0, 1.0, 2.0], slave_points=[0.0, 1.0]) == (
        22001, f"axis y: MC_CamIn refused: 3 master_points and 2 slave_points are no pairs; {nothing}"
    )  # fmt: skip
    assert len(client.records) == number
    assert refusal(client, "x", "MC_MoveAbsolute", position=math.inf) == (
        22001, f"axis x: move_absolute refused: target = inf is not finite; {nothing}"
    )  # fmt: skip
    assert refusal(client, "x", "MC_MoveAbsolute", position=0.0, buffer_mode="later")[0] == 22001
    error_id, text = refusal(client, "x", "MC_MoveAbsolute", position=1e9)
    assert error_id == 120002 and text.endswith(nothing)
    assert client.blocks["x"][-1].set_position[-1] == 0.0 and client.blocks["x"][-1].state[-1] == S.STANDSTILL


def test_couplings(client):
    gear, told = begin(client, "y", "MC_GearIn", master="x", ratio_numerator=-1.0, ratio_denominator=2.0)
    client.spin_until(lambda: any(message.feedback.in_gear for message in told), "in gear")
    move, _ = begin(client, "x", "MC_MoveAbsolute", position=100.0, **QUICK)
    assert ended(client, move) == (SUCCEEDED, DONE)
    client.shows("y", "set_position", -50.0)
    asked = gear.cancel_goal_async()
    client.spin_until(asked.done, "the answer to the cancel")
    assert ended(client, gear) == (CANCELED, COMMAND_ABORTED)
    client.shows("y", "state", S.STANDSTILL)
    points = {"master_points": [100.0, 200.0, 300.0], "slave_points": [0.0, 30.0, 0.0]}
    cam, told = begin(client, "y", "MC_CamIn", master="x", periodic=False, slave_offset=-50.0, **points)
    client.spin_until(lambda: any(message.feedback.in_sync for message in told), "in sync")
    out, _ = begin(client, "y", "MC_CamOut")
    assert ended(client, out) == (SUCCEEDED, DONE) and ended(client, cam) == (ABORTED, COMMAND_ABORTED)


def test_a_parameter_is_written_by_block_and_by_service(client):
    goal, _ = begin(client, "x", "MC_WriteParameter", parameter="P-AXIS-00236", value=5.0)
    assert ended(client, goal) == (SUCCEEDED, DONE)
    client.done("x", "write_parameter", parameter="P-AXIS-00236", value=500.0)
    assert ros_value(client, "getriebe.0.window").integer_value == 500
    refused = client.call("x", "write_parameter", parameter="P-AXIS-00015", value=5.0)
    assert refused.error_id == 23095 and "write_parameter" in SERVICES["axis"]


def ros_value(client, name):
    return client.ask(GetParameters, "/x/get_parameters", names=[name]).values[0]


def set_parameter(client, **values):
    """`ros2 param set /x NAME VALUE`: the answer."""
    wanted = [
        RosParameter(name=name, value=RosValue(type=ParameterType.PARAMETER_INTEGER, integer_value=value))
        for name, value in values.items()
    ]
    return client.ask(SetParametersAtomically, "/x/set_parameters_atomically", parameters=wanted).result


def test_a_parameter_is_set_by_ros(client):
    """At a standstill, as a recorded command; refusals leave the value as it is."""
    records = len(client.records)
    assert set_parameter(client, **{"getriebe.0.kv": 40000}).successful
    assert ros_value(client, "getriebe.0.kv").integer_value == 40000
    client.spin_until(lambda: len(client.records) > records, "the record")
    record = client.records[-1]
    assert (record.command, record.accepted) == ("write_parameter", True)
    assert record.arguments_json == '{"parameter": "getriebe.0.kv", "value": 40000.0}'
    one_by_one = set_parameter(client, **{"getriebe.0.kv": 30000, "getriebe.0.window": 5})
    assert one_by_one.reason == "x: parameters are set one by one; nothing was changed"
    assert set_parameter(client, **{"kenngr.achs_mode": 4}).reason == (
        "P-ERR-23095 axis x: P-AXIS-00015 (kenngr.achs_mode) cannot be written at run time, it is taken over at "
        "start-up only; nothing was changed"
    )
    assert set_parameter(client, **{"getriebe.0.kv": 0}).reason == (
        "P-ERR-23096 axis x: P-AXIS-00099 getriebe[0].kv: value 0 is not above 0 (0.01/s); nothing was changed"
    )
    ascending = set_parameter(client, **{"vorsteuer.vs_v_nenner": 0})
    assert ascending.reason == (
        "P-ERR-23096 axis x: write_parameter refused: axis list, P-AXIS-00229 vorsteuer.vs_v_nenner of /x: value 0 is "
        "not a valid denominator; nothing was changed"
    )
    goal, _ = begin(client, "x", "MC_MoveVelocity", velocity=10.0)
    client.wait_last("x", lambda block: block.set_velocity[-1] > 0.0, "motion")
    moving = set_parameter(client, **{"getriebe.0.kv": 30000})
    assert moving.reason == (
        "P-ERR-23097 axis x: write_parameter refused: P-AXIS-00099 (getriebe[i].kv) is written at a standstill only, the "
        "axis is in ContinuousMotion; nothing was changed"
    )
    goal.cancel_goal_async()
    client.wait_last("x", lambda block: block.set_velocity[-1] == 0.0, "standstill")
    assert ros_value(client, "getriebe.0.kv").integer_value == 40000
    assert ros_value(client, "vorsteuer.vs_v_nenner").integer_value == 1


def test_a_goal_that_is_open_at_the_end_of_the_run(client):
    """Last: it ends the run."""
    goal, told = begin(client, "z", "MC_MoveVelocity", velocity=10.0)
    client.spin_until(lambda: any(message.feedback.in_velocity for message in told), "the velocity")
    gear, told = begin(client, "y", "MC_GearIn", master="x")
    client.spin_until(lambda: any(message.feedback.in_gear for message in told), "in gear")
    client.done("plc", "stop_all")
    assert ended(client, goal) == (ABORTED, COMMAND_ABORTED)
    assert ended(client, gear) == (
        ABORTED, (False, False, True, 26115, "axis y: MC_GearIn without an end: the run has ended")
    )  # fmt: skip
    late, _ = begin(client, "z", "MC_Halt")
    assert ended(client, late) == (
        ABORTED, (False, False, True, 26115, "axis z: MC_Halt refused: the run has ended; nothing was changed")
    )  # fmt: skip
