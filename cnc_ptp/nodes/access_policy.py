"""Access policy of a machine for SROS2: what each node may publish, subscribe to, answer, call.

`python -m cnc_ptp.nodes.access_policy MACHINE.yaml` prints it; tools/sros2/policy.xml is that of config/mill.yaml. It
is made from the wiring and the tables of topics.py, as docs/interfaces.md has them; a test compares it with nodes that
run. Each node is an enclave of its own, /cnc_ptp/<node>; people and programs that command the machine share
/cnc_ptp/client, and a PLC outside is /cnc_ptp/external_plc.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from xml.etree import ElementTree

from cnc_ptp.machine.wiring import unit_kinds, wiring
from cnc_ptp.nodes.observed_topics import observed_topics
from cnc_ptp.nodes.topics import (
    ACKNOWLEDGED,
    CHECKPOINTS,
    COMMAND,
    COUPLING_SERVICES,
    DIAGNOSTICS,
    DRIVE_STOPS,
    EMERGENCY_STOP_TOPIC,
    EVENT,
    HEARTBEAT,
    JOINT_STATES,
    LATENESS,
    LIFE_SIGN,
    MONITOR,
    PLC_TOPICS,
    RECORDER,
    RECORDER_SERVICES,
    REPORT,
    SERIES_SERVICES,
    SERVICES,
    STATE_TYPES,
    TICK,
    TRAJECTORY_ACTION,
    TRAJECTORY_TOPIC,
    block_topic,
    handshake_topic,
    hli_status_topic,
    jog_topic,
    offsets_topic,
    plc_topic,
    program_topic,
    state_topic,
)
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.unit import CLOCK, PLC

VERSION = "0.2.0"
"""Of the format of the policies."""
ROSOUT, PARAMETER_EVENTS = "/rosout", "/parameter_events"
CLIENT, EXTERNAL_PLC = "client", "external_plc"
PARAMETER_SERVICES = (
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "list_parameters",
    "set_parameters",
    "set_parameters_atomically",
)
ACTIONS = {"channel": ("run_program",), "axis": ("move",), "spindle": ("position", "homing"), "plc": ()}
"""Actions of a unit's own node, by kind."""
EMERGENCY_SERVICES = tuple(f"{EMERGENCY_STOP_TOPIC}/{name}" for name in ("press", "release", "reset"))


@dataclass
class NodeAccess:
    """What a node may do. Names as in topics.py, relative to the namespace; with / at their beginning absolute.

    publish, subscribe   topics
    reply, request       services that it has, and that it calls
    execute, call        actions that it has, and that it calls
    """

    name: str
    publish: set[str] = field(default_factory=set)
    subscribe: set[str] = field(default_factory=set)
    reply: set[str] = field(default_factory=set)
    request: set[str] = field(default_factory=set)
    execute: set[str] = field(default_factory=set)
    call: set[str] = field(default_factory=set)


def machine_access(machine: MachineParameters) -> list[NodeAccess]:
    """All nodes of a machine, and those who command it."""
    units = [unit_access(machine, unit) for unit in unit_kinds(machine)]
    run = [clock_access(machine), recorder_access(machine), monitor_access(machine)]
    return [*units, *run, client_access(machine, units), external_plc_access(machine)]


def unit_access(machine: MachineParameters, unit: str) -> NodeAccess:
    """The node of a unit; an axis or spindle may follow each other one (its master)."""
    kinds = unit_kinds(machine)
    kind, inputs = kinds[unit], wiring(machine)[unit]
    masters = [name for name, of in kinds.items() if {of, kind} <= {"axis", "spindle"} and name != unit]
    node = NodeAccess(
        unit,
        publish={block_topic(unit), CHECKPOINTS, EVENT, COMMAND, REPORT, HEARTBEAT, DIAGNOSTICS, LATENESS, ROSOUT},
        subscribe={HEARTBEAT, TICK, *map(block_topic, (*inputs.upstream, *inputs.feedback, *masters))},
        reply={f"{unit}/{command}" for command in SERVICES[kind]},
        execute={f"{unit}/{name}" for name in ACTIONS[kind]},
    )
    if kind in STATE_TYPES:
        node.publish.add(state_topic(unit))
    if kind in ("axis", "spindle"):
        node.subscribe.add(DRIVE_STOPS)
    if kind == "channel":
        node.publish |= {handshake_topic(unit), offsets_topic(unit), program_topic(unit)}
    if kind == "plc":
        add_interface(node, machine)
    return with_parameters(node)


def add_interface(node: NodeAccess, machine: MachineParameters) -> None:
    """What the PLC node is for external PLCs and clients."""
    kinds = {unit: kind for unit, kind in unit_kinds(machine).items() if kind != "plc"}
    node.publish |= {JOINT_STATES, f"{EMERGENCY_STOP_TOPIC}/active", *map(hli_status_topic, kinds)}
    node.subscribe |= {LIFE_SIGN, ACKNOWLEDGED, EMERGENCY_STOP_TOPIC, TRAJECTORY_TOPIC, EVENT, COMMAND}
    node.subscribe |= {plc_topic(unit, name) for unit, kind in kinds.items() for name in PLC_TOPICS[kind]}
    of_axes = [*COUPLING_SERVICES, *SERIES_SERVICES]
    node.reply |= {f"{axis}/{name}" for axis in machine.axes for name in of_axes} | {*EMERGENCY_SERVICES}
    node.execute |= {TRAJECTORY_ACTION, *(f"{unit}/function_block" for unit in (*machine.axes, *machine.spindles))}


