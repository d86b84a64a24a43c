"""`cnc_ptp run`: the ROS graph, until the run has ended."""

from __future__ import annotations

from socket import socket

from rich.console import Console

from cnc_ptp import KERNEL
from cnc_ptp.channel.program_report import cut_off_notes, time_lines
from cnc_ptp.commands.console import RUN_FAILED, print_faults, print_missing_folders, print_note_of_idle_run
from cnc_ptp.commands.run.beside_run import WebBesideRun
from cnc_ptp.commands.run.progress import RunProgress
from cnc_ptp.machine.plc_file import check_plc
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nc.block_search import StartPoint
from cnc_ptp.nodes.composed import run_composed
from cnc_ptp.nodes.monitor import RunMonitor
from cnc_ptp.nodes.supervisor import RunOptions, Supervisor
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.recording.node_figures import BLOCKS, CAME_TWICE, LOST_BLOCKS, following_error
from cnc_ptp.recording.on_demand import ENDED_EARLY
from cnc_ptp.recording.overwriting import check_recording
from cnc_ptp.recording.recorder_options import RecorderOptions
from cnc_ptp.state.machine_state import CHECKPOINT_SECONDS
from cnc_ptp.web.options import WebOptions


def run(
    machine: str,
    program: str | None,
    scenario: str | None,
    duration: float | None,
    record: str | None,
    free_run: bool,
    composed: bool,
    stay: bool = False,
    strict: bool = False,
    state_rate: float | None = None,
    dialect: str | None = None,
    begin: StartPoint | None = None,
    plc: str | None = None,
    recorder: RecorderOptions | None = None,
    foxglove: int | None = None,
    checkpoints: float = CHECKPOINT_SECONDS,
    web: WebOptions | None = None,
    listening: socket | None = None,
) -> int:
    """Runs the graph; prints a summary. Status 1 when a unit ended in error, a node died or the disk was full.

    `recorder`: None = without one.
    `stay`: until Ctrl-C, which is no error when everything is at a standstill. `strict`: status 1 also when a
    command was refused. `web`: how its pages are served, None = no pages; `listening`: a socket that has their port.
    """
    check_recording(record, machine_file=machine, NC_program=program, scenario=scenario, PLC_file=plc)
    parameters = read_machine(machine)
    print_missing_folders(parameters)
    read_entries(parameters, program=program, scenario=scenario, dialect=dialect, begin=begin)
    check_plc(parameters, plc)
    if recorder is not None:
        recorder.check(unit_kinds(parameters))
    options = RunOptions(
        machine=machine,
        program=program,
        scenario=scenario,
        duration=duration,
        record=record,
        free_run=free_run,
        stay=stay,
        state_rate=state_rate,
        dialect=dialect,
        begin=begin,
        plc=plc,
        recorder=recorder,
        foxglove=foxglove,
        checkpoints=checkpoints,
    )
    with WebBesideRun(web, listening) as pages, RunProgress(always_tells=stay and not composed) as progress:

        def show(monitor: RunMonitor) -> None:
            if monitor.cycle:
                pages.begin()
            for note in pages.notes:
                monitor.notes.add(note)
            progress.tell(monitor.notes.take_new(), monitor.take_faults())
            if progress.due:
                progress.show(monitor.views())

        if composed:
            monitor, failures = run_composed(parameters, options, show=show, watched=progress.visible)
        else:
            supervisor = Supervisor(parameters, options, show=show, watched=progress.visible)
            monitor, failures = supervisor.run(), supervisor.failures
    print_summary(parameters, monitor, failures, duration)
    given = (program, scenario, plc, duration, stay or None)
    print_note_of_idle_run(*given, options="--program, --scenario, --plc, --duration or --stay")
    cut_short = any(text.startswith(f"P-ERR-{ENDED_EARLY} ") for text in monitor.errors)
    return RUN_FAILED if failures or monitor.run_failed or cut_short or (strict and monitor.refused) else 0


def print_summary(
    machine: MachineParameters, monitor: RunMonitor, failures: list[str], duration: float | None = None
) -> None:
    console = Console(highlight=False, soft_wrap=True)
    cycle_time = machine.cycle_time_us * 1e-6
    cycles = monitor.cycle
    console.print(f"machine time {cycles * cycle_time:.3f} s ({cycles} cycles), {KERNEL.kind}")
    for line in time_lines(monitor.programs, cycle_time):
        console.print(line, markup=False)
    blocks, lost, twice = (
        sum(node.get(key, 0.0) for node in monitor.diagnostics.values()) for key in (BLOCKS, LOST_BLOCKS, CAME_TWICE)
    )
    nodes = len(monitor.diagnostics)
    console.print(f"blocks {blocks:.0f} in {nodes} nodes, lost {lost:.0f}, computed twice {twice:.0f}")
    for name, axis in machine.axes.items():
        unit = "deg" if axis.rotary else "mm"
        error = monitor.diagnostics.get(name, {}).get(following_error(unit))
        if error is not None:
            console.print(f"largest following error {name}: {error:.4f} {unit}")
    lateness = monitor.lateness()
    if lateness.counts:
        p50, p99 = lateness.percentile_us(50.0) / 1000.0, lateness.percentile_us(99.0) / 1000.0
        console.print(
            f"block lateness p50 {p50:.1f} ms, p99 {p99:.1f} ms, largest {lateness.largest_us / 1000.0:.1f} ms"
        )
    for text in failures:
        console.print(f"failed: {text}", style="bold red", markup=False)
    notes = [*monitor.notes, *([] if failures else cut_off_notes(monitor.programs, duration))]
    stopped = bool(failures or monitor.ending) or monitor.run_failed
    print_faults(console, monitor.errors, notes, stopped=stopped, refused=monitor.refused)
    if monitor.ending:
        console.print(monitor.ending, markup=False)
