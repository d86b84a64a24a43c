"""All nodes of a machine in one process with one executor: the same nodes, topics and numbers as the graph."""

from __future__ import annotations

import time
from collections.abc import Callable

from rclpy.node import Node

from cnc_ptp.errors import CncError
from cnc_ptp.interrupt import EndRequest
from cnc_ptp.machine.job import read_file, read_job
from cnc_ptp.machine.wiring import PLC, unit_kinds
from cnc_ptp.nodes import process
from cnc_ptp.nodes.axis import AxisNode
from cnc_ptp.nodes.clock import ClockNode, cycles_of
from cnc_ptp.nodes.monitor import RunMonitor
from cnc_ptp.nodes.nc_channel import ChannelNode
from cnc_ptp.nodes.plc_bridge import PlcBridgeNode
from cnc_ptp.nodes.recorder import RecorderNode
from cnc_ptp.nodes.spindle import SpindleNode
from cnc_ptp.nodes.supervisor import STOP_TIMEOUT, Job, observers_of, only_run
from cnc_ptp.parameters import MachineParameters

UNIT_NODES = {"axis": AxisNode, "spindle": SpindleNode, "channel": ChannelNode}


def run_composed(
    machine: MachineParameters, job: Job, *, show: Callable[[RunMonitor], None]
) -> tuple[RunMonitor, list[str]]:
    """Runs the job in this process; `show` is called about 20 times a second. Returns what went wrong besides."""
    with only_run(job):
        return _run(machine, job, show)


def _run(machine: MachineParameters, job: Job, show: Callable[[RunMonitor], None]) -> tuple[RunMonitor, list[str]]:
    monitor = RunMonitor(machine)
    recorders = 1 if job.record else 0
    clock = ClockNode(
        machine, wait_for=observers_of(job), free_run=job.free_run, cycles=cycles_of(machine, job.duration)
    )
    nodes: list[Node] = [monitor, *unit_nodes(machine, job, recorders=recorders), clock]
    recorder = None
    if job.record:
        machine_yaml = read_file("machine file", job.machine)
        recorder = RecorderNode(machine, job.record, machine_yaml)
        nodes.append(recorder)
    next_show = 0.0

    def after() -> None:
        nonlocal next_show
        clock.advance()
        if time.monotonic() >= next_show:
            next_show = time.monotonic() + 0.05
            show(monitor)

    def done() -> bool:
        return clock.done and (recorder is None or recorder.settled)

    end = EndRequest()
    failures = []
    try:
        process.spin(nodes, done=lambda: done() or stopped(end, nodes), wait=clock.wait_time, after=after)
    except CncError as error:
        failures.append(f"{error}; the run ends")
    end.restore()
    if end.given:
        failures.append(end.text("everything was stopped on its ramps"))
    return monitor, failures


def stopped(end: EndRequest, nodes: list[Node]) -> bool:
    """After an interrupt: everything is stopped on its ramps first, at most for STOP_TIMEOUT."""
    if not end.given:
        return False
    if end.deadline == 0.0:
        for node in nodes:
            if isinstance(node, PlcBridgeNode):
                node.stop_all()
    return end.over(STOP_TIMEOUT)


def unit_nodes(machine: MachineParameters, job: Job, *, recorders: int) -> list[Node]:
    nodes: list[Node] = []
    for name, kind in unit_kinds(machine).items():
        if kind == PLC:
            entries = read_job(machine, program=job.program, scenario=job.scenario)
            idle_ends = job.duration is None
            nodes.append(PlcBridgeNode(machine, scenario=entries, end_when_idle=idle_ends, recorders=recorders))
        else:
            nodes.append(UNIT_NODES[kind](machine, name, recorders=recorders))
    return nodes
