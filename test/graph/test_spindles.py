"""Spindles in processes of their own: coupled, with gears, by services and actions, and as in the offline run."""

from copy import deepcopy

import numpy as np
import pytest
import yaml
from action_msgs.msg import GoalStatus
from client_support import beside_composed_run
from graph_support import MILL, run, states_equal, verified
from long_support import long

from cnc_ptp import action, srv

SCENARIO = """
- {at: 0.0, to: t, do: couple, master: s, factor_num: -1, factor_den: 2}
- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 2000.0}
- {at: 0.6, to: s, do: set_override, percent: 80.0}
- {at: 0.8, to: s, do: orient, position_deg: 30.0, speed_rpm: 300.0}
- {at: 1.6, to: t, do: decouple}
- {at: 1.6, to: s, do: select_gear, stage: 2}
- {at: 1.6, to: s, do: start, direction: ccw, speed_rpm: 700.0, source: plc}
- {at: 1.6, to: s, do: orient, position_deg: 200.0, source: plc}
- {at: 1.7, to: t, do: home}
- {at: 2.6, to: t, do: start, direction: cw, speed_rpm: 900.0}
"""


def machine_of(folder):
    """The mill without axes, its spindle twice; `s` with two gears, `t` with a control limit, not yet homed."""
    mill = yaml.load(MILL.read_text(), yaml.BaseLoader)
    spindle = mill["/s"]["ros__parameters"]
    gear = spindle["getriebe"]["0"]
    machine = mill["/machine"]["ros__parameters"] | {"channels": [], "axes": [], "spindles": ["s", "t"]}
    other = {**gear, "getr_schalt_pos": "450000", "kv": "4000"}
    s = {**spindle, "getriebe": {"0": gear, "1": other}}
    t = {
        **spindle,
        "kopf": {"achs_nr": "5"},
        "getriebe": {"0": {**gear, "vb_regelgrenze": "4200000"}},
        "simulation": {"drive_time_constant": "3000", "referenced_at_start": "0", "zero_pulse": "77.7"},
    }
    units = deepcopy({"/machine": machine}) | {"/s": deepcopy(s)} | {"/t": deepcopy(t)}
    units["/s"]["getriebe"] = {stage: deepcopy(record) for stage, record in s["getriebe"].items()}
    path = folder / "spindles.yaml"
    path.write_text(yaml.dump({name: {"ros__parameters": part} for name, part in units.items()}).replace("'", ""))
    return path


@pytest.mark.parametrize("options", [*long([[]]), ["--composed", "--free-run"]], ids=str)
def test_coupled_spindles_in_the_graph_equal_the_offline_run(tmp_path, options):
    (tmp_path / "job.yaml").write_text(SCENARIO)
    job = (machine_of(tmp_path), "--scenario", tmp_path / "job.yaml")
    run("simulate", *job, "--record", tmp_path / "a.mcap")
    output = run("run", *job, *options, "--record", tmp_path / "b.mcap").stdout
    assert "lost 0, computed twice 0" in output
    assert states_equal(tmp_path / "a.mcap", tmp_path / "b.mcap") == []
    states = verified(tmp_path / "b.mcap").states
    s, t = states["/s/state"], states["/t/state"]
    assert t["set_speed_rpm"][550] == -1000.0 and s["set_speed_rpm"][550] == 2000.0
    assert np.array_equal(np.unique(s["gear"]), [1, 2]) and t["referenced"].any()


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    folder = tmp_path_factory.mktemp("spindles")
    with beside_composed_run(machine_of(folder)) as client:
        yield client


def test_services_of_a_spindle(client):
    client.done("s", "orient", position_deg=100.0, speed_rpm=0.0, direction="", source="")
    client.wait_last("s", lambda block: block.in_position[-1], "in position")
    client.done("s", "set_limits", max_speed_rpm=500.0, min_speed_rpm=float("nan"), max_acceleration=0.0)
    answer = client.done("s", "start", direction="cw", speed_rpm=800.0, source="")
    client.wait_last("s", lambda block: block.set_speed_rpm[-1] == 500.0, "500 rpm")
    client.done("s", "set_speed", speed_rpm=300.0, source="")
    client.wait_last("s", lambda block: block.set_speed_rpm[-1] == 300.0, "300 rpm")
    client.done("s", "stop", source="")
    client.wait_last("s", lambda block: block.speed_zero[-1], "speed zero")
    client.done("s", "select_gear", stage=2, source="")
    client.wait_last("s", lambda block: block.gear[-1] == 2, "gear 2")
    client.done("s", "reset_limits")
    text = "spindle s: select_gear refused: gear 4 has no record getriebe[i]; known are: 1, 2; nothing was changed"
    client.refused("s", "select_gear", 24014, text, stage=4, source="")
    text = "spindle s: stop refused: unknown source 'plcs'; nothing was changed. Known: plc"
    client.refused("s", "stop", 22001, text, source="plcs")
    assert answer is None or answer.accepted


def test_external_commanding_is_acknowledged(client):
    """Page 11: in order of arrival; the block says how many are done."""
    before = client.wait_last("s", lambda block: True, "a block").plc_commands
    client.done("s", "start", direction="cw", speed_rpm=1000.0, source="plc")
    client.done("s", "orient", position_deg=0.0, speed_rpm=0.0, direction="", source="plc")
    done = client.wait_last("s", lambda block: block.plc_acknowledged == before + 2, "two acknowledgements")
    assert done.in_position[-1] and done.plc_commands == before + 2


