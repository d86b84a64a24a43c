"""A graph under the hands of a PLC and an operator: every topic and service acts, refuses and is recorded.

All tests share one run. At its end the recording of this run, which no script has played, is verified to the bit.
"""

import math
import signal
import subprocess
import sys
import time

import pytest
from action_msgs.msg import GoalStatus
from client_support import Client, connected
from diagnostic_msgs.msg import DiagnosticArray
from graph_support import MILL, Running, run, small_machine, verified, wait_for_handler
from mcap.writer import MCAP0_MAGIC
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters, SetParametersAtomically
from sensor_msgs.msg import JointState

from cnc_ptp import action, msg
from cnc_ptp.nodes import convert
from cnc_ptp.nodes.topics import BLOCKS, DIAGNOSTICS, EVENTS, JOINT_STATES, LATEST, PLC_INPUT
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.channel_states import ChannelStateCode

UNHEARD_DURATION = 300
"""Seconds: longer than all tests need; the last test ends the run."""


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return small_machine(tmp_path_factory.mktemp("machine"))


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    return tmp_path_factory.mktemp("client") / "run.mcap"


@pytest.fixture(scope="module")
def graph(ros_domain, machine, recording):
    with Running(machine, "--duration", UNHEARD_DURATION, "--record", recording) as graph:
        graph.wait_for_nodes(7)
        yield graph


@pytest.fixture(scope="module")
def client(graph, machine):
    with connected(Client, machine) as client:
        client.wait_blocks("x", 1)
        yield client


@pytest.fixture
def program(tmp_path):
    path = tmp_path / "job.nc"
    path.write_text("%job\nN10 G01 X60 F3000\nN20 M08\nN30 G01 X0 Y5\nM30\n")
    return str(path)


def stands(block):
    return block.state[-1] == AxisStateCode.STANDSTILL


def test_a_move_begins_at_the_cycle_of_the_answer(client):
    response = client.done("x", "move_absolute", target=30.0, velocity=100.0)
    assert response.message == "" and response.cycle % 10 == 0
    assert client.state_at("x", response.cycle - 1, "state") == AxisStateCode.STANDSTILL
    assert client.state_at("x", response.cycle, "state") == AxisStateCode.DISCRETE_MOTION
    assert client.state_at("x", response.cycle + 1, "set_jerk") == 50_000.0
    client.refused(
        "x",
        "move_absolute",
        23005,
        "axis x: move_absolute refused: the axis is in DiscreteMotion, it must be in Standstill; nothing was changed",
        target=1.0,
    )
    end = client.wait_last("x", stands, "standstill")
    assert end.set_position[-1] == 30.0


def test_left_out_dynamics_come_from_the_parameters(client):
    response = client.done("x", "move_relative", distance=-30.0, velocity=math.nan, acceleration=0.0)
    record = next(record for record in reversed(client.records) if record.command == "move_relative")
    assert record.arguments_json == '{"distance": -30.0}' and record.cycle == response.cycle
    assert client.wait_last("x", stands, "standstill").set_position[-1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("command", "fields", "error_id", "message"),
    [
        (
            "move_absolute",
            {"target": 400.0},
            120002,
            "target 400.0 mm lies beyond the positive soft limit 300.0 mm (P-AXIS-00178)",
        ),
        ("move_absolute", {"target": math.nan}, 22001, "target = nan is not finite"),
        (
            "move_absolute",
            {"target": 1.0, "velocity": 501.0},
            23004,
            "velocity 501.0 mm/s is above the maximum 500.0 mm/s (P-AXIS-00212)",
        ),
        ("move_absolute", {"target": 1.0, "jerk": -1.0}, 23003, "jerk = -1.0 must be greater than 0"),
        (
            "set_override",
            {"percent": 100.5},
            23006,
            "percent = 100.5 is not within 0 ... 100 (P-AXIS-00109, at most 100)",
        ),
    ],
)
def test_refusals_say_why(client, command, fields, error_id, message):
    text = f"axis x: {command} refused: {message}; nothing was changed"
    client.refused("x", command, error_id, text, **fields)
    client.spin_until(lambda: any(event.text == text for event in client.events), "the event")


