"""What comes to running nodes: messages on each topic that they read, requests of services, goals of actions."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from rclpy.serialization import deserialize_message, serialize_message

from bench.fuzzing.engine import Draw, Target
from bench.fuzzing.fields import Texts, filled
from bench.fuzzing.graph import ACTION, SERVICE, TOPIC, Graph, Input
from bench.fuzzing.mutation import mutated_bytes
from bench.fuzzing.texts import CAM, CURVE
from bench.jobs import ROOT
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes.topics import RECORDER
from cnc_ptp.parameters import MachineParameters, read_machine, ros_descriptors
from cnc_ptp.plc.plcopen.catalogue import BLOCK_TYPES
from cnc_ptp.protocol.commands import COMMANDS
from cnc_ptp.recording.origin import origin

MACHINE = ROOT / "config" / "mill.yaml"
LASTS = 500
"""Inputs of a graph, then it is made anew."""
FREED = 12
"""One input in so many is followed by somebody who sets the machine free: most others stop it."""
PROGRAM = "N10 M03 S500\nN20 G01 X10 F1000\nN30 G04 X1\nM30\n"
PROGRAMS = (PROGRAM, "G1 X10 F500\nM30", "M3 S500\nG4 X1\nM30", "G0 Y5", "$IF", "", "G1 X1e9", "L sub.nc\nM30")
READ = ("part.nc", "cam.csv", "curve.csv", "none.nc", "", ".", "sub", "x" * 5000, "part.nc/x")
WRITTEN = ("a.mcap", "b.mcap", "no/c.mcap", "part.nc", "", ".", "x" * 5000 + ".mcap", "d")


class Arrival(NamedTuple):
    """Something for a door; `blocks` are computed then."""

    door: tuple[str, str, str]
    data: bytes
    blocks: int
    then_free: bool
    cancelled: bool = False


def texts_of(machine: MachineParameters) -> Texts:
    """What text fields are given, by name."""
    kinds = unit_kinds(machine)
    known = {
        name: argument.choices
        for commands in COMMANDS.values()
        for arguments in commands.values()
        for name, argument in arguments.items()
        if argument.choices
    }
    units = (*kinds, "clock", RECORDER, "", "q")
    parameters = [each.ros_name for unit in machine.sets for each in ros_descriptors(machine.raw(unit))]
    return {
        **known,
        **dict.fromkeys(("unit", "source", "master", "axis", "owner", "spindle", "target"), units),
        **dict.fromkeys(("joint_names", "axes"), (*machine.axes, *machine.axes, *machine.spindles, "q")),
        **dict.fromkeys(("text", "file_texts"), PROGRAMS),
        **dict.fromkeys(("program", "file", "file_names", "in_program"), READ),
        **dict.fromkeys(("name", "names", "parameter", "prefixes"), (*parameters, "use_sim_time", "S-0-0047", "")),
        "frame_id": ("plc", "plc", "", "other", "x" * 300),
        "function_block": (*{name for of_kind in BLOCK_TYPES.values() for name in of_kind}, "MC_Nothing", ""),
        "string_value": ("x", "", "x" * 300),
    }


class Doors:
    """A graph that lives for LASTS inputs, or until its run is over."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        (folder / "part.nc").write_text(PROGRAM)
        (folder / "cam.csv").write_text(CAM)
        (folder / "curve.csv").write_text(CURVE)
        origin()  # asks other programs, once
        self.graph = Graph(MACHINE, folder)
        self._kept = {*folder.iterdir()}
        self.texts = texts_of(read_machine(str(MACHINE)))

    def renew(self) -> None:
        self.graph.close()
        for path in {*self._folder.iterdir()} - self._kept:
            path.unlink()
        self.graph = Graph(MACHINE, self._folder)

    def of(self, kind: str) -> list[Input]:
        """In order."""
        return sorted((each for each in self.graph.inputs.values() if each.kind == kind), key=lambda each: each.key)

    def texts_for(self, door: Input) -> Texts:
        """The recorder writes files, all others read them."""
        return {**self.texts, "file": WRITTEN} if door.node == RECORDER else self.texts


def topics(folder: Path) -> Target:
    """Messages, and bytes that are none where a node takes bytes: others are refused below it."""
    return through(folder, TOPIC)


def services(folder: Path) -> Target:
    return through(folder, SERVICE)


def goals(folder: Path) -> Target:
    """A third is cancelled at once."""
    return through(folder, ACTION)


def through(folder: Path, kind: str) -> Target:
    """Of all doors of a kind alike."""
    doors = Doors(folder)
    choices = doors.of(kind)

    def make(draw: Draw) -> Arrival:
        door = draw.choice(choices)
        message = filled(sent_by(door)(), draw, doors.texts_for(door))
        data = bytes(serialize_message(message))
        if door.raw and draw.random() < 0.4:
            data = mutated_bytes(data, draw)
        blocks = draw.choice((0, 0, 1, 1, 5))
        return Arrival(door.key, data, blocks, draw.number % FREED == 0, cancelled=draw.random() < 0.3)

    def call(given: Arrival) -> None:
        if doors.graph.over:
            doors.renew()
        graph = doors.graph
        door = graph.inputs[given.door]
        answered = None
        if kind == TOPIC:
            graph.message(door, given.data if door.raw else deserialize_message(given.data, door.type))
        elif kind == SERVICE:
            answered = graph.call(door, deserialize_message(given.data, sent_by(door)))
        else:
            goal = graph.goal(door, deserialize_message(given.data, sent_by(door)), cancelled=given.cancelled)
            answered = goal and goal.result
        for _ in range(given.blocks):
            graph.tick()
        graph.check()
        if given.then_free:
            graph.set_free()
        if error_id := getattr(answered, "error_id", 0):
            texts = [getattr(answered, name, "") for name in ("message", "error_text", "error_string")]
            raise CncError(error_id, "".join(texts))

    return Target(make, call, close=lambda: doors.graph.close(), renew=doors.renew, lasts=LASTS)


def sent_by(door: Input) -> Any:
    """The class of what comes."""
    if door.kind == SERVICE:
        return door.type.Request
    return door.type.Goal if door.kind == ACTION else door.type
