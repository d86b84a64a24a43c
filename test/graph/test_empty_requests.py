"""`ros2 service call … '{}'`: what is left out moves nothing and releases nothing."""

import pytest
from graph_support import MILL, PTP
from rclpy.serialization import serialize_message
from ros_support import ros

from cnc_ptp import action, msg, srv
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes.bridge.function_blocks import given_inputs
from cnc_ptp.nodes.plc_bridge import PlcBridgeNode
from cnc_ptp.nodes.topics import COUPLING_SERVICES, HLI_CONTROL, SERVICES
from cnc_ptp.nodes.unit.requests import given_arguments, objection
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import Command, CycleTick
from cnc_ptp.protocol.commands import COMMANDS

UNITS = {"axis": (PTP, "y"), "spindle": (MILL, "s"), "channel": (MILL, "channel"), "plc": (MILL, "plc")}
ALL = {kind: services | (COUPLING_SERVICES if kind == "axis" else {}) for kind, services in SERVICES.items()}
NO_AXIS = "there is no axis ''. Known: x, z, c"
NO_DRIVE = "the axis has no SERCOS drive (P-AXIS-00020), which has such parameters"
NO_SLAVE = "the axis is not coupled (it is in Standstill)"
REFUSED = {
    ("axis", "move_absolute"): "argument 'target' is missing",
    ("axis", "move_relative"): "argument 'distance' is missing",
    ("axis", "move_modulo"): "argument 'position' is missing",
    ("axis", "move_additive"): "argument 'distance' is missing",
    ("axis", "move_velocity"): "argument 'velocity' is missing",
    ("axis", "move_superimposed"): "argument 'distance' is missing",
    ("axis", "set_position"): "argument 'position' is missing",
    ("axis", "set_override_type"): "type = 0 is not one of 1, 2, 3, 4",
    ("axis", "new_target"): "argument 'target' is missing",
    ("axis", "new_velocity_and_target"): "argument 'target' is missing",
    ("axis", "compensation_start"): "no basic motion is active (the axis is in Standstill)",
    ("axis", "write_parameter"): "argument 'value' is missing",
    ("axis", "external_enable"): "mode = '' is not absolute or relative",
    ("axis", "set_coupling_factor"): "argument 'factor' is missing",
    ("axis", "set_cyclic_factor"): "argument 'factor' is missing",
    ("axis", "decouple"): NO_SLAVE,
    ("axis", "read_drive_parameter"): NO_DRIVE,
    ("axis", "write_drive_parameter"): NO_DRIVE,
    ("axis", "couple"): NO_AXIS,
    ("axis", "couple_gantry"): NO_AXIS,
    ("axis", "couple_cyclic"): NO_AXIS,
    ("axis", "couple_flying_saw"): "argument 'master_position' is missing",
    ("axis", "couple_cam"): "argument 'table' is missing",
    ("axis", "change_cam"): "argument 'table' is missing",
    ("spindle", "start"): "direction = '' is not cw or ccw",
    ("spindle", "set_speed"): "argument 'speed_rpm' is missing",
    ("spindle", "orient"): "argument 'position_deg' is missing",
    ("spindle", "select_gear"): "gear 0 has no record getriebe[i]; known are: 1",
    ("spindle", "gear_changed"): "no gear change waits for its acknowledgement",
    ("spindle", "set_limits"): "nothing is given; reset_limits takes the limits away",
    ("spindle", "couple"): "'' is not a spindle of the machine (s)",
    ("spindle", "decouple"): "the spindle is not coupled",
    ("channel", "load"): "no text came with program ''",
    ("channel", "start"): "no program is loaded",
    ("channel", "set_zero_offset"): "argument 'value' is missing",
    ("channel", "teach_zero_offset"): "index = 0 is not within 1 ... 96; G53 selects no offset (P-ZERO-00001)",
    ("channel", "set_clamp_position"): "index = 4294967295 is not within 0 ... 149",
    ("plc", "set_input"): "argument 'value' is missing",
    ("plc", "follow_trajectory"): "axes is empty; known are: x, y, z",
    ("channel", "acknowledge"): "no request 0 waits (waiting: none)",
    ("channel", "measuring_event"): "nothing in the running block waits for one",
}
"""Reasons, in a unit at a standstill."""
WHOLE_TEXT = {
    ("channel", "mdi"): "mdi line 1 column 1 '': no main program; nothing was executed",
    ("plc", "acknowledge"): "plc plc: acknowledge refused: no request 0 waits; nothing was changed. Waiting: none",
}
MEANT = {
    "axis": {
        "power", "reset", "set_override", "stop", "halt", "home", "emergency_stop", "compensation_stop",
        "halt_superimposed", "external_disable", "set_feedforward", "reset_feedforward", "set_friction_compensation",
        "set_feed_release", "feed_hold", "hold_stop",
    },
    "spindle": {
        "power", "stop", "home", "set_override", "suppress_override", "reset_limits", "stop_at_program_end", "reset",
        "set_feedforward", "reset_feedforward", "feed_hold", "hold_stop",
    },
    "channel": {"feed_hold", "set_override", "single_block", "optional_stop", "block_skip", "reset"},
    "plc": {"auto_acknowledge", "set_life_sign", "emergency_stop", "reset", "stop_all"},
}  # fmt: skip
"""Accepted: their names say all, or what is left out holds back or switches off."""


def answer(kind, command):
    """The unit, and what it says to an empty request: the way through UnitNode._on_service."""
    path, name = UNITS[kind]
    unit, known, request = build_unit(read_machine(path), name), COMMANDS[kind][command], ALL[kind][command].Request()
    if reason := objection(command, known, request):
        return unit, False, f"{kind} {name}: {command} refused: {reason}; nothing was changed"
    record = unit.command(Command(name, command, given_arguments(known, request)), 0)
    return unit, record.accepted, record.message


