"""`cnc_ptp identify friction` and `identify dynamics`: axis data from a run of its own or from a recording."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.console import Console

from cnc_ptp.commands.commissioning.axis_data import AxisData, drive, open_axis, recorded_trace
from cnc_ptp.commands.commissioning.dynamics_report import dynamics_yaml, found_lines
from cnc_ptp.commands.commissioning.friction_report import (
    curve_lines,
    friction_yaml,
    scaling_of,
    speeds_shown,
)
from cnc_ptp.commands.console import RUN_FAILED, WarningLine, print_lines
from cnc_ptp.commands.output_file import check_output, deliver
from cnc_ptp.commissioning.coverage import missing_speeds, scenario_lines
from cnc_ptp.commissioning.dynamics import fit_drive
from cnc_ptp.commissioning.excitation import Motion, check_speeds, forth_and_back, highest_velocity, speed_ladder
from cnc_ptp.commissioning.faults import NO_COMMAND, refusal
from cnc_ptp.commissioning.friction import friction_curve
from cnc_ptp.commissioning.friction_table import friction_table
from cnc_ptp.commissioning.gain import propose_gain
from cnc_ptp.commissioning.inertia import fit_inertia
from cnc_ptp.commissioning.timing import DYNAMIC_STEADY, Timing
from cnc_ptp.commissioning.trace import AxisTrace
from cnc_ptp.parameters.view.control_view import friction_table_size

REST = 0.4
"""Seconds of rest before each motion."""
DYNAMIC_SPEEDS = (0.05, 0.1, 0.2, 0.4, 0.7, 1.0)
"""Parts of the highest velocity: ramps of different length."""
NO_VELOCITY_COMMAND = {
    "none": "is virtual, there is no drive to identify (P-AXIS-00020)",
    "position": "its drive closes the position loop itself and is commanded positions (P-AXIS-00020)",
    "lag": "its drive closes the position loop itself and is commanded the following error (P-AXIS-00020)",
    "torque": "its drive is commanded torques and has no velocity loop to identify (P-MACH-00020)",
}


def identify_friction(
    axis: str,
    machine: str | None,
    recording: str | None,
    output: str | None,
    record: str | None,
    velocities: Sequence[float],
) -> int:
    """Writes the friction table. Status 1 when the run failed."""
    data = open_axis(axis, machine, recording)
    check_files(output, record, machine, recording)
    warn_of_cut_recording(data)
    timing = Timing(data.kv)
    if data.recorded is not None:
        trace, source = recorded_trace(data, data.recorded), f"from {recording}"
    else:
        room, steady = data.room, timing.steady
        speeds = check_speeds(room, velocities, steady) if velocities else speed_ladder(room, steady)
        motions = forth_and_back(room, speeds, steady=steady, rest=REST)
        driven = driven_trace(data, motions, record)
        if driven is None:
            return RUN_FAILED
        trace, source = driven, f"from {len(speeds)} speeds in both directions in a run of {machine}"
    curve = friction_curve(trace, settling=timing.settling, half_digit=data.half_digit)
    table = friction_table(curve, scaling_of(data), max_points=friction_table_size(data.raw))
    console = Console(highlight=False, soft_wrap=True)
    print_lines(console, curve_lines(data, curve))
    if data.recorded is not None:
        print_lines(console, coverage_lines(data, [point.speed for point in curve.points], timing))
    if table.without_friction:
        console.print(f"left out, no friction there (0 or less): {speeds_shown(table.without_friction)} {data.unit}/s")
    if table.dropped:
        kept = f"{len(table.entries)} of {len(curve.points)} points"
        console.print(f"{kept} are in the table (P-COMP-00062); between them the curve is straight")
    if len(table.entries) == 1:
        text = "the table has one point, its friction counts at all velocities; drive more of them"
        print_lines(console, [WarningLine(text)])
    deliver(console, output, friction_yaml(data, curve, table, source))
    return 0


def identify_dynamics(
    axis: str, machine: str | None, recording: str | None, output: str | None, record: str | None
) -> int:
    """Writes Ta, inertia and a proposal for Kv. Status 1 when the run failed."""
    data = open_axis(axis, machine, recording)
    check_files(output, record, machine, recording)
    require_velocity_command(data)
    warn_of_cut_recording(data)
    if data.recorded is not None:
        trace, source = recorded_trace(data, data.recorded), f"from {recording}"
    else:
        room = data.room
        speed_ladder(room, DYNAMIC_STEADY)  # there must be room to move
        highest = highest_velocity(room, DYNAMIC_STEADY)
        speeds = [part * highest for part in DYNAMIC_SPEEDS]
        motions = forth_and_back(room, speeds, steady=DYNAMIC_STEADY, rest=0.5 * REST)
        driven = driven_trace(data, motions, record)
        if driven is None:
            return RUN_FAILED
        trace, source = driven, f"from {len(speeds)} speeds in both directions in a run of {machine}"
    fit = fit_drive(trace)
    gain, inertia = propose_gain(fit), fit_inertia(trace, time_constant=fit.time_constant)
    console = Console(highlight=False, soft_wrap=True)
    print_lines(console, found_lines(data, fit, gain, inertia))
    deliver(console, output, dynamics_yaml(data, fit, gain, inertia, source))
    return 0


def require_velocity_command(data: AxisData) -> None:
    """Raises CncError 27014 if the drive is not commanded a velocity: then the motion does not show the drive's."""
    interface = data.axis.control.drive.interface
    if interface in NO_VELOCITY_COMMAND:
        raise refusal(NO_COMMAND, data.axis.name, f"{NO_VELOCITY_COMMAND[interface]}; nothing was started")


def warn_of_cut_recording(data: AxisData) -> None:
    """A warning on standard error if the recording is not whole."""
    recorded = data.recorded
    if recorded is not None and not recorded.complete:
        reason = recorded.missing or "its end is missing"
        text = f"{recorded.path} was cut off ({reason}); only what it holds is evaluated"
        print_lines(Console(stderr=True, highlight=False, soft_wrap=True), [WarningLine(text)])


def check_files(output: str | None, record: str | None, machine: str | None, recording: str | None) -> None:
    """Raises CncError 27030 where something would be overwritten, one output by the other too."""
    check_output(output, machine_file=machine, recording=recording)
    check_output(record, machine_file=machine, recording=recording, output_file=output)


def driven_trace(data: AxisData, motions: Sequence[Motion], record: str | None) -> AxisTrace | None:
    """The trace of a run, None when it failed (reported on standard error)."""
    trial, trace = drive(data, motions, label=f"axis {data.axis.name}", record=record)
    if trial.failed:
        trial.print_faults()
        return None
    return trace


def coverage_lines(data: AxisData, found: Sequence[float], timing: Timing) -> Iterator[str]:
    """Which speeds a recording lacks, with a scenario that drives them."""
    missing = missing_speeds(speed_ladder(data.room, timing.steady), found)
    if not missing:
        yield "the speeds of the recording cover the axis"
        return
    shown = ", ".join(f"{speed:g}" for speed in missing)
    yield f"missing speeds: {shown} {data.unit}/s; this scenario drives them:"
    yield from scenario_lines(data.room, forth_and_back(data.room, missing, steady=timing.steady, rest=REST))