def test_coupling_by_service(client):
    answer = client.ask(srv.CoupleSpindle, "/t/couple", master="s", factor_num=1.0, factor_den=2.0)
    assert answer.accepted
    client.wait_last("t", lambda block: block.master == "s", "coupled")
    client.done("s", "start", direction="ccw", speed_rpm=400.0, source="")
    client.wait_last("t", lambda block: block.set_speed_rpm[-1] == -200.0, "half the speed")
    client.done("s", "stop", source="")
    client.wait_last("t", lambda block: block.set_speed_rpm[-1] == 0.0, "stopped with its master")
    client.done("t", "decouple")
    client.wait_last("t", lambda block: block.master == "", "free")


def test_an_override_that_falls_silent_stays_as_it_is(client):
    """One message is no rhythm: somebody has given an override by hand."""
    client.done("s", "start", direction="cw", speed_rpm=400.0, source="")
    client.override("t", 50.0)
    for _ in range(2):
        client.override("s", 50.0)
    client.spin_until(lambda: any(event.error_id == 26119 for event in client.events), "the event")
    client.wait_blocks("plc", 100)
    texts = [event.text for event in client.events if event.error_id == 26119]
    assert texts == ["plc: no message on /s/override for 1000 ms; the override is unchanged"]
    client.shows("s", "set_speed_rpm", 200.0)
    client.override("s", 100.0)
    client.shows("s", "set_speed_rpm", 400.0)
    client.override("t", 100.0)
    client.done("s", "stop", source="")


def test_function_blocks_of_a_spindle(client):
    """Rotation by one block, M19 by another, which aborts it."""

    def begin(name, **inputs):
        return client.action(action.FunctionBlock, "/s/function_block", function_block=name, **inputs)

    turn, told = begin("MC_MoveVelocity", velocity=-120.0)
    client.spin_until(lambda: any(message.feedback.in_velocity for message in told), "the speed")
    assert told[-1].feedback.set_velocity == -120.0
    orient, _ = begin("MC_OrientSpindle", position=90.0, direction="ccw")
    status, result = client.result_of(turn)
    assert (status, result.command_aborted) == (GoalStatus.STATUS_ABORTED, True)
    status, result = client.result_of(orient)
    assert (status, result.done) == (GoalStatus.STATUS_SUCCEEDED, True)
    refused, _ = begin("MC_MoveAbsolute", position=1.0)
    _, result = client.result_of(refused)
    assert result.error_id == 22002
    assert result.error_text.startswith(
        "spindle s: unknown function block 'MC_MoveAbsolute'; nothing was changed. Known: "
    )


def test_positioning_and_homing_as_actions(client):
    goal, _ = client.action(action.OrientSpindle, "/s/position", position_deg=222.0, speed_rpm=120.0, direction="cw")
    status, result = client.result_of(goal)
    assert (status, result.success, result.message) == (GoalStatus.STATUS_SUCCEEDED, True, "")
    assert result.position_deg % 360.0 == pytest.approx(222.0, abs=0.06)
    goal, _ = client.action(action.Home, "/t/homing")
    status, result = client.result_of(goal)
    assert (status, result.success) == (GoalStatus.STATUS_SUCCEEDED, True)
    assert client.wait_last("t", lambda block: True, "a block").referenced[-1]


def test_a_homing_that_is_overtaken_is_no_success(client):
    """The spindle has its reference point already."""
    goal, _ = client.action(action.Home, "/t/homing")
    client.done("t", "stop", source="")
    status, result = client.result_of(goal)
    assert (status, result.success) == (GoalStatus.STATUS_ABORTED, False)
    assert result.message == "the homing was aborted, the previous reference point remains valid"


def test_actions_wait_for_the_gear_and_a_cancel_forgets_them(client):
    gear = client.wait_last("s", lambda block: block.speed_zero[-1], "at rest").gear[-1]
    client.done("plc", "auto_acknowledge", enabled=False)
    goals = [
        (3 - gear, action.OrientSpindle, "/s/position", {"position_deg": 111.0, "speed_rpm": 120.0}),
        (gear, action.Home, "/s/homing", {}),
        (3 - gear, action.OrientSpindle, "/s/position", {"position_deg": 10.0, "speed_rpm": 120.0}),
    ]
    results = []
    for cancelled, (stage, kind, name, words) in enumerate(goals, start=-2):
        client.done("s", "select_gear", stage=stage, source="")
        client.wait_last("s", lambda block: block.gear_request, "the request")
        goal, _ = client.action(kind, name, **words)
        if not cancelled:
            goal.cancel_goal_async()
            results.append(client.result_of(goal))
        client.done("s", "gear_changed")
        if cancelled:
            results.append(client.result_of(goal))
    client.done("plc", "auto_acknowledge", enabled=True)
    statuses = [(status, result.success) for status, result in results]
    assert statuses == [(GoalStatus.STATUS_SUCCEEDED, True)] * 2 + [(GoalStatus.STATUS_CANCELED, False)]
    assert results[0][1].position_deg % 360.0 == pytest.approx(111.0, abs=0.06)
    end = client.wait_last("s", lambda block: block.gear[-1] == 3 - gear, "the gear")
    assert end.set_speed_rpm[-1] == 0.0 and not end.in_position[-1]


def test_a_cancelled_positioning_stops(client):
    goal, _ = client.action(action.OrientSpindle, "/s/position", position_deg=10.0, speed_rpm=1.0, direction="ccw")
    client.wait_last("s", lambda block: block.set_speed_rpm[-1] == -1.0, "1 rpm")
    goal.cancel_goal_async()
    status, result = client.result_of(goal)
    assert status == GoalStatus.STATUS_CANCELED and not result.success
    assert result.message.startswith("the positioning has ended at ")
    goal, _ = client.action(action.OrientSpindle, "/s/position", position_deg=10.0, speed_rpm=1e6)
    status, result = client.result_of(goal)
    assert (status, result.error_id) == (GoalStatus.STATUS_ABORTED, 24002)
