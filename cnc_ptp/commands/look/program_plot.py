"""`cnc_ptp plot PROGRAM --machine MACHINE`: a program is run offline and becomes a page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from cnc_ptp.channel.channel_unit import BAD_OVERRIDE
from cnc_ptp.commands.commissioning.trial_run import Columns, Trial, run_trial
from cnc_ptp.commands.console import RUN_FAILED, print_missing_folders
from cnc_ptp.commands.output_file import beside, check_page, write_output
from cnc_ptp.errors import CncError
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.parameters import MachineParameters, machine_text, read_machine
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.plots.path_figures import path_axes
from cnc_ptp.plots.program_page import program_page
from cnc_ptp.plots.program_run import program_run
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.recording.reader import (
    AXIS_STATE,
    CHANNEL_STATE,
    SPINDLE_STATE,
    Recorded,
    TopicInfo,
    coordinates,
)
from cnc_ptp.recording.selection import NOT_RECORDED
from cnc_ptp.recording.statistics import axis_units
from cnc_ptp.wire.layout import Records

AXIS_FIELDS = ("set_position", "set_velocity", "set_acceleration", "set_jerk", "state")
CHANNEL_FIELDS = ("path_velocity", "programmed_feed", "distance_to_go", "line", "block_number", "state")
SPINDLE_FIELDS = ("set_position_deg", "state", "status_bits")
WHOLE_NUMBERS = {"cycle": "u8", "line": "u4", "block_number": "u4", "state": "u1", "status_bits": "u4"}
NOTHING = "nothing was drawn"


def plot_program(
    program: str,
    machine: str,
    *,
    colour: str = "feed",
    dialect: str | None = None,
    override: float = 100.0,
    output: str | None = None,
) -> int:
    """Writes the page; without `output` PROGRAM.html. Status 1 when the run ended in an error: then nothing is written.

    Raises the errors of the machine file and of the program, CncError 22006 for an `override` (%) above that of the
    machine, 27030 for an output that cannot be written, 26011 for a program that does not move along a path.
    """
    output = output or beside(program, ".html")
    check_page(output, machine_file=machine, NC_program=program)
    parameters = read_machine(machine)
    print_missing_folders(parameters)
    job = read_entries(parameters, program=program, scenario=None, dialect=dialect)
    channel = next(iter(parameters.channels.values()))
    if override > channel.max_override_percent:
        limit = f"--override {override:g} % is above {channel.max_override_percent:g} % (P-CHAN-00056)"
        raise CncError(BAD_OVERRIDE, limit, NOTHING)
    job.insert(1, Entry(0.0, Command(channel.name, "set_override", {"percent": override})))
    nodes = [axis.node for axis in channel.axes]
    # each spindle may become the C axis (#MAIN SPINDLE)
    c_axis = [entry.node for entry in channel.spindles if channel.c_axis and entry.node]
    fields = {channel.name: CHANNEL_FIELDS, **dict.fromkeys(nodes, AXIS_FIELDS)}
    fields |= dict.fromkeys(c_axis, SPINDLE_FIELDS)
    trial = run_trial(parameters, job, fields=fields, seconds=0.0, label=Path(program).name)
    if trial.failed:
        trial.print_faults()
        return RUN_FAILED
    recorded = as_recorded(parameters, machine, program, trial)
    axes = path_axes(recorded, axis_units(recorded))
    run = program_run(recorded, axes)
    if run is None:
        raise CncError(NOT_RECORDED, f"program {program}: does not move two axes along a path", NOTHING)
    details = [Path(machine).name, *([] if override == 100.0 else [f"override {override:g} %"])]
    page = program_page(recorded, run, title=Path(program).name, details=details, colour=colour)
    write_output(output, page, remains=NOTHING)
    size = Path(output).stat().st_size / 1e6
    print(f"{output}: {size:.1f} MB, program time {run.seconds:.3f} s, path {run.length[-1]:.2f} mm")
    return 0


def as_recorded(parameters: MachineParameters, machine: str, program: str, trial: Trial) -> Recorded:
    """The run as a recording would show it."""
    recorded = Recorded(Path(program), complete=True, machine_yaml=machine_text(machine))
    recorded.metadata["cycle_time_ns"] = str(parameters.cycle_time_us * 1000)
    recorded.commands, recorded.events = trial.records, trial.events
    for unit, columns in trial.columns.items():
        topic, kind = f"/{unit}/state", kind_of(unit, parameters)
        recorded.states[topic] = records_of(columns)
        recorded.topics[topic] = TopicInfo(topic, kind, len(columns["cycle"]))
    recorded.coordinates = [coordinates(channel, offsets) for channel, offsets in trial.offsets]
    return recorded


def kind_of(unit: str, parameters: MachineParameters) -> str:
    """Type of the states of a unit."""
    if unit in parameters.channels:
        return CHANNEL_STATE
    return SPINDLE_STATE if unit in parameters.spindles else AXIS_STATE


def records_of(columns: Columns) -> Records:
    """The columns as states."""
    kinds: Mapping[str, str] = {name: WHOLE_NUMBERS.get(name, "f8") for name in columns}
    rows: Records = np.zeros(len(columns["cycle"]), dtype=list(kinds.items()))
    for name, values in columns.items():
        rows[name] = values
    return rows