def test_stop_ends_on_the_ramp(client):
    client.done("y", "move_absolute", target=150.0, velocity=5.0)
    client.wait_last("y", lambda block: block.set_velocity[-1] == 5.0, "full velocity")
    response = client.done("y", "stop")
    assert client.state_at("y", response.cycle, "state") == AxisStateCode.STOPPING
    end = client.wait_last("y", stands, "standstill")
    assert 0.0 < end.set_position[-1] < 150.0
    assert client.call("y", "stop").message == "P-WARN-23073 axis y: stop without effect in Standstill"
    client.done("y", "move_absolute", target=0.0)
    client.wait_last("y", stands, "standstill")


def test_override_topic(client):
    client.override("x", 50.0)
    client.shows("x", "override_percent", 50.0)
    before = len(client.commands("x", "set_override"))
    client.override("x", 50.0)
    assert len(client.commands("x", "set_override")) == before, "only a change counts"
    client.override("x", 0.0, valid=False)
    client.shows("x", "override_percent", 100.0)  # not served: 100 %


def test_sequence_numbers(client):
    for sequence, percent, expected in (
        (10, 60, 60.0),
        (10, 70, 60.0),  # repeated
        (9, 70, 60.0),  # older
        (11, 80, 80.0),
        (1, 90, 90.0),  # a PLC that starts again
        (1, 95, 90.0),
        (2**31, 85, 85.0),
        (2**32 - 1, 75, 75.0),
        (5, 65, 65.0),  # ran over
        (0, 100, 100.0),  # not used
    ):
        client.override("y", percent, sequence=sequence)
        client.shows("y", "override_percent", expected)


def test_bad_values_are_refused_once(client):
    for value, text in (
        (math.nan, "percent = nan is not finite"),
        (250.0, "percent = 250.0 is not within 0 ... 100 (P-AXIS-00109, at most 100)"),
    ):
        before = len(client.records)

        def refusals(before=before):
            return [record for record in client.records[before:] if record.target == "x"]

        client.override("x", value)
        client.spin_until(refusals, "the refusal")
        client.override("x", value)
        assert [record.message for record in refusals()] == [
            f"axis x: set_override refused: {text}; nothing was changed"
        ]
        assert client.blocks["x"][-1].override_percent[-1] == 100.0
    client.override("x", 100.0)


def test_enable_topic(client):
    client.switch("/y/enable", False)
    client.shows("y", "state", AxisStateCode.DISABLED)
    text = "axis y: move_absolute refused: the axis is in Disabled, it must be in Standstill; nothing was changed"
    client.refused("y", "move_absolute", 23005, text, target=1.0)
    client.switch("/y/enable", False, valid=False)
    client.shows("y", "state", AxisStateCode.STANDSTILL)  # not served: enabled


def test_spindle(client):
    client.override("s", 50.0)
    client.done("s", "start", direction="cw", speed_rpm=1000.0)
    client.wait_last("s", lambda block: block.speed_reached[-1], "speed reached")
    assert client.wait_last("s", lambda block: block.set_speed_rpm[-1] == 500.0, "500 rpm").override_percent[-1] == 50.0
    text = "spindle s: start refused: direction = 'up' is not cw or ccw; nothing was changed"
    client.refused("s", "start", 22001, text, direction="up", speed_rpm=10.0)
    client.override("s", 100.0)
    client.done("s", "stop")
    client.wait_last("s", lambda block: block.speed_zero[-1] and block.set_speed_rpm[-1] == 0.0, "speed zero")


def test_channel_refusals(client, program, tmp_path):
    text = "channel channel: start refused: no program is loaded; nothing was changed"
    client.refused("channel", "start", 22003, text)
    text = "channel channel: load refused: NC program /nowhere.nc cannot be read: No such file or directory"
    client.refused("channel", "load", 26110, f"{text}; nothing was changed", program="/nowhere.nc")
    wrong = tmp_path / "wrong.nc"
    wrong.write_text("%w\nN10 G01 X60\nM30\n")
    assert client.done("channel", "load", program=str(wrong))
    response = client.call("channel", "start")
    assert not response.accepted and "line 2" in response.message and "N10 G01 X60" in response.message


