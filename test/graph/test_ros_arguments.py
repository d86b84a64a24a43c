"""ROS arguments of the node executables: what they do, and the exact text of what is refused."""

import sys
from pathlib import Path

import click
import pytest
import yaml
from graph_support import MILL, PTP, ROOT
from rclpy.node import Node
from rclpy.serialization import serialize_message
from ros_support import ros

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes import axis, clock, nc_channel, player, plc_bridge, recorder, spindle
from cnc_ptp.nodes.unit.parameters import declare_parameters, require_known_parameters
from cnc_ptp.nodes.unit.unit_node import MACHINE
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import CycleTick
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.writer import Recording
from cnc_ptp.ros_arguments import split

MACHINES = sorted([*ROOT.glob("config/*.yaml"), ROOT / "examples/spindles/gears.yaml"])
FROM_FILE = "in the machine file, from which all nodes and the recording take it"


@pytest.fixture
def refusal(monkeypatch, capsys):
    """The text with which a node ends at once, with exit status 2."""

    def call(module, *words):
        monkeypatch.setattr(sys, "argv", ["node", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            module.main()
        assert ended.value.code == 2
        return capsys.readouterr().err

    return call


@pytest.mark.parametrize(
    ("module", "words", "name"),
    [
        (axis, [PTP, "x"], "x"),
        (spindle, [MILL, "s"], "s"),
        (nc_channel, [MILL, "channel"], "channel"),
        (plc_bridge, [MILL], "plc"),
        (clock, [MILL], "clock"),
        (recorder, [MILL, "a.mcap"], "recorder"),
    ],
    ids=lambda value: value.__name__.rpartition(".")[2] if hasattr(value, "__name__") else "",
)
def test_nodes_keep_their_names(refusal, module, words, name):
    for rule in ("__node:=other", "__name:=other", f"{name}:__node:=other"):
        assert refusal(module, *words, "--ros-args", "-r", rule) == (
            f"P-ERR-26130 ROS argument '-r {rule}' is refused: the other nodes know this one as '{name}'; nothing was started\n"
        )


@pytest.mark.parametrize("module", [axis, clock, player])
def test_what_ros_does_not_know(refusal, module):
    text = refusal(module, "--ros-args", "--bar")
    assert text.startswith("P-ERR-26130 ROS argument '--bar' is refused: ROS does not know it, but -r, --remap, -p, ")


@pytest.mark.parametrize(
    ("module", "words", "text"),
    [
        (
            axis,
            ["-p", "foo:=1"],
            "x: parameter foo = 1 of the ROS arguments is refused: axis /x has no parameter 'foo'",
        ),
        (
            clock,
            ["-p", "foo:=y"],
            "clock: parameter foo = true of the ROS arguments is refused: the node has no such parameter",
        ),
        (
            axis,
            ["-p", "use_sim_time:=true"],
            "x: parameter use_sim_time = true of the ROS arguments is refused: the time of all nodes is that of their clock node",
        ),
    ],
)
def test_refused_parameters(refusal, module, words, text):
    own = [PTP, "x"] if module is axis else [PTP]
    assert refusal(module, *own, "--ros-args", *words) == f"P-ERR-26130 {text}; the node does not start\n"


@pytest.mark.parametrize(
    ("parameters", "name", "reason"),
    [
        ({"getriebe": {"0": {"kv": 5001}}}, "getriebe.0.kv = 5001", f"it is 5000 {FROM_FILE}"),
        ({"getriebe[0].kv": 4999}, "getriebe[0].kv = 4999", f"it is 5000 {FROM_FILE}"),
        (
            {"getriebe": {"0": {"kv": -1}}},
            "getriebe.0.kv = -1",
            "axis list, P-AXIS-00099 getriebe[0].kv of /x: value -1 is not above 0 (0.01/s)",
        ),
        (
            {"getriebe": {"3": {"kv": 5000}}},
            "getriebe.3.kv = 5000",
            "it is not in the machine file, from which all nodes and the recording take it",
        ),
        ({"kenngr": {"achs_typ": 2}}, "kenngr.achs_typ = 2", f"it is 'ACHSTYP_TRANSLATOR' {FROM_FILE}"),
    ],
)
def test_other_values_than_those_of_the_machine_file(refusal, tmp_path, parameters, name, reason):
    """As launch hands on the parameters of a Node: a file for it alone."""
    file = tmp_path / "launch_params_x"
    file.write_text(yaml.dump({"/cell/x": {"ros__parameters": parameters}}))
    words = ["--ros-args", "-r", "__node:=x", "-r", "__ns:=/cell", "--params-file", file]
    text = f"x: parameter {name} of the ROS arguments is refused: {reason}; the node does not start"
    assert refusal(axis, MILL, "x", *words) == f"P-ERR-26130 {text}\n"


def test_bare_words_that_ros_takes_for_booleans(refusal, tmp_path):
    file = tmp_path / "bare.yaml"
    file.write_text("/channel:\n  ros__parameters:\n    gruppe: {'0': {achse: {'1': {bezeichnung: Y}}}}\n")
    assert refusal(nc_channel, MILL, "channel", "--ros-args", "--params-file", file) == (
        "P-ERR-26130 channel: parameter gruppe.0.achse.1.bezeichnung = true of the ROS arguments is refused: "
        "channel list, P-CHAN-00006 gruppe[0].achse[1].bezeichnung of /channel: value true is a boolean, text is needed "
        "(ROS takes y, n, yes, no, on, off without quotes for true and false); the node does not start\n"
    )
    file.write_text("/machine:\n  ros__parameters:\n    axes: [x, y]\n")
    text = refusal(axis, MILL, "x", "--ros-args", "--params-file", file)
    assert text == (
        f"P-ERR-26108 ROS does not start: failed to initialize rcl: Couldn't parse params file: '--params-file {file}'. Error: "
        "Sequence should be of same type. Value type 'bool' do not belong at line_num 3 "
        "(ROS takes y, n, yes, no, on, off without quotes for true and false); nothing was started\n"
    )


@pytest.mark.parametrize(
    ("words", "reason", "hint"),
    [
        (["-r", "__ns:=cell"], "remap rule: '-r __ns:=cell'", " (a namespace begins with /)"),
        (["-r", "foo"], "remap rule: '-r foo'", ""),
        (["--log-level", "loud"], "log level: '--log-level loud'", ""),
        (["--params-file", "/no"], "params file: '--params-file /no'", ""),
        (
            ["-p", "getriebe.0.kv:=5000"],
            "parameter override rule: '-p getriebe.0.kv:=5000'",
            " (a name with a number in it, like getriebe.0.kv, goes into a --params-file only)",
        ),
    ],
)
def test_what_ros_cannot_read(refusal, words, reason, hint):
    text = refusal(axis, PTP, "x", "--ros-args", *words)
    assert text.startswith(
        f"P-ERR-26108 ROS does not start: failed to initialize rcl: Couldn't parse {reason}. Error: "
    )
    assert text.endswith(f"{hint}; nothing was started\n")


@pytest.mark.parametrize("path", MACHINES, ids=lambda path: path.stem)
def test_a_machine_file_is_a_parameters_file(path):
    """ROS reads from it what our reader reads: every node of the machine starts with its own file."""
    machine = read_machine(path)
    for name, given in overrides_of(path, unit_kinds(machine), machine):
        own = MACHINE if name == PLC else name
        assert given >= {entry.name for entry in sections(path).get(own, [])}


def overrides_of(path, units, machine):
    """Name of each node, and the parameters that ROS has given it, after they were compared with the machine."""
    with click.Context(click.Command("node"), obj=split(["--ros-args", "--params-file", str(path)])[1]).scope(), ros():
        for name in units:
            own = MACHINE if name == PLC else name
            node = Node(own, enable_rosout=False, start_parameter_services=False)
            declare_parameters(node, machine, own)
            yield name, {*node._parameter_overrides}
            node.destroy_node()


def sections(path):
    from cnc_ptp.parameters.read.source import read_sections

    return {section.node: section.entries for section in read_sections(Path(path).read_text(), str(path))[0]}


def test_remaps_logs_and_namespace_take_effect():
    words = [
        "-r",
        "__ns:=/cell",
        "-r",
        "events:=/robot/events",
        "--log-level",
        "cell.x:=error",
        "--enable-rosout-logs",
    ]
    with click.Context(click.Command("node"), obj=split(["--ros-args", *words])[1]).scope(), ros():
        node = axis.AxisNode(read_machine(PTP), "x")
        node.setup()
        topics = {publisher.topic_name for publisher in node.publishers}
        services = {service.service_name for service in node.services}
        level = node.get_logger().get_effective_level()
        node.destroy_node()
    assert {"/cell/x/block", "/cell/commands", "/cell/diagnostics", "/robot/events"} <= topics
    assert {"/cell/x/move_absolute", "/cell/x/get_parameters"} <= services
    assert {name for name in topics | services if not name.startswith("/cell/")} <= {
        "/robot/events",
        "/parameter_events",
        "/rosout",
    }
    assert level.name == "ERROR"


def test_other_machine_values_raise_by_name():
    """The refusal is an error of the node, not of its process: composed nodes have it as well."""
    context = click.Context(click.Command("node"), obj=split(["--ros-args", "-p", "a:=1"])[1])
    refused = pytest.raises(CncError, match="x: parameter a = 1 of the ROS arguments is refused")
    with context.scope(), ros(), refused:
        require_known_parameters(Node("x", enable_rosout=False))


def test_a_published_recording_leaves_plc_inputs_out(tmp_path):
    """The jog of a recording would move a machine elsewhere."""
    path = tmp_path / "a.mcap"
    with Recording(str(path), PTP.read_text(), 0, 1_000_000) as recording:
        recording.tick(CycleTick(0, 10))
        recording.raw("/x/jog", "cnc_ptp/msg/Jog", serialize_message(msg.Jog()), 0)
    with ros():
        for inputs, left_out in ((False, ["/x/jog"]), (True, [])):
            node = player.PlayerNode(str(path), rate=1.0, inputs=inputs)
            assert node.inputs_left_out == left_out
            assert ("/x/jog" in {publisher.topic_name for publisher in node.publishers}) is inputs
            text = "; 1 topics of PLC inputs are left out (--inputs publishes them)"
            assert player._left_out(node) == ("" if inputs else text)
            node.destroy_node()
