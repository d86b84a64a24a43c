"""`cnc_ptp run`: the ROS graph, until the job is done."""

from __future__ import annotations

from rich.console import Console

from cnc_ptp.commands.console import RUN_FAILED, print_faults, print_note_of_idle_run
from cnc_ptp.commands.paths import keep_inputs
from cnc_ptp.commands.progress import RunProgress
from cnc_ptp.machine.job import read_job
from cnc_ptp.machine.program_report import cut_off_notes, time_lines
from cnc_ptp.nodes.composed import run_composed
from cnc_ptp.nodes.monitor import RunMonitor
from cnc_ptp.nodes.supervisor import Job, Supervisor
from cnc_ptp.parameters import MachineParameters, read_machine


def run(
    machine: str,
    program: str | None,
    scenario: str | None,
    duration: float | None,
    record: str | None,
    free_run: bool,
    composed: bool,
) -> int:
    """Runs the graph; prints a summary. Status 1 when a unit ended in error or a node died."""
    keep_inputs(record, machine_file=machine, NC_program=program, scenario=scenario)
    parameters = read_machine(machine)
    read_job(parameters, program=program, scenario=scenario)
    job = Job(machine, program, scenario, duration, record, free_run)
    with RunProgress() as progress:

        def show(monitor: RunMonitor) -> None:
            at = monitor.progress
            progress.tell(monitor.notes)
            progress.show(at.blocks_done, at.blocks_total, at.line, at.position, at.feed_mm_per_min)

        if composed:
            monitor, failures = run_composed(parameters, job, show=show)
        else:
            supervisor = Supervisor(parameters, job, show=show)
            monitor, failures = supervisor.run(), supervisor.failures
    print_summary(parameters, monitor, failures, duration)
    print_note_of_idle_run(program, scenario, duration)
    return RUN_FAILED if failures or monitor.run_failed else 0


def print_summary(
    machine: MachineParameters, monitor: RunMonitor, failures: list[str], duration: float | None = None
) -> None:
    console = Console(highlight=False, soft_wrap=True)
    cycle_time = machine.cycle_time_us * 1e-6
    cycles = monitor.progress.cycle
    console.print(f"machine time {cycles * cycle_time:.3f} s ({cycles} cycles)")
    for line in time_lines(monitor.programs, cycle_time):
        console.print(line, markup=False)
    total = {
        key: sum(int(node[key]) for node in monitor.diagnostics.values())
        for key in ("blocks", "lost_blocks", "duplicates")
    }
    nodes, lost, twice = len(monitor.diagnostics), total["lost_blocks"], total["duplicates"]
    console.print(f"blocks {total['blocks']} in {nodes} nodes, lost {lost}, computed twice {twice}")
    for name, axis in machine.axes.items():
        if "following_error_max" in monitor.diagnostics.get(name, {}):
            error = float(monitor.diagnostics[name]["following_error_max"])
            console.print(f"largest following error {name}: {error:.4f} {'deg' if axis.rotary else 'mm'}")
    lateness = monitor.lateness()
    if lateness.counts:
        p50, p99 = lateness.percentile_us(50.0) / 1000.0, lateness.percentile_us(99.0) / 1000.0
        console.print(
            f"block lateness p50 {p50:.1f} ms, p99 {p99:.1f} ms, largest {lateness.largest_us / 1000.0:.1f} ms"
        )
    for text in failures:
        console.print(f"failed: {text}", style="bold red", markup=False)
    notes = [*monitor.notes, *([] if failures else cut_off_notes(monitor.programs, duration))]
    print_faults(console, monitor.errors, notes, stopped=bool(failures) or monitor.run_failed)
