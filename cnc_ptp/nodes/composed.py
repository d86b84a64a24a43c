"""All nodes of a machine in one process with one executor: the same nodes, topics and numbers as the graph."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from typing import Any

from rclpy.node import Node

from cnc_ptp.errors import CncError
from cnc_ptp.interrupt import EndRequest
from cnc_ptp.machine.plc_file import read_plc
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes import process
from cnc_ptp.nodes.axis import AxisNode
from cnc_ptp.nodes.clock import ClockNode, cycles_of
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.monitor import RunMonitor
from cnc_ptp.nodes.nc_channel import ChannelNode
from cnc_ptp.nodes.plc_bridge import PlcBridgeNode
from cnc_ptp.nodes.recorder import RecorderNode
from cnc_ptp.nodes.spindle import SpindleNode
from cnc_ptp.nodes.supervisor import STOP_TIMEOUT, RunOptions, close_recordings, observers_of, only_run
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.parameters import MachineParameters, machine_text
from cnc_ptp.protocol.unit import PLC

UNIT_NODES = {"axis": AxisNode, "spindle": SpindleNode, "channel": ChannelNode}


def run_composed(
    machine: MachineParameters, options: RunOptions, *, show: Callable[[RunMonitor], None], watched: bool = False
) -> tuple[RunMonitor, list[str]]:
    """Runs the graph in this process; `show` is called about 20 times per second; `watched`: units are shown.

    Returns what went wrong outside the units.
    """
    with only_run(options):
        return _run(machine, options, show, watched)


def _run(
    machine: MachineParameters, options: RunOptions, show: Callable[[RunMonitor], None], watched: bool = False
) -> tuple[RunMonitor, list[str]]:
    handover = Handover()
    monitor = RunMonitor(machine, handover=handover)
    if watched or options.stay:
        monitor.watch_units()
    recorder = None
    if options.recording:  # before the units: it takes each block first
        recorder = RecorderNode(
            machine,
            options.record,
            machine_text(options.machine),
            options=options.recording,
            foxglove=options.foxglove,
            handover=handover,
        )
    clock = ClockNode(
        machine,
        wait_for=observers_of(options),
        free_run=options.free_run,
        cycles=cycles_of(machine, options.duration),
        handover=handover,
    )
    nodes: list[Node] = [
        monitor,
        *unit_nodes(
            machine, options, state_rate=options.state_rate, checkpoints=options.checkpoints, handover=handover
        ),
        clock,
    ]
    if recorder is not None:
        nodes.append(recorder)
    next_show = 0.0

    def after() -> None:
        nonlocal next_show
        clock.advance()
        monitor.take_polled()
        if time.monotonic() >= next_show:
            next_show = time.monotonic() + 0.05
            show(monitor)

    def done() -> bool:
        return clock.done and (recorder is None or recorder.settled)

    def note_ending() -> None:
        name = signal.Signals(end.number).name
        if not (options.stay and monitor.note_ending(name)):
            failures.append(end.text("everything was stopped on its ramps"))

    failures: list[str] = []
    raised: CncError | None = None
    with EndRequest() as end:
        try:
            process.spin(
                nodes, done=lambda: done() or stopped(end, nodes, note=note_ending), wait=clock.wait_time, after=after
            )
        except CncError as error:
            raised = error
            failures.append(str(error) if clock.done else f"{error}; the run ends")
        if recorder is not None:
            failures += close_after_failure(recorder, raised, options, monitor)
    return monitor, failures


def close_after_failure(
    recorder: RecorderNode, raised: CncError | None, options: RunOptions, monitor: RunMonitor
) -> list[str]:
    """Closes what a recorder that has failed has begun; its error, unless that was `raised`, and what follows it."""
    if recorder.failure is None:
        return []
    told = [] if recorder.failure is raised else [str(recorder.failure)]
    return told + (close_recordings(options, monitor) if recorder.has_begun else [])


def stopped(end: EndRequest, nodes: list[Node], *, note: Callable[[], None]) -> bool:
    """After an interrupt, reported once (`note`): everything stops on its ramps, at most for STOP_TIMEOUT."""
    if not end.given:
        return False
    if end.deadline == 0.0:
        note()
        for node in nodes:
            if isinstance(node, PlcBridgeNode):
                node.stop_all()
    return end.over(STOP_TIMEOUT)


def unit_nodes(machine: MachineParameters, options: RunOptions, **of_nodes: Any) -> list[UnitNode]:
    nodes: list[UnitNode] = []
    for name, kind in unit_kinds(machine).items():
        if kind == PLC:
            program, scenario, dialect, begin = options.program, options.scenario, options.dialect, options.begin
            entries = read_entries(machine, program=program, scenario=scenario, dialect=dialect, begin=begin)
            idle_ends = options.duration is None and not options.stay
            file = None if options.plc is None else read_plc(options.plc)
            nodes.append(PlcBridgeNode(machine, scenario=entries, plc_file=file, end_when_idle=idle_ends, **of_nodes))
        else:
            nodes.append(UNIT_NODES[kind](machine, name, **of_nodes))
        nodes[-1].setup()
    return nodes