def test_program_with_override_and_feed_hold(client, program):
    client.done("channel", "load", program=program)
    client.override("channel", 2.0)  # slow enough for all that is to be seen on the way
    response = client.done("channel", "start")
    client.shows("channel", "state", ChannelStateCode.RUNNING)
    text = "channel channel: start refused: a program is running (line 2); nothing was changed"
    client.refused("channel", "start", 22004, text)
    assert client.state_at("x", response.cycle + 10, "state") == AxisStateCode.SYNCHRONIZED_MOTION
    client.override("channel", 40.0)
    client.shows("channel", "override_percent", 40.0)
    client.switch("/channel/feed_hold", True)
    client.wait_last("channel", lambda block: block.state[-1] == ChannelStateCode.HOLD, "hold")
    client.switch("/channel/feed_hold", True, valid=False)
    client.override("channel", 150.0)
    client.wait_last("channel", lambda block: block.done, "the end of the program")
    client.shows("y", "set_position", 5.0)
    client.override("channel", 100.0)


def test_handshake_by_hand(client, program):
    requests = []
    client.create_subscription(msg.HandshakeRequest, "/channel/handshake", requests.append, EVENTS)
    client.done("plc", "auto_acknowledge", enabled=False)
    client.done("channel", "load", program=program)
    start = client.done("channel", "start").cycle
    client.wait_last("channel", lambda block: block.state[-1] == ChannelStateCode.WAITING, "waiting for M08")
    client.spin_until(lambda: requests and requests[-1].cycle > start, "the request of M08")
    request = requests[-1]
    assert (request.kind, request.number, request.line, request.acknowledge_needed) == ("M", 8, 3, True)
    client.wait_blocks("channel", 20)
    assert client.blocks["channel"][-1].line[-1] == 3, "the path waits"
    text = f"plc plc: acknowledge refused: no request 9999 waits; nothing was changed. Waiting: {request.id}"
    client.refused("plc", "acknowledge", 22013, text, id=9999)
    client.done("plc", "acknowledge", id=request.id)
    client.wait_last("channel", lambda block: block.done, "the end of the program")
    client.done("plc", "auto_acknowledge", enabled=True)


def test_zero_offsets_by_services(client):
    """What is taught and set counts for the next program, and a late subscriber sees what counts."""
    client.wait_blocks("channel", 3)
    position = client.blocks["channel"][-1].programmed_position[0]
    client.done("channel", "teach_zero_offset", index=2, axis="X", value=1.0)
    client.done("channel", "set_zero_offset", index=2, axis="Y", value=-2.5)
    text = "channel channel: set_zero_offset refused: 'Q' is no axis of the channel (X, Y); nothing was changed"
    client.refused("channel", "set_zero_offset", 22031, text, index=2, axis="Q", value=1.0)
    client.done("channel", "mdi", text="G55")
    shown = []
    client.wait_last("channel", lambda block: block.programmed_position[0] == 1.0, "the offset")
    client.create_subscription(msg.ChannelOffsets, "/channel/offsets", shown.append, EVENTS)
    client.spin_until(lambda: shown and shown[-1].zero_index == 2, "the offsets")
    assert list(shown[-1].zero_offset) == [position - 1.0, -2.5]
    client.done("channel", "mdi", text="G53")


def test_move_action(client):
    client.override("x", 0.0)
    goal, feedback = client.action(action.MoveAxis, "/x/move", target=40.0, velocity=100.0)
    assert goal.accepted
    second, _ = client.action(action.MoveAxis, "/x/move", target=1.0)
    assert not second.accepted, "one job at a time"
    client.override("x", 100.0)
    status, result = client.result_of(goal)
    assert status == GoalStatus.STATUS_SUCCEEDED
    assert (result.success, result.error_id, result.message, result.position) == (True, 0, "", 40.0)
    distances = [message.feedback.remaining_distance for message in feedback]
    assert distances == sorted(distances, reverse=True) and distances[-1] < distances[0] <= 40.0


def test_cancelled_move_stops_on_its_ramp(client):
    goal, feedback = client.action(action.MoveAxis, "/x/move", target=0.0, velocity=2.0)
    client.spin_until(lambda: feedback, "feedback")
    cancel = goal.cancel_goal_async()
    client.spin_until(cancel.done, "the answer to the cancel")
    status, result = client.result_of(goal)
    assert status == GoalStatus.STATUS_CANCELED and not result.success
    assert 0.0 < result.position < 40.0
    assert result.message == f"the axis was stopped at {result.position}"
    client.shows("x", "state", AxisStateCode.STANDSTILL)


