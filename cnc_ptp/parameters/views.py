"""The parameters as the kernel uses them: typed, in kernel units (mm, °, s), one frozen class a kind of unit."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from cnc_ptp.parameters import notices
from cnc_ptp.parameters.channel_view import ChannelParameters, channel_view
from cnc_ptp.parameters.control_view import ControlParameters, control_view
from cnc_ptp.parameters.encoder import encoder_increment
from cnc_ptp.parameters.lines import Notice
from cnc_ptp.parameters.modulo import is_modulo
from cnc_ptp.parameters.parameter_set import ParameterSet
from cnc_ptp.parameters.spindle_view import SpindleParameters, spindle_view

VIRTUAL_AXIS = 16
MONITORING_TYPES = (1, 2, 4)


@dataclass(frozen=True, slots=True)
class AxisParameters:
    """A linear (mm) or rotary (°) axis. Velocities per second, accelerations per s², jerk per s³, times in s."""

    name: str
    number: int
    rotary: bool
    modulo: bool
    """A turntable or a conveyor: it counts on without an end, also from modulo_low to modulo_high, mm (°).

    Then the soft limits are infinite.
    """
    modulo_low: float
    modulo_high: float
    virtual: bool
    """Has no drive (P-AXIS-00020 = 16)."""
    max_velocity: float
    rapid_velocity: float
    reference_velocity: float
    """A PTP start with more is refused."""
    max_acceleration: float
    acceleration: float
    deceleration: float
    emergency_deceleration: float
    jerk: float
    soft_limit_negative: float
    soft_limit_positive: float
    position_window: float
    encoder_increment: float
    """mm or ° an increment; 0.0 is an ideal measuring system."""
    override_type: int
    """PTP override: 1 reduced, 2 original, 3 and 4 the same iterated."""
    override_steps: int
    """Override filter: steps from 0 to 100 %, 0 = no filter …"""
    override_interval: float
    """… and the least time between two of them."""
    max_override_percent: float
    external_dead_time: float
    external_timeout: float
    """Longest silence of external setpoints in motion."""
    target_time: float
    """In which the actual position must have come into the position window; 0 = not monitored."""
    error_propagation_delayed: bool
    """An error reaches the other axes of the master/slave group only after error_propagation_delay."""
    error_propagation_delay: float
    couple_to_actual: bool
    """Slaves follow the actual values of this axis while it has no enable or a delayed error."""
    velocity_window: float
    """An actual velocity below it is 0 for slaves."""
    velocity_filter_time: float
    powered_at_start: bool
    referenced_at_start: bool
    start_position: float
    control: ControlParameters


@dataclass(frozen=True)
class MachineParameters:
    """A whole machine. Channels, axes and spindles by node name, in the order of /machine."""

    cycle_time_us: int
    block_cycles: int
    watchdog_ms: int
    life_sign_timeout_ms: int
    state_rate_hz: float
    """Live states a second of each unit, 0 = none."""
    handshake_timeout_ms: int
    """For so long the PLC may leave a function unacknowledged, 0 is for ever."""
    channels: Mapping[str, ChannelParameters]
    axes: Mapping[str, AxisParameters]
    spindles: Mapping[str, SpindleParameters]
    warnings: tuple[Notice, ...] = ()
    """What is accepted but deserves a look, one line each."""
    sets: Mapping[str, ParameterSet] = field(default_factory=dict, repr=False, compare=False)

    def raw(self, node: str) -> ParameterSet:
        """All parameters of a node in list units; `machine` is the machine itself."""
        return self.sets[node]


def machine_view(machine: ParameterSet, sets: Mapping[str, ParameterSet]) -> MachineParameters:
    of_kind = {kind: [unit for unit in sets.values() if unit.kind == kind] for kind in ("channel", "axis", "spindle")}
    cycle_time = machine.kernel("P-MACH-00001")
    channels = {unit.node: channel_view(unit, sets) for unit in of_kind["channel"]}
    axes = {unit.node: axis_view(unit, cycle_time) for unit in of_kind["axis"]}
    return MachineParameters(
        cycle_time_us=int(machine.number("P-MACH-00001")),
        block_cycles=int(machine.number("P-MACH-00002")),
        watchdog_ms=int(machine.number("P-MACH-00003")),
        life_sign_timeout_ms=int(machine.number("P-MACH-00009")),
        state_rate_hz=float(machine.number("P-MACH-00070")),
        handshake_timeout_ms=int(machine.number("P-MACH-00060")),
        channels=channels,
        axes=equally_late(axes, channels.values()),
        spindles={unit.node: spindle_view(unit, cycle_time) for unit in of_kind["spindle"]},
        warnings=tuple(notices.machine_warnings(machine, sets)),
        sets={"machine": machine, **sets},
    )


def equally_late(
    axes: Mapping[str, AxisParameters], channels: Iterable[ChannelParameters]
) -> dict[str, AxisParameters]:
    """The axes, those of a channel behind delay lines of the same length: the longest that one of them needs.

    Otherwise they would be off their path by v · T for each cycle between them.
    """
    late = dict(axes)
    for channel in channels:
        path = [axes[axis.node] for axis in channel.axes]
        cycles = max((axis.control.delay_cycles for axis in path), default=0)
        late |= {axis.name: replace(axis, control=replace(axis.control, path_delay_cycles=cycles)) for axis in path}
    return late


def axis_view(parameters: ParameterSet, cycle_time: float) -> AxisParameters:
    gear = active_gear(parameters)
    rotary = parameters.axis_type == "R"
    modulo = is_modulo(parameters)
    max_velocity = parameters.kernel("P-AXIS-00212", gear)
    return AxisParameters(
        name=parameters.node,
        number=int(parameters.number("P-AXIS-00016")),
        rotary=rotary,
        modulo=modulo,
        modulo_low=parameters.kernel("P-AXIS-00127", gear) if modulo else 0.0,
        modulo_high=parameters.kernel("P-AXIS-00126", gear) if modulo else 0.0,
        virtual=int(parameters.number("P-AXIS-00020")) == VIRTUAL_AXIS,
        max_velocity=max_velocity,
        rapid_velocity=parameters.kernel("P-AXIS-00209", gear),
        reference_velocity=parameters.kernel("P-MACH-00008") or max_velocity,
        max_acceleration=parameters.kernel("P-AXIS-00008", gear),
        acceleration=parameters.kernel("P-AXIS-00001", gear),
        deceleration=parameters.kernel("P-AXIS-00002", gear),
        emergency_deceleration=emergency_deceleration(parameters, gear),
        jerk=jerk(parameters, gear),
        soft_limit_negative=-math.inf if modulo else parameters.kernel("P-AXIS-00177"),
        soft_limit_positive=math.inf if modulo else parameters.kernel("P-AXIS-00178"),
        position_window=parameters.kernel("P-AXIS-00236", gear),
        encoder_increment=encoder_increment(parameters, gear),
        override_type=int(parameters.number("P-MACH-00007")),
        override_steps=int(parameters.number("P-MACH-00010")),
        override_interval=parameters.number("P-MACH-00011") / 1000.0,
        max_override_percent=parameters.percent("P-AXIS-00109"),
        external_dead_time=parameters.kernel("P-MACH-00012"),
        external_timeout=parameters.number("P-MACH-00013") / 1000.0,
        target_time=parameters.number("P-MACH-00014") / 1000.0,
        error_propagation_delayed=bool(parameters.number("P-MACH-00015")),
        error_propagation_delay=parameters.number("P-MACH-00016") / 1000.0,
        couple_to_actual=bool(parameters.number("P-MACH-00017")),
        velocity_window=parameters.kernel("P-MACH-00018"),
        velocity_filter_time=parameters.kernel("P-MACH-00019"),
        powered_at_start=bool(parameters.number("P-SIM-00004")),
        referenced_at_start=bool(parameters.number("P-SIM-00005")),
        start_position=parameters.kernel("P-SIM-00003"),
        control=control_view(parameters, gear, cycle_time),
    )


def active_gear(parameters: ParameterSet) -> int:
    """Index of the gear record in use after start-up."""
    return int(parameters.number("P-AXIS-00079")) - 1


def jerk(parameters: ParameterSet, gear: int) -> float:
    """J = a_beschl / tr_beschl_zu, in mm/s³ or °/s³."""
    return parameters.number("P-AXIS-00001", gear) * 1_000_000 / parameters.number("P-AXIS-00196", gear)


def emergency_deceleration(parameters: ParameterSet, gear: int) -> float:
    return parameters.kernel("P-AXIS-00003", gear) or parameters.kernel("P-AXIS-00008", gear)