@pytest.mark.parametrize(("kind", "command"), [(kind, command) for kind, known in ALL.items() for command in known])
def test_an_empty_request(kind, command):
    unit, accepted, message = answer(kind, command)
    assert accepted == (command in MEANT[kind])
    if not accepted:
        reason = REFUSED.get((kind, command))
        text = f"{kind} {unit.name}: {command} refused: {reason}; nothing was changed" if reason else None
        assert message == (text or WHOLE_TEXT[kind, command])
    if kind in ("axis", "spindle") and command != "home":
        positions = "set_position" if kind == "axis" else "set_position_deg"
        blocks = [unit.step(CycleTick(10 * number, 10), {}) for number in range(20)]
        assert {position for block in blocks for position in getattr(block, positions)} == {0.0}


@pytest.mark.parametrize(
    ("command", "given", "understood"),
    [
        ("couple_flying_saw", {"master": "x", "factor": 1.0}, {"master": "x", "factor": 1.0}),
        (
            "couple_flying_saw",
            {"master": "x", "factor": 1.0, "master_position": 0.0, "slave_position": 5.0},
            {"master": "x", "factor": 1.0, "master_position": 0.0, "slave_position": 5.0},
        ),
        ("couple_cam", {"master": "x"}, {"master": "x", "cyclic": False, "master_offset": 0.0}),
        (
            "couple_cam",
            {"master": "x", "slave_offset": 0.0, "slave_scaling": 2.0},
            {"master": "x", "cyclic": False, "master_offset": 0.0, "slave_offset": 0.0, "slave_scaling": 2.0},
        ),
        ("move_absolute", {"target": 5.0}, {"target": 5.0}),
        ("move_absolute", {"target": 5.0, "buffer_mode": "buffered"}, {"target": 5.0, "buffer_mode": "buffered"}),
        ("move_superimposed", {"distance": 5.0}, {"distance": 5.0}),
        ("set_position", {"position": 0.0}, {"position": 0.0, "relative": False}),
        ("external_enable", {"mode": "absolute"}, {"mode": "absolute"}),
        ("external_enable", {"mode": "absolute", "target": 0.0}, {"mode": "absolute", "target": 0.0}),
        ("set_cyclic_factor", {"factor": 0.0}, {"factor": 0.0}),
        ("new_velocity_and_target", {"velocity": 5.0, "target": 9.0}, {"velocity": 5.0, "target": 9.0}),
    ],
)
def test_only_what_is_given_counts(command, given, understood):
    assert given_arguments(COMMANDS["axis"][command], ALL["axis"][command].Request(**given)) == understood


def test_what_is_given_counts_for_spindles():
    known = COMMANDS["spindle"]
    assert given_arguments(known["couple"], srv.CoupleSpindle.Request(master="t")) == {"master": "t"}
    assert given_arguments(known["set_speed"], srv.SetSpeed.Request(speed_rpm=0.0)) == {"speed_rpm": 0.0}
    limits = srv.SetSpindleLimits.Request(max_speed_rpm=300.0)
    assert objection("set_limits", known["set_limits"], limits) == ""
    assert given_arguments(known["set_limits"], limits) == {"max_speed_rpm": 300.0}


@pytest.mark.parametrize(
    ("goal", "kind", "command"),
    [(action.MoveAxis, "axis", "move_absolute"), (action.OrientSpindle, "spindle", "orient")],
)
def test_an_empty_goal_has_no_target(goal, kind, command):
    assert given_arguments(COMMANDS[kind][command], goal.Goal()) == {}


def test_an_empty_goal_has_no_inputs_of_a_function_block():
    assert given_inputs(action.FunctionBlock.Goal(), "") == {}


@pytest.mark.parametrize(
    "message", [msg.Switch, msg.Override, msg.CyclicCouplingFactor, msg.ExternalSetpoint, *HLI_CONTROL.values()]
)
def test_an_empty_message_is_not_valid(message):
    assert message().valid is False


@pytest.fixture(scope="module")
def bridge():
    with ros():
        node = PlcBridgeNode(read_machine(MILL))
        node.setup()
        yield node
        node.destroy_node()


@pytest.mark.parametrize(
    ("topic", "served", "released"),
    [
        ("/channel/override", msg.Override(valid=True, percent=0.0), ("set_override", {"percent": 100.0})),
        ("/channel/feed_hold", msg.Switch(valid=True, enabled=True), ("feed_hold", {"enabled": False})),
        ("/x/enable", msg.Switch(valid=True, enabled=False), ("power", {"enabled": True})),
        ("/s/enable", msg.Switch(valid=True, enabled=False), ("power", {"enabled": True})),
        (
            "/x/hli/control",
            msg.AxisHliControl(valid=True, feed_hold=msg.HliSwitch(enable_w=True, command_w=True)),
            ("overlay", {"control_unit": "feed_hold", "enabled": False}),
        ),
    ],
)
def test_an_empty_message_gives_back_only_what_was_served(bridge, topic, served, released):
    (received,) = [take for each, take in bridge._inputs_polled.items() if each.topic_name == topic]

    def heard(message):
        received(serialize_message(message))
        return [(each.command, each.arguments) for each in bridge.unit.step(CycleTick(0, 10), {}).commands]

    assert heard(type(served)()) == []
    ((command, arguments),) = heard(served)
    assert command == released[0] and arguments != released[1]
    assert heard(type(served)()) == [released]