def test_refused_move_is_aborted(client):
    goal, _ = client.action(action.MoveAxis, "/x/move", target=1000.0)
    status, result = client.result_of(goal)
    assert status == GoalStatus.STATUS_ABORTED and (result.success, result.error_id) == (False, 120002)
    assert result.message.startswith("axis x: move_absolute refused: target 1000.0 mm lies beyond")


def test_the_death_of_a_client_stops_nothing(client, machine):
    other = Client(read_machine(str(machine)))
    other.start()
    goal, _ = other.action(action.MoveAxis, "/x/move", target=0.0, velocity=50.0)
    assert goal.accepted
    other.destroy_node()
    other.executor_of_test.shutdown()
    client.wait_last("x", lambda block: stands(block) and block.set_position[-1] == 0.0, "the end of the move")
    client.wait_blocks("channel", 3)  # the channel is notified a block later


def test_run_program_action(client, program):
    goal, feedback = client.action(action.RunProgram, "/channel/run_program", program=program)
    status, result = client.result_of(goal)
    assert (result.message, result.error_id, status) == ("", 0, GoalStatus.STATUS_SUCCEEDED)
    assert client.state_at("channel", result.cycle, "state") == ChannelStateCode.READY
    progress = [message.feedback.progress for message in feedback]
    assert progress == sorted(progress) and {message.feedback.line for message in feedback} >= {2, 4}
    client.override("channel", 2.0)
    goal, feedback = client.action(action.RunProgram, "/channel/run_program")
    client.spin_until(lambda: feedback, "feedback")
    cancel = goal.cancel_goal_async()
    client.spin_until(cancel.done, "the answer to the cancel")
    status, result = client.result_of(goal)
    assert status == GoalStatus.STATUS_CANCELED
    assert result.message.startswith("the program was aborted after block ")
    client.override("channel", 100.0)
    goal, _ = client.action(action.RunProgram, "/channel/run_program", program="/nowhere.nc")
    status, result = client.result_of(goal)
    assert status == GoalStatus.STATUS_ABORTED and result.error_id == 26110
    for axis in ("x", "y"):
        client.wait_last(axis, stands, "standstill")
        client.done(axis, "move_absolute", target=0.0)
        client.wait_last(axis, stands, "standstill")


def test_the_program_topic_and_a_start_at_a_line(client, program, tmp_path):
    """Late readers get the newest state; the action starts at a line and says how long it takes."""
    (tmp_path / "own.nc").write_text("G91 Y1\nG90\nM29\n")
    client.done("channel", "load", program=program)
    states = []
    client.create_subscription(msg.ProgramState, "/channel/program", states.append, LATEST)
    client.spin_until(lambda: states and states[-1].program == program, "the loaded program")
    assert (states[-1].available, states[-1].active) == (["job.nc", "own.nc"], False)
    goal, feedback = client.action(action.RunProgram, "/channel/run_program", line=4)
    status, result = client.result_of(goal)
    assert (result.message, status) == ("", GoalStatus.STATUS_SUCCEEDED)
    left = [message.feedback.time_left for message in feedback]
    assert left == sorted(left, reverse=True) and 0.0 < left[0] < 3.0
    active = [state for state in states if state.active]
    assert {state.text for state in active} >= {"N30 G01 X0 Y5"} and 2 not in {state.line for state in active}
    assert [state.percent for state in active] == sorted(state.percent for state in active)
    client.spin_until(lambda: not states[-1].active, "the end")
    assert (states[-1].percent, states[-1].time_left) == (100.0, 0.0)
    events = [event.text for event in client.events if event.error_id == 22045]
    assert events[-3:] == ["line 3: M8", "G00: X 0 to 60", "continues with line 4 'N30 G01 X0 Y5'"]
    client.done("channel", "mdi", text="L own.nc")
    client.wait_last("channel", lambda block: block.done and block.set_position[-10] == 6.0, "the called program")
    assert (
        '"files": {"own.nc": "G91 Y1' in next(r for r in reversed(client.records) if r.command == "mdi").arguments_json
    )
    client.done("channel", "block_skip", enabled=True, level=2)
    client.done("channel", "single_block", enabled=True, mode="motion")
    client.done("channel", "single_block", enabled=False)
    client.refused(
        "channel",
        "block_skip",
        22001,
        "channel channel: block_skip refused: level = 11 is not within 1 ... 10; nothing was changed",
        level=11,
    )
    client.refused(
        "channel",
        "start",
        22040,
        f"{program}: there is no block N25; there are N20 and N30 next to it; nothing was started",
        block_number=25,
    )
    client.done("channel", "mdi", text="G00 X0 Y0")
    client.wait_last("channel", lambda block: block.done, "the way back")


