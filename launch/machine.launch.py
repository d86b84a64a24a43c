"""ros2 launch cnc_ptp machine.launch.py machine:=config/mill.yaml program:=examples/bracket.nc record:=runs/demo.mcap

One process that starts, watches and ends all nodes in order (`cnc_ptp run`), or with separate:=true each node as a Node
of its own: to be copied into other launch files, with the other nodes of the cell.
"""

from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchDescription

OPTIONS = {
    "program": "NC program for the first channel",
    "dialect": "vocabulary of the program: twincat or iso; default: that of the machine file",
    "scenario": "timed PLC commands (YAML)",
    "plc": "PLC in a file: Python with a class Plc",
    "duration": "seconds until the run ends; default: when everything is finished",
    "record": "MCAP recording to write",
    "record_when": "condition with which the recording begins: x.set_velocity != 0",
    "split": "record in parts of a size or a time, 500MB or 10min: the recording is a folder",
    "compression": "of the recording: zstd, lz4 or none; default: zstd",
    "keep": "seconds that are kept in memory: do recorder snapshot FILE",
    "snapshots": "folder for a snapshot at each error; with keep",
    "snapshot_when": "condition with which a snapshot is taken too: x.following_error > 0.1; with snapshots",
    "state_rate": "live states a second, 0 = none",
    "namespace": "ROS namespace of all nodes",
}
SWITCHES = {
    "free_run": "as fast as all nodes follow, instead of in real time",
    "composed": "all nodes in one process",
    "recorder": "a recorder that records on demand: do recorder start FILE",
    "stay": "continue when everything is at a standstill, for commands",
    "separate": "a Node action for every node, instead of one for cnc_ptp run",
}


def start(context):
    given = {name: LaunchConfiguration(name).perform(context) for name in ("machine", *OPTIONS, *SWITCHES)}
    switches = {name: given.pop(name).lower() in ("true", "1", "yes", "on") for name in SWITCHES}
    given = {name: value for name, value in given.items() if value}
    namespace = given.pop("namespace", None)
    if switches["separate"] and switches["composed"]:
        raise ValueError("separate:=true and composed:=true exclude each other; nothing was started")
    if switches["separate"]:
        return separate_nodes(given, switches, namespace)
    arguments = [given.pop("machine")]
    for option, value in given.items():
        arguments += [f"--{option.replace('_', '-')}", value]
    arguments += ["--composed"] if switches["composed"] else []
    arguments += ["--free-run"] if switches["free_run"] else []
    arguments += ["--recorder"] if switches["recorder"] else []
    arguments += ["--stay"] if switches["stay"] else []
    return [node("run", arguments, namespace=namespace, on_exit=Shutdown())]


def separate_nodes(given, switches, namespace):
    """The end of the clock ends the launch; the recorder, signalled to end, first takes the last messages."""
    from cnc_ptp.machine.plc_file import check_plc
    from cnc_ptp.machine.run_entries import read_entries
    from cnc_ptp.machine.runner import CLOCK
    from cnc_ptp.machine.wiring import unit_kinds
    from cnc_ptp.nodes.supervisor import RunOptions, command_lines
    from cnc_ptp.nodes.topics import RECORDER
    from cnc_ptp.parameters import read_machine
    from cnc_ptp.recording.overwriting import check_recording
    from cnc_ptp.recording.recorder_options import check_recorder

    recorder = recorder_options(given, switches["recorder"])
    duration = float(given.pop("duration")) if "duration" in given else None
    rate = float(given.pop("state_rate")) if "state_rate" in given else None
    options = RunOptions(
        **given,
        duration=duration,
        free_run=switches["free_run"],
        stay=switches["stay"],
        state_rate=rate,
        recorder=recorder,
    )
    inputs = {"NC_program": options.program, "scenario": options.scenario, "PLC_file": options.plc}
    check_recording(options.record, machine_file=options.machine, **inputs)
    machine = read_machine(options.machine)
    if recorder is not None:
        check_recorder(recorder, options.record, unit_kinds(machine))
    check_plc(machine, options.plc)
    read_entries(machine, program=options.program, scenario=options.scenario, dialect=options.dialect)
    observers = [RECORDER] if options.recording else []
    return [
        node(executable, arguments, name=name, namespace=namespace, on_exit=Shutdown() if name == CLOCK else refused)
        for name, (executable, *arguments) in command_lines(machine, options, observers)
    ]


def recorder_options(given, on_demand):
    """Takes those of the recorder out of the arguments; None without a recorder."""
    from cnc_ptp.recording.recorder_options import RecorderOptions

    names = {"when": "record_when"} | {name: name for name in ("split", "compression", "snapshots", "snapshot_when")}
    options = {option: given.pop(name) for option, name in names.items() if name in given}
    keep = float(given.pop("keep", 0.0))
    if "record" not in given and not on_demand and not keep and not options:
        return None
    return RecorderOptions(**options, keep=keep, scenario=given.get("scenario"), plc=given.get("plc"))


def refused(event, context):
    """A node that refuses to start (status 2) ends the launch: the others would wait. A later death they notice."""
    return Shutdown(reason=f"{event.process_name} was refused") if event.returncode == 2 else None


def node(executable, arguments, **options):
    return Node(package="cnc_ptp", executable=executable, arguments=arguments, output="screen", **options)


def generate_launch_description():
    declared = [DeclareLaunchArgument("machine", description="machine file (ROS parameters YAML)")]
    for name, text in OPTIONS.items():
        declared.append(DeclareLaunchArgument(name, default_value="", description=text))
    for name, text in SWITCHES.items():
        declared.append(DeclareLaunchArgument(name, default_value="false", description=text))
    return LaunchDescription([*declared, OpaqueFunction(function=start)])
