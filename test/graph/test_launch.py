"""The launch file, against a stand-in of the launch API: launch_ros is not on the package registries.

What its Node action starts is: the executable in lib/cnc_ptp of the package's prefix, `arguments`, then always --ros-args,
`-r __node:=` and `-r __ns:=` if given, -p and --params-file, -r of remappings.
"""

import runpy
import signal
import subprocess
import sys
import time
import types
from pathlib import Path

import pytest
from ament_index_python.packages import get_package_prefix
from graph_support import MILL, ROOT, TIMEOUT, one_axis_machine, run, states_equal, verified

from cnc_ptp.errors import CncError
from cnc_ptp.recording.reader import read_recording

SCENARIO = "- {at: 0.0, to: x, do: move_absolute, target: 30.0, velocity: 100.0}\n"


class LaunchArguments(dict):
    """Values of LaunchConfigurations: the launch context."""


class LaunchConfiguration:
    def __init__(self, name):
        self.name = name

    def perform(self, context):
        return context[self.name]


class Action:
    """DeclareLaunchArgument, OpaqueFunction, Node, Shutdown: what they were made with."""

    def __init__(self, *arguments, **options):
        self.arguments, self.options = arguments, options


class Declared(Action):
    pass


class Node(Action):
    def command_line(self, *more):
        """As launch_ros.actions.Node builds it."""
        options = self.options
        assert set(options) <= {"package", "executable", "name", "namespace", "arguments", "output", "on_exit"}
        words = [Path(get_package_prefix(options["package"]), "lib", options["package"], options["executable"])]
        words += [*options["arguments"], "--ros-args"]
        words += ["-r", f"__node:={options['name']}"] if options.get("name") else []
        words += ["-r", f"__ns:=/{options['namespace'].strip('/')}"] if options.get("namespace") is not None else []
        return [str(word) for word in (*words, *more)]


class Shutdown(Action):
    pass


@pytest.fixture
def launched(monkeypatch):
    """The actions of the launch file for given launch arguments."""
    stand_in = {
        "launch": {"LaunchDescription": list},
        "launch.actions": {"DeclareLaunchArgument": Declared, "OpaqueFunction": Action, "Shutdown": Shutdown},
        "launch.substitutions": {"LaunchConfiguration": LaunchConfiguration},
        "launch_ros": {},
        "launch_ros.actions": {"Node": Node},
    }
    for name, content in stand_in.items():
        module = types.ModuleType(name)
        module.__dict__.update(content)
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setenv("AMENT_PREFIX_PATH", sys.prefix)

    def launch(**given):
        *declared, opaque = runpy.run_path(str(ROOT / "launch" / "machine.launch.py"))["generate_launch_description"]()
        context = {action.arguments[0]: action.options.get("default_value") for action in declared}
        assert given.keys() <= context.keys() and None not in {**context, **given}.values()
        return opaque.options["function"]({**context, **{name: str(value) for name, value in given.items()}})

    return launch


def test_one_process_starts_the_whole_machine(launched):
    (node,) = launched(machine=MILL, program="p.nc", scenario="s.yaml", duration="2", record="r.mcap", free_run="true")
    assert node.options["executable"] == "run" and isinstance(node.options["on_exit"], Shutdown)
    words = ["--program", "p.nc", "--scenario", "s.yaml", "--duration", "2", "--record", "r.mcap", "--free-run"]
    assert node.command_line()[1:] == [str(MILL), *words, "--ros-args"]
    (node,) = launched(machine=MILL, stay="true", state_rate="200")
    assert node.command_line()[1:] == [str(MILL), "--state-rate", "200", "--stay", "--ros-args"]
    (*_, plc, _clock) = launched(machine=MILL, stay="true", state_rate="200", separate="true")
    assert plc.command_line()[1:] == [str(MILL), "--stay", "--state-rate", "200.0", "--ros-args", "-r", "__node:=plc"]
    (node,) = launched(machine=MILL, composed="true")
    assert node.command_line()[1:] == [str(MILL), "--composed", "--ros-args"]
    with pytest.raises(ValueError) as refused:
        launched(machine=MILL, composed="true", separate="true")
    assert str(refused.value) == "separate:=true and composed:=true exclude each other; nothing was started"
    (node,) = launched(machine=MILL, namespace="cell")
    assert node.command_line()[1:] == [str(MILL), "--ros-args", "-r", "__ns:=/cell"]