def test_a_block_comes_soon_after_its_stamp(client):
    """As `ros2 topic delay` measures it; it was 106 ms once."""
    delays = []

    def received(message):
        delays.append(time.time_ns() - convert.nanoseconds(message.header.stamp))

    subscription = client.create_subscription(msg.AxisBlock, "/x/block", received, BLOCKS)
    client.spin_until(lambda: len(delays) >= 100 and min(delays) < 50e6, "blocks, the quickest within 50 ms")
    client.destroy_subscription(subscription)
    assert min(delays) > -1e6


def test_joint_states_in_si_units(client):
    seen = []
    client.create_subscription(JointState, JOINT_STATES, seen.append, PLC_INPUT)
    client.done("x", "move_absolute", target=200.0, velocity=100.0)
    client.wait_last("x", lambda block: block.set_velocity[-1] == 100.0, "full velocity")
    client.wait_blocks("x", 20)
    client.wait_last("x", stands, "standstill")
    client.wait_blocks("x", 40)
    assert all(list(state.name) == ["x", "y", "s"] for state in seen)
    assert seen[-1].position[0] == pytest.approx(0.2, abs=1e-5)
    assert max(state.velocity[0] for state in seen) == pytest.approx(0.1, rel=0.01)
    client.done("x", "move_absolute", target=0.0)
    client.wait_last("x", stands, "standstill")


def test_diagnostics(client):
    seen = {}

    def received(array):
        for status in array.status:
            seen[status.name] = (status, {value.key: value.value for value in status.values})

    client.create_subscription(DiagnosticArray, DIAGNOSTICS, received, PLC_INPUT)
    client.spin_until(lambda: len(seen) == 5, "the diagnostics of all units")
    assert set(seen) == {"plc", "channel", "s", "x", "y"}
    status, values = seen["x"]
    assert status.hardware_id == "cnc_ptp" and status.level < b"\x02"  # a late block is a warning
    assert status.message == "Standstill" or (status.level == b"\x01" and status.message.startswith("a block came "))
    assert values["lost blocks"] == "0" and values["blocks that came twice"] == "0" and int(values["blocks"]) > 100
    assert float(values["following error, largest [mm]"]) > 0.0
    assert 0.0 < float(values["lateness p50 [ms]"]) <= float(values["lateness p99 [ms]"])


def test_parameters(client):
    ask, name = client.ask, "getriebe.0.incr_per_rev"
    assert name in ask(ListParameters, "/x/list_parameters").result.names
    descriptor = ask(DescribeParameters, "/x/describe_parameters", names=[name]).descriptors[0]
    assert descriptor.read_only and descriptor.type == ParameterType.PARAMETER_INTEGER
    assert "P-AXIS-00092" in descriptor.description
    assert descriptor.integer_range[0].from_value >= 0 and descriptor.integer_range[0].to_value > 5000
    value = ask(GetParameters, "/x/get_parameters", names=[name]).values[0]
    assert value.integer_value == 1048576
    wanted = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=1)
    parameters = [Parameter(name=name, value=wanted)]
    result = ask(SetParameters, "/x/set_parameters", parameters=parameters).results[0]
    assert not result.successful and result.reason.startswith("P-ERR-23095 axis x: P-AXIS-00092 (")
    plc = ask(GetParameters, "/plc/get_parameters", names=["watchdog_ms"]).values[0]
    assert plc.integer_value == 200


def test_the_table_size_of_friction_compensation_is_fixed_after_start_up(client):
    wanted = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=30)
    parameters = [Parameter(name="frict_comp.max_points", value=wanted)]
    one_by_one = client.ask(SetParameters, "/y/set_parameters", parameters=parameters).results[0]
    together = client.ask(SetParametersAtomically, "/y/set_parameters_atomically", parameters=parameters).result
    for result in (one_by_one, together):
        assert (result.successful, result.reason) == (
            False,
            "P-ERR-110641 axis y: frict_comp.max_points = 20 (P-COMP-00062) cannot be changed to 30 after start-up;"
            " nothing was changed, set it in the machine file and start again",
        )


