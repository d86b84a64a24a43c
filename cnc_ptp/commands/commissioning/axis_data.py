"""Input of an identification: an axis of a machine file, and its motion from a recording or a run of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cnc_ptp.commands.commissioning.trial_run import Trial, run_trial
from cnc_ptp.commissioning.excitation import PAUSE, Motion, Room
from cnc_ptp.commissioning.faults import NOT_RECORDED, UNKNOWN_AXIS
from cnc_ptp.commissioning.trace import AxisTrace
from cnc_ptp.errors import CncError
from cnc_ptp.machine.program_files import read_file
from cnc_ptp.parameters import AxisParameters, MachineParameters, ParameterSet, complete_text, load_machine
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.view.control_view import MONITORING_TYPES
from cnc_ptp.parameters.view.encoder import uses_feed_constant
from cnc_ptp.parameters.view.gears import active_gear
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.recording.reader import AXIS_STATE, Recorded
from cnc_ptp.recording.stored_states import read_columns
from cnc_ptp.recording.writer import topic_of

FIELDS = (
    "set_velocity",
    "actual_position",
    "actual_velocity",
    "command_velocity",
    "additive_velocity",
    "actual_torque",
)
NO_MACHINE = 27040
LARGEST_LAG = 0.75
"""Part of the permitted following error (P-AXIS-00168) that a trial may use."""


@dataclass(frozen=True)
class AxisData:
    """An axis of a machine; `text` of its file, `recorded` where a recording is to be evaluated."""

    machine: MachineParameters
    text: str
    axis: AxisParameters
    recorded: Recorded | None

    @property
    def raw(self) -> ParameterSet:
        """All parameters of the axis in list units."""
        return self.machine.raw(self.axis.name)

    @property
    def gear(self) -> int:
        """Index of the gear record in use."""
        return active_gear(self.raw)

    @property
    def kv(self) -> float:
        """Gain of the position controller, 1/s."""
        return self.axis.control.kv

    @property
    def mean_velocity(self) -> bool:
        """The telegram carries no actual velocity, so it is the distance of the last cycle by its time."""
        drive = self.axis.control.drive
        return not drive.ideal and "velocity" not in drive.feedback

    @property
    def half_digit(self) -> float:
        """Half a digit of the actual torque, Nm (N); 0.0 if it does not come in digits."""
        control = self.axis.control
        return 0.0 if control.drive.ideal or not control.scaling.torque else 0.5 / abs(control.scaling.torque)

    @property
    def unit(self) -> str:
        return "deg" if self.axis.rotary else "mm"

    @property
    def effort(self) -> str:
        """Unit of torque: Nm at the motor, N on a linear axis without feed constant."""
        return "Nm" if self.axis.rotary or uses_feed_constant(self.raw) else "N"

    @property
    def room(self) -> Room:
        """Travel and speed that the axis may use for a trial: the lag v/Kv stays well below what is monitored."""
        axis, monitoring = self.axis, self.axis.control.monitoring
        velocity, limited_by = axis.max_velocity, ids.DYNAMIK_VB_MAX
        if axis.reference_velocity < velocity:
            velocity, limited_by = axis.reference_velocity, ids.PTP_REFERENCE_VELOCITY
        bearable = LARGEST_LAG * monitoring.moving_limit * self.kv
        if monitoring.kind in MONITORING_TYPES and bearable < velocity:
            velocity, limited_by = bearable, f"there the lag is {100.0 * LARGEST_LAG:g} % of P-AXIS-00168"
        return Room(
            axis.name,
            self.unit,
            axis.start_position,
            axis.soft_limit_negative,
            axis.soft_limit_positive,
            velocity,
            axis.acceleration,
            axis.deceleration,
            axis.jerk,
            axis.control.plant.encoder_increment,
            limited_by,
        )


def open_axis(axis: str, machine: str | None, recording: str | None) -> AxisData:
    """The axis; the machine file of a recording is used, --machine is for one that holds none.

    Raises CncError 27001, 27002, 27040 (none, or two that differ), those of reading the machine file and the recording.
    """
    recorded = None if recording is None else read_columns(recording, topic_of(axis, "state"), FIELDS)
    if machine is not None:
        text, file = complete_text(read_file("machine file", machine), machine), machine
        if recorded is not None and recorded.machine_yaml not in ("", text):
            reason = f"was made with another machine file than {machine}; nothing was made, leave --machine out"
            raise CncError(NO_MACHINE, f"recording {recording} {reason}")
    elif recorded is not None and recorded.machine_yaml:
        text, file = recorded.machine_yaml, f"{recording}:machine.yaml"
    else:
        raise CncError(NO_MACHINE, f"recording {recording} holds no machine file", "nothing was made, give --machine")
    parameters = load_machine(text, file)
    if axis not in parameters.axes:
        kind = "a spindle" if axis in parameters.spindles else "no axis"
        known = ", ".join(parameters.axes)
        near = f", did you mean {axis.lower()}?" if axis.lower() in parameters.axes else ";"
        raise CncError(UNKNOWN_AXIS, f"{axis} is {kind} of the machine {file}{near} nothing was started. Axes: {known}")
    return AxisData(parameters, text, parameters.axes[axis], recorded)


def recorded_trace(data: AxisData, recorded: Recorded) -> AxisTrace:
    """The axis in a recording. Raises CncError 27002 where it is not recorded."""
    axis, states = data.axis.name, recorded.of_type(AXIS_STATE)
    if axis not in states:
        topics = [topic for topic, info in recorded.topics.items() if info.type_name == AXIS_STATE]
        known = ", ".join(topic.removeprefix("/").removesuffix("/state") for topic in topics) or "none"
        raise CncError(
            NOT_RECORDED,
            f"recording {recorded.path} holds no states of axis {axis}",
            f"nothing was made. Axes in it: {known}",
        )
    return AxisTrace.of_rows(axis, recorded.cycle_time_ns * 1e-9, states[axis], mean_velocity=data.mean_velocity)


def drive(data: AxisData, motions: Sequence[Motion], *, label: str, record: str | None) -> tuple[Trial, AxisTrace]:
    """Runs the motions offline, friction compensation off."""
    name = data.axis.name
    entries = []
    if not data.axis.powered_at_start:
        entries.append(Entry(0.0, Command(name, "power", {"enabled": True})))
    if data.axis.control.friction.permitted:
        entries.append(Entry(0.0, Command(name, "set_friction_compensation", {"enabled": False})))
    entries += [
        Entry(motion.at, Command(name, "move_relative", {"distance": motion.distance, "velocity": motion.velocity}))
        for motion in motions
    ]
    trial = run_trial(
        data.machine,
        entries,
        fields={name: FIELDS},
        seconds=motions[-1].at + motions[-1].duration + PAUSE,
        label=label,
        record=record,
        machine_text=data.text,
    )
    columns = {**trial.columns[name], "cycle": trial.columns[name]["cycle"].astype(np.int64)}
    cycle_time = data.machine.cycle_time_us * 1e-6
    return trial, AxisTrace.of_rows(name, cycle_time, columns, mean_velocity=data.mean_velocity)
