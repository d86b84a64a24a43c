"""A whole machine as the kernel uses it: typed, in kernel units (mm, °, s), one frozen class per kind of unit."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.messages import Notice
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.authority import closed_units
from cnc_ptp.parameters.view.axis_view import AxisParameters, axis_view
from cnc_ptp.parameters.view.channel_view import ChannelParameters, channel_view
from cnc_ptp.parameters.view.control_view import ControlParameters
from cnc_ptp.parameters.view.fields import given_fields
from cnc_ptp.parameters.view.spindle_view import SpindleParameters, spindle_view

PLC = "plc"
"""Name of the unit whose parameters are those of /machine."""


@dataclass(frozen=True)
class MachineParameters:
    """A whole machine. Channels, axes and spindles by node name, in the order of /machine."""

    cycle_time_us: Annotated[int, ids.CYCLE_TIME_US]
    block_cycles: Annotated[int, ids.BLOCK_CYCLES]
    watchdog_ms: Annotated[int, ids.WATCHDOG_MS]
    life_sign_timeout_ms: Annotated[int, ids.LIFE_SIGN_TIMEOUT_MS]
    state_rate_hz: Annotated[float, ids.STATE_RATE_HZ]
    """Live states per second of each unit, 0 = none."""
    handshake_timeout_ms: Annotated[int, ids.HANDSHAKE_TIMEOUT_MS]
    """Time within which the PLC must acknowledge a function, 0 is no limit."""
    channels: Mapping[str, ChannelParameters]
    axes: Mapping[str, AxisParameters]
    spindles: Mapping[str, SpindleParameters]
    closed: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Unit -> sources of commands that the machine file closes it to."""
    warnings: tuple[Notice, ...] = ()
    """Values that are accepted but may not do what is expected, one line each."""
    sets: Mapping[str, ParameterSet] = field(default_factory=dict, repr=False, compare=False)

    def raw(self, node: str) -> ParameterSet:
        """All parameters of a node in list units; `machine` is the machine itself."""
        return self.sets[node]


def machine_view(
    machine: ParameterSet, sets: Mapping[str, ParameterSet], warnings: tuple[Notice, ...], folder: Path = Path()
) -> MachineParameters:
    """The machine of the parameters of /machine and of its units by node name; `folder` of its file."""
    of_kind = {kind: [unit for unit in sets.values() if unit.kind == kind] for kind in ("channel", "axis", "spindle")}
    cycle_time = machine.kernel(ids.CYCLE_TIME_US)
    channels = {unit.node: channel_view(unit, sets, folder) for unit in of_kind["channel"]}
    axes, spindles = with_equal_delays(
        {unit.node: axis_view(unit, cycle_time) for unit in of_kind["axis"]},
        {unit.node: spindle_view(unit, cycle_time) for unit in of_kind["spindle"]},
        channels.values(),
    )
    return MachineParameters(
        channels=channels,
        axes=axes,
        spindles=spindles,
        closed=closed_units(machine, (PLC, *sets)),
        warnings=warnings,
        sets={"machine": machine, **sets},
        **given_fields(MachineParameters, machine),
    )


def with_equal_delays(
    axes: Mapping[str, AxisParameters], spindles: Mapping[str, SpindleParameters], channels: Iterable[ChannelParameters]
) -> tuple[dict[str, AxisParameters], dict[str, SpindleParameters]]:
    """The axes and the spindles of each channel behind delay lines of the same length: the longest that one needs.

    Each axis gets the name of its channel.
    Otherwise they would leave their path by v · T for each cycle between them, a thread included.
    """
    late_axes, late_spindles = dict(axes), dict(spindles)
    for channel in channels:
        late_axes |= {axis.node: replace(late_axes[axis.node], channel=channel.name) for axis in channel.axes}
        path = [late_axes[axis.node] for axis in channel.axes]
        turning = [late_spindles[spindle.node] for spindle in channel.spindles if spindle.node in spindles]
        controls = [axis.control for axis in path]
        controls += [gear.control for spindle in turning for gear in spindle.gears.values()]
        cycles = max((control.delay_cycles for control in controls), default=0)
        late_axes |= {axis.name: replace(axis, control=delayed(axis.control, cycles)) for axis in path}
        for spindle in turning:
            stages = {
                stage: replace(gear, control=delayed(gear.control, cycles)) for stage, gear in spindle.gears.items()
            }
            late_spindles[spindle.name] = replace(spindle, gears=stages)
    return late_axes, late_spindles


def delayed(control: ControlParameters, cycles: int) -> ControlParameters:
    """With a delay line of at least so many cycles; a spindle of two channels has the longer one."""
    return replace(control, path_delay_cycles=max(cycles, control.path_delay_cycles))