@pytest.mark.parametrize(
    ("options", "content"), [([], MCAP0_MAGIC + b"of yesterday"), (["--composed"], None)], ids=["graph", "composed"]
)
def test_a_second_run_on_the_domain_is_refused(client, ros_domain, machine, options, content, tmp_path):
    """It leaves the file that it was to write as it is, or does not make it."""
    file = tmp_path / "second.mcap"
    if content:
        file.write_bytes(content)
    error = run("run", machine, "--duration", "1", "--record", file, *options, expect=2).stderr
    assert error == (
        f"P-ERR-26107 a run is under way on ROS domain {ros_domain} of this machine; nothing was started. "
        "Wait for its end, choose another --namespace, or set ROS_DOMAIN_ID to another number\n"
    )
    assert (file.read_bytes() if content else file.exists()) == (content or False)


def test_a_node_that_comes_too_late_ends(client):
    """The axis z of the larger machine; y would be refused because the run has it."""
    late = [sys.executable, "-m", "cnc_ptp.nodes.axis", str(MILL), "z"]
    done = subprocess.run(late, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and "Traceback" not in done.stderr
    assert done.stderr.startswith("P-ERR-26116 z: the run is at cycle ")
    assert "the node takes no part and ends: nodes must be there before the clock starts" in done.stderr


def test_lost_life_sign_of_the_plc_holds_the_feed(client):
    for counter in range(3):
        client.write("/plc/life_sign", msg.LifeSign, counter=counter)
    client.switch("/channel/feed_hold", False)
    client.spin_until(lambda: any(event.error_id == 26103 for event in client.events), "the event")
    event = next(event for event in client.events if event.error_id == 26103)
    assert event.text.startswith("plc: no life sign of the external PLC for ")
    assert event.text.endswith(" ms; feed hold is set on channel, s, x, y")
    hold, free = ('{"enabled": true}', True), ('{"enabled": false}', True)
    client.spin_until(lambda: client.commands("channel", "feed_hold")[-1] == hold, "feed hold")
    client.write("/plc/life_sign", msg.LifeSign, counter=7)
    before = len(client.commands("channel", "feed_hold"))
    client.switch("/channel/feed_hold", False)  # the same value as before the loss, and a change all the same
    client.spin_until(lambda: free in client.commands("channel", "feed_hold")[before:], "the PLC takes it away")
    for unit in ("x", "y", "s"):
        client.done(unit, "feed_hold", enabled=False)


def test_stop_all_ends_the_run_and_the_recording_verifies(client, graph, recording):
    client.done("s", "start", direction="ccw", speed_rpm=600.0)
    client.done("y", "move_absolute", target=150.0, velocity=20.0)
    client.wait_blocks("y", 20)
    client.done("plc", "stop_all")
    output = graph.finish(expect=0)
    assert "lost 0, computed twice 0" in output
    assert "refused: P-ERR-120002 axis x: move_absolute refused: target 400.0 mm lies beyond" in output
    recorded = verified(recording)
    assert recorded.complete and recorded.last_cycle < UNHEARD_DURATION * 1000 - 1
    seen = {(record.cycle, record.target, record.command, record.arguments_json) for record in client.records}
    known = {(record.cycle, record.target, record.command, record.arguments_json) for record in recorded.commands}
    assert seen <= known and len(seen) > 50
    assert recorded.states["/y/state"]["set_velocity"][-1] == 0.0
    assert recorded.states["/s/state"]["set_speed_rpm"][-1] == 0.0
    assert {event.error_id for event in recorded.events} >= {26103, 26110, 120002}


def test_a_clock_that_is_told_to_end_says_so(ros_domain, machine):
    """A clock ends with status 0 in every good run; the supervisor must be able to tell the two apart."""
    clock = subprocess.Popen([sys.executable, "-m", "cnc_ptp.nodes.clock", str(machine)], stderr=subprocess.PIPE)
    try:
        wait_for_handler(clock.pid, signal.SIGTERM)
        clock.send_signal(signal.SIGTERM)
        assert clock.wait(10.0) == 128 + signal.SIGTERM
    finally:
        clock.kill()
        clock.wait()
        clock.stderr.close()
