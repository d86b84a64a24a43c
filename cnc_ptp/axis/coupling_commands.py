"""Coupling of an axis to a master, factors, errors of the group. Source: TX1250 3."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.cam import CamCoupling, CamTable
from cnc_ptp.axis.carried import CarriedMotion
from cnc_ptp.axis.coupling import Coupling, CyclicCoupling, LinearCoupling
from cnc_ptp.axis.decoupling_commands import refuse_free
from cnc_ptp.axis.faults import (
    ACC_BOUND_UNSTABLE,
    BAD_ACC_BOUND,
    BAD_CAM_TABLE,
    BAD_COUPLING_VALUE,
    BAD_FACTOR,
    COUPLED_TO_ITSELF,
    COUPLING_LOOP,
    FACTOR_KIND,
    GROUP_ERROR,
    MASTER_NOT_STANDING,
    SLAVE_NOT_STANDING,
    UNKNOWN_MASTER,
)
from cnc_ptp.axis.flying_saw import FlyingSaw
from cnc_ptp.errors import CncError, warning_text
from cnc_ptp.parameters import AxisParameters
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

GROUP = ("above", "master_stands", "master_start", "master_lost")
"""Arguments that the PLC fills in."""

SMALLEST_FACTOR, LARGEST_FACTOR = 1e-6, 1e6
"""A coupling factor beyond these is taken for a typing error."""


class CouplingCommands:
    """`couple` and its kinds, `set_coupling_factor`, `set_cyclic_factor`; `lead` and `group_error`.

    What the axis itself cannot know comes with the command: the PLC, which sees all axes, fills in `above` (the masters
    of the master), `master_stands`, `master_start` (a command that may move it in this block) and `master_lost`.
    """

    def __init__(self, axis: Axis, *, axes: Mapping[str, AxisParameters], cycle_time: float) -> None:
        """`axes` of the machine by name, `cycle_time` in s."""
        self._axis = axis
        self._axes = axes
        self._cycle_time = cycle_time

    # couple

    def do_couple(self, cycle: int, *, master: str, factor: float, **group: Any) -> str | None:
        """Slave position = `factor` · master position + offset of the coupling positions. Refusals: 23041 – 23046."""
        self._check("couple", master, **group)
        self._check_factor("couple", factor)
        return self._couple("couple", cycle, LinearCoupling(master, float(factor)))

    def do_couple_gantry(
        self,
        cycle: int,
        *,
        master: str,
        difference_limit: float,
        **group: Any,
    ) -> str | None:
        """Factor 1 with a limit (mm, deg) for the deviation of the actual positions from their distance."""
        self._check("couple_gantry", master, **group)
        self._check_positive("couple_gantry", difference_limit=difference_limit)
        coupling = LinearCoupling(master, 1.0, difference_limit=float(difference_limit))
        return self._couple("couple_gantry", cycle, coupling)

    def do_couple_cyclic(self, cycle: int, *, master: str, acc_bound: float, **group: Any) -> str | None:
        """The factor comes cyclically; the slave's acceleration stays within `acc_bound` (mm/s²)."""
        self._check("couple_cyclic", master, **group)
        if not acc_bound > 0.0:
            reason = f"acc_bound = {acc_bound} must be greater than 0"
            self._axis.refuse("couple_cyclic", BAD_ACC_BOUND, reason, acc_bound=acc_bound)
        coupling = CyclicCoupling(master, float(acc_bound), cycle_time=self._cycle_time)
        return self._couple("couple_cyclic", cycle, coupling)

    def do_couple_flying_saw(
        self,
        cycle: int,
        *,
        master: str,
        factor: float,
        master_position: float,
        slave_position: float,
        **others: Any,
    ) -> str | None:
        """Runs up to a moving master; synchronous from `master_position` and `slave_position` (mm, deg) on.

        On the path of a channel it is added to the path: `slave_position` counts from the path position at the
        coupling.
        """
        command, axis = "couple_flying_saw", self._axis
        group = {name: others.pop(name) for name in GROUP if name in others}
        self._check(
            command,
            master,
            **(group | {"master_stands": True, "master_start": "", "on_path": self._can_be_carried(cycle)}),
        )
        self._check_factor(command, factor)
        limits = axis.checks.dynamics(command, others)
        if not axis.on_path:
            axis.checks.soft_limits(command, slave_position)
        positions = {"master_position": float(master_position), "slave_position": float(slave_position)}
        saw = FlyingSaw(master, float(factor), limits=limits, unit=axis.unit, **positions)
        return self._couple(command, cycle, saw)

    def _can_be_carried(self, cycle: int) -> bool:
        """A path axis on which nothing else is superimposed."""
        axis = self._axis
        added = axis.superposed and (axis.external.mode is not None or axis.external.moving(cycle))
        return axis.on_path and axis.coupling is None and not added

    def do_couple_cam(
        self,
        cycle: int,
        *,
        master: str,
        table: Sequence[Sequence[float]],
        cyclic: bool = True,
        master_offset: float = 0.0,
        master_scaling: float = 1.0,
        slave_scaling: float = 1.0,
        slave_offset: float | None = None,
        file: str = "",
        above: Sequence[str] = (),
        master_stands: bool = True,
        master_start: str = "",
        master_lost: bool = False,
        on_path: bool = False,
    ) -> str | None:
        """Slave position over master position from a table of points (master, slave)."""
        command = "couple_cam"
        standstill: dict[str, Any] = {"master_stands": master_stands, "master_start": master_start}
        self._check(command, master, above=above, master_lost=master_lost, on_path=on_path, **standstill)
        self._check_factor(command, slave_scaling, "slave_scaling")
        self._check_factor(command, master_scaling, "master_scaling")
        coupling = CamCoupling(
            master,
            self._cam_table(command, table, cyclic),
            master_offset=float(master_offset),
            master_scaling=float(master_scaling),
            slave_scaling=float(slave_scaling),
            slave_offset=slave_offset,
        )
        return self._couple(command, cycle, coupling)

    def do_change_cam(self, cycle: int, *, table: Sequence[Sequence[float]], file: str = "") -> None:
        """A new table for a cyclic cam; it comes in when the master passes the seam of the active one."""
        coupling = self._axis.coupling
        if not isinstance(coupling, CamCoupling) or not coupling.table.cyclic:
            self._axis.refuse("change_cam", FACTOR_KIND, "the axis is not coupled by a cyclic cam table")
        coupling.change_table(self._cam_table("change_cam", table, True))

    def _cam_table(self, command: str, table: Sequence[Sequence[float]], cyclic: bool) -> CamTable:
        try:
            return CamTable(table, cyclic=cyclic)
        except CncError as error:
            self._axis.refuse(command, BAD_CAM_TABLE, error.reason, **error.values)

    def _check(
        self,
        command: str,
        master: str,
        *,
        above: Sequence[str] = (),
        master_stands: bool = True,
        master_start: str = "",
        master_lost: bool = False,
        on_path: bool = False,
    ) -> None:
        """`on_path`: this coupling may be added to the path that moves the axis."""
        axis = self._axis
        if master == axis.name:
            axis.refuse(command, COUPLED_TO_ITSELF, "an axis cannot be its own master")
        if master not in self._axes:
            known = ", ".join(name for name in self._axes if name != axis.name) or "none"
            axis.refuse(command, UNKNOWN_MASTER, f"there is no axis '{master}'. Known: {known}", master=master)
        if master_lost:
            axis.refuse(command, UNKNOWN_MASTER, f"the node of the master {master} is lost", master=master)
        if axis.state != S.STANDSTILL and not on_path:
            state = state_name(axis.state)
            reason = f"the axis is in {state}, it must be in Standstill"
            axis.refuse(command, SLAVE_NOT_STANDING, reason, state=state)
        if axis.name in above:
            chain = " -> ".join([master, *above][: [*above].index(axis.name) + 2])
            reason = f"{master} is a slave of the axis already ({chain})"
            axis.refuse(command, COUPLING_LOOP, reason, master=master, chain=chain)
        if not master_stands:
            reason = f"the master {master} moves; both axes must be at a standstill"
            axis.refuse(command, MASTER_NOT_STANDING, reason, master=master)
        if master_start:
            given = f"{master_start} was commanded in the same block"
            reason = f"{given}, so that the standstill of the master {master} is known in the next one only"
            axis.refuse(command, MASTER_NOT_STANDING, reason, master=master)

    def _check_factor(self, command: str, factor: float, name: str = "factor") -> None:
        if factor == 0.0:
            reason = f"{name} = 0 must be different from 0"
            self._axis.refuse(command, BAD_FACTOR, reason, argument=name, value=factor)
        if not SMALLEST_FACTOR <= abs(factor) <= LARGEST_FACTOR:
            low, high = SMALLEST_FACTOR, LARGEST_FACTOR
            reason = f"{name} = {factor} must be between {low:g} and {high:g} or the negative of it"
            self._axis.refuse(command, BAD_FACTOR, reason, argument=name, value=factor, low=low, high=high)

    def _check_positive(self, command: str, **values: float) -> None:
        for name, value in values.items():
            if not value > 0.0:
                reason = f"{name} = {value} must be greater than 0"
                self._axis.refuse(command, BAD_COUPLING_VALUE, reason, argument=name, value=value)

    def _couple(self, command: str, cycle: int, coupling: Coupling) -> str | None:
        """A warning when the controllers of slave and master work with different delays."""
        axis = self._axis
        if axis.on_path:
            axis.carried = CarriedMotion(cycle, cycle_time=self._cycle_time)
            axis.superposed = True
        else:
            axis.absorb(cycle)
        axis.coupling = coupling
        axis.has_been_stopped = False
        axis.take(T.COUPLE)
        return self._delay_warning(command, coupling.master)

    def _delay_warning(self, command: str, master: str) -> str | None:
        axis = self._axis
        own, of_master = axis.parameters.control.delay_cycles, self._axes[master].control.delay_cycles
        if own == of_master:
            return None
        apart = f"{abs(own - of_master) * self._cycle_time * 1000.0:g} ms · velocity"
        return (
            f"axis {axis.name}: {command}: its position controller works {own} cycles behind the setpoint, that of the "
            f"master {master} {of_master} (P-COMP-00044, P-AXIS-00165); in motion they are {apart} apart"
        )

    # factors

    def do_set_coupling_factor(self, cycle: int, *, factor: float) -> None:
        """A new factor of a linear slave: the position stays continuous, the velocity steps."""
        coupling = self._coupled("set_coupling_factor")
        if not isinstance(coupling, LinearCoupling) or coupling.difference_limit is not None:
            self._axis.refuse("set_coupling_factor", FACTOR_KIND, "the coupling of the axis has no factor to set")
        self._check_factor("set_coupling_factor", factor)
        coupling.set_factor(float(factor))

    def do_set_cyclic_factor(self, cycle: int, *, factor: float) -> str | None:
        """The factor of a cyclic slave; a warning when AccBound is below the stability bound for it."""
        axis, coupling = self._axis, self._coupled("set_cyclic_factor")
        if not isinstance(coupling, CyclicCoupling):
            axis.refuse("set_cyclic_factor", FACTOR_KIND, "the axis is not coupled cyclically")
        coupling.set_factor(float(factor))
        master = self._axes[coupling.master]
        bound = abs(factor) * max(master.acceleration, master.deceleration)
        if bound <= coupling.acc_bound:
            return None
        text = (
            f"axis {axis.name}: set_cyclic_factor: AccBound {coupling.acc_bound:g} is below |factor|·max(A+, A-) = "
            f"{bound:g} {axis.unit}/s² of the master {coupling.master}; the slave may lag behind"
        )
        return warning_text(ACC_BOUND_UNSTABLE, text, acceleration=bound, limit=coupling.acc_bound)

    def _coupled(self, command: str) -> Coupling:
        axis = self._axis
        if axis.coupling is None or axis.state != S.SYNCHRONIZED_MOTION:
            refuse_free(axis, command)
        return axis.coupling

    # the group

    def do_lead(self, cycle: int, *, slave: str, enabled: bool) -> None:
        """The PLC: `slave` is coupled to this axis, or no longer is."""
        (self._axis.slaves.add if enabled else self._axis.slaves.discard)(slave)

    def do_group_error(self, cycle: int, *, source: str, error: int) -> None:
        """The PLC: an error of `source` reaches this axis of its group."""
        axis = self._axis
        if axis.state not in (S.ERROR_STOP, S.DISABLED):
            axis.fault(cycle, GROUP_ERROR, f"axis {source} of its group has error {error}")