def clock_access(machine: MachineParameters) -> NodeAccess:
    """With the watchdogs of the drives."""
    reads = {REPORT, HEARTBEAT, block_topic(PLC), *map(block_topic, (*machine.axes, *machine.spindles))}
    return with_parameters(NodeAccess(CLOCK, publish={TICK, HEARTBEAT, EVENT, DRIVE_STOPS, ROSOUT}, subscribe=reads))


def recorder_access(machine: MachineParameters) -> NodeAccess:
    """It reads everything that a recording has."""
    reads = {
        TICK,
        EVENT,
        COMMAND,
        CHECKPOINTS,
        DRIVE_STOPS,
        DIAGNOSTICS,
        LATENESS,
        ROSOUT,
        *(each.topic for each in observed_topics(machine)),
    }
    reads |= {block_topic(unit) for unit in unit_kinds(machine)}
    services = {f"{RECORDER}/{name}" for name in RECORDER_SERVICES}
    return with_parameters(NodeAccess(RECORDER, publish={REPORT, EVENT, ROSOUT}, subscribe=reads, reply=services))


def monitor_access(machine: MachineParameters) -> NodeAccess:
    """The supervisor: it watches the run, and stops it."""
    reads = {EVENT, COMMAND, DIAGNOSTICS, LATENESS, *map(block_topic, unit_kinds(machine))}
    says = {REPORT, EVENT, ROSOUT, PARAMETER_EVENTS}
    return NodeAccess(MONITOR, publish=says, subscribe=reads, request={f"{PLC}/stop_all"})


def client_access(machine: MachineParameters, units: Iterable[NodeAccess]) -> NodeAccess:
    """Command line, pages and Python clients: all services and actions, jogs, and what shows the machine."""
    kinds = unit_kinds(machine)
    reads = {EVENT, COMMAND, DIAGNOSTICS, *map(block_topic, kinds)}
    reads |= {
        topic(channel) for channel in machine.channels for topic in (program_topic, offsets_topic, handshake_topic)
    }
    nodes = [*units, recorder_access(machine)]
    return NodeAccess(
        CLIENT,
        publish={EVENT, ACKNOWLEDGED, PARAMETER_EVENTS, *map(jog_topic, machine.axes)},
        subscribe=reads,
        request={service for node in nodes for service in node.reply},
        call={name for node in nodes for name in node.execute},
    )


def external_plc_access(machine: MachineParameters) -> NodeAccess:
    """A PLC that writes the topics of the machine and reads its status."""
    kinds = {unit: kind for unit, kind in unit_kinds(machine).items() if kind != "plc"}
    writes = {plc_topic(unit, name) for unit, kind in kinds.items() for name in PLC_TOPICS[kind]}
    reads = {JOINT_STATES, EVENT, f"{EMERGENCY_STOP_TOPIC}/active", *map(hli_status_topic, kinds)}
    reads |= {handshake_topic(channel) for channel in machine.channels}
    return NodeAccess(
        EXTERNAL_PLC,
        publish=writes | {LIFE_SIGN, EMERGENCY_STOP_TOPIC, TRAJECTORY_TOPIC, ROSOUT, PARAMETER_EVENTS},
        subscribe=reads,
        request={*EMERGENCY_SERVICES, f"{PLC}/acknowledge"},
    )


def with_parameters(node: NodeAccess) -> NodeAccess:
    """The services and the topic that each node with parameters has."""
    node.publish.add(PARAMETER_EVENTS)
    node.reply |= {f"{node.name}/{name}" for name in PARAMETER_SERVICES}
    return node


def policy_text(machine: MachineParameters) -> str:
    """The policy as XML, for `ros2 security create_permission`."""
    root = ElementTree.Element("policy", version=VERSION)
    enclaves = ElementTree.SubElement(root, "enclaves")
    for node in machine_access(machine):
        enclave = ElementTree.SubElement(enclaves, "enclave", path=f"/cnc_ptp/{node.name}")
        profiles = ElementTree.SubElement(enclave, "profiles")
        profile = ElementTree.SubElement(profiles, "profile", ns="/", node=node.name)
        for group, of, expression, names in rules(node):
            rule = ElementTree.SubElement(profile, group, {expression: "ALLOW"})
            for name in sorted(names):
                ElementTree.SubElement(rule, of).text = name
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def rules(node: NodeAccess) -> Iterator[tuple[str, str, str, set[str]]]:
    """Group, element, expression and names of each rule that is not empty."""
    for row in (
        ("topics", "topic", "publish", node.publish),
        ("topics", "topic", "subscribe", node.subscribe),
        ("services", "service", "reply", node.reply),
        ("services", "service", "request", node.request),
        ("actions", "action", "execute", node.execute),
        ("actions", "action", "call", node.call),
    ):
        if row[-1]:
            yield row


if __name__ == "__main__":
    print(policy_text(read_machine(sys.argv[1])), end="")