def test_each_node_by_itself(launched, tmp_path):
    program = ROOT / "examples" / "bracket.nc"
    nodes = launched(machine=MILL, program=program, separate="true", record=tmp_path / "r.mcap", namespace="cell")
    lines = {node.options["name"]: node.command_line() for node in nodes}
    executables = {name: Path(words[0]).name for name, words in lines.items()}
    axes = dict.fromkeys("xyz", "axis")
    assert executables == {
        "recorder": "recorder", "channel": "nc_channel", **axes, "s": "spindle", "plc": "plc_bridge", "clock": "clock"
    }  # fmt: skip
    assert all(words[-4:] == ["-r", f"__node:={name}", "-r", "__ns:=/cell"] for name, words in lines.items())
    assert lines["x"][1:6] == [str(MILL), "x", "--recorders", "1", "--ros-args"]
    assert lines["clock"][1:5] == [str(MILL), "--wait-for", "recorder", "--ros-args"]
    assert lines["channel"][1:5] == [str(MILL), "channel", "--program", str(program)]
    ends = {node.options["name"]: node.options["on_exit"] for node in nodes}
    assert isinstance(ends.pop("clock"), Shutdown)
    refused = types.SimpleNamespace(process_name="axis-2", returncode=2)
    died = types.SimpleNamespace(process_name="axis-2", returncode=-9)
    for end in ends.values():
        assert end(refused, {}).options == {"reason": "axis-2 was refused"} and end(died, {}) is None


def test_options_of_the_recorder(launched, tmp_path):
    given = {
        "split": "10s",
        "compression": "lz4",
        "keep": "5",
        "snapshots": tmp_path,
        "record_when": "x.set_velocity > 1",
    }
    (node,) = launched(machine=MILL, record=tmp_path / "run", recorder="true", **given)
    words = node.command_line()[1:]
    assert words[-2:] == ["--recorder", "--ros-args"]
    for name, value in given.items():
        assert words[words.index(f"--{name.replace('_', '-')}") + 1] == str(value)
    recorder, *_ = launched(machine=MILL, record=tmp_path / "run", separate="true", **given)
    assert recorder.command_line()[1:-3] == [
        *(str(MILL), str(tmp_path / "run"), "--when", "x.set_velocity > 1", "--split", "10s", "--compression", "lz4"),
        *("--keep", "5.0", "--snapshots", str(tmp_path)),
    ]
    recorder, *_, clock = launched(machine=MILL, separate="true", recorder="true")
    assert recorder.command_line()[1:] == [str(MILL), "--ros-args", "-r", "__node:=recorder"]
    assert clock.command_line()[1:4] == [str(MILL), "--wait-for", "recorder"]
    with pytest.raises(CncError, match="P-ERR-26222 recorder options: snapshots needs keep"):
        launched(machine=MILL, separate="true", snapshots=tmp_path)


def test_bad_input_is_told_before_anything_starts(launched, tmp_path):
    machine = one_axis_machine(tmp_path)
    with pytest.raises(CncError, match="P-ERR-26110 scenario /no cannot be read"):
        launched(machine=machine, separate="true", scenario="/no")
    with pytest.raises(CncError, match=r"P-ERR-26117 recording \S+ would overwrite the machine file"):
        launched(machine=machine, separate="true", record=machine)


def test_the_nodes_run_as_launch_starts_them(launched, tmp_path):
    """With parameters as launch gives them to every node; the numbers are those of the offline run."""
    machine = one_axis_machine(tmp_path)
    (tmp_path / "move.yaml").write_text(SCENARIO)
    job = {"machine": machine, "scenario": tmp_path / "move.yaml", "duration": "0.8"}
    run("simulate", machine, "--scenario", job["scenario"], "--duration", "0.8", "--record", tmp_path / "a.mcap")
    actions = launched(**job, separate="true", record=tmp_path / "b.mcap", namespace="cell/left")
    parameters = ["-p", "use_sim_time:=false\n...\n", "--params-file", str(machine), "-r", "joint_states:=joints"]
    nodes = {
        action.options["name"]: subprocess.Popen(action.command_line(*parameters), stderr=subprocess.PIPE, text=True)
        for action in actions
    }
    clock = nodes.pop("clock")
    try:
        assert clock.wait(TIMEOUT) == 0, clock.stderr.read()
        for node in nodes.values():
            node.send_signal(signal.SIGINT)
        assert {node.wait(TIMEOUT) for node in nodes.values()} == {128 + signal.SIGINT}
        assert [node.stderr.read() for node in (*nodes.values(), clock)] == [""] * 4
    finally:
        for node in (*nodes.values(), clock):
            node.kill()
            node.wait()
            node.stderr.close()
    assert states_equal(tmp_path / "a.mcap", tmp_path / "b.mcap") == []
    assert verified(tmp_path / "b.mcap").last_cycle == 799


def test_run_as_launch_starts_it(launched, tmp_path):
    """The supervisor, ended as launch ends it: by SIGINT to its process."""
    machine = one_axis_machine(tmp_path)
    (action,) = launched(machine=machine, duration="600", record=tmp_path / "r.mcap", namespace="cell")
    words = action.command_line("--log-level", "warn")
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as graph:
        deadline = time.monotonic() + TIMEOUT
        while not (tmp_path / "r.mcap").exists() and time.monotonic() < deadline:
            time.sleep(0.1)
        graph.send_signal(signal.SIGINT)
        output, _ = graph.communicate(timeout=TIMEOUT)
    assert graph.returncode == 1 and "P-ERR-26106 the run was interrupted (SIGINT)" in output
    assert "lost 0, computed twice 0" in output
    assert "/x/state" in read_recording(tmp_path / "r.mcap").topics
