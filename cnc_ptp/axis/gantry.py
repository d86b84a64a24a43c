"""Gantry pair: the slave watches the distance of the actual positions, and in an error it stops with its master."""

from __future__ import annotations

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.coupling import Coupling, LinearCoupling
from cnc_ptp.axis.faults import GANTRY_DIFFERENCE
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.protocol.blocks import AxisBlock

PAIR_PATIENCE = 4
"""Blocks in which the error of a gantry slave must have reached its master."""


class GantryPair:
    """The pair that a slave forms with its master, if its coupling has a limit of the difference."""

    def __init__(self, slave: Axis) -> None:
        self._axis = slave
        self._first_cycle = 0
        self._master_positions: list[float] | None = None
        """Actual positions of the master in the cycles of the block; None where no difference is limited."""
        self._distance: float | None = None
        """Distance of the actual positions at the start of the coupling, mm (deg)."""
        self._blocks_in_error = 0

    def begin(self) -> None:
        """A new coupling: the distance of its first cycle counts."""
        self._distance = None
        self._blocks_in_error = 0

    def rest(self) -> None:
        """Nothing is watched until `take`."""
        self._master_positions = None

    def take(self, coupling: Coupling, first_cycle: int, master: AxisBlock) -> None:
        """The block of the master for the cycles from `first_cycle` on."""
        if isinstance(coupling, LinearCoupling) and coupling.difference_limit is not None:
            self._first_cycle = first_cycle
            self._master_positions = list(master.actual_position)

    @property
    def watches(self) -> bool:
        """True if the cycles of this block must be looked at one by one."""
        return self._master_positions is not None and self._axis.coupled

    def watch(self, cycle: int, setpoint: MotionState, actual_position: float) -> None:
        """A fault when the actual positions of the pair have left their distance by more than its limit."""
        axis, coupling, positions = self._axis, self._axis.coupling, self._master_positions
        if positions is None or axis.error_id or not axis.coupled:
            return
        assert isinstance(coupling, LinearCoupling) and coupling.difference_limit is not None
        distance = actual_position - positions[cycle - self._first_cycle]
        if self._distance is None:
            self._distance = distance
        difference = abs(distance - self._distance)
        if difference > coupling.difference_limit:
            limit = coupling.difference_limit
            reason = (
                f"the actual positions of {axis.name} and its gantry master {coupling.master} differ by "
                f"{difference:g} {axis.unit}, more than {limit:g} {axis.unit}"
            )
            values = {"difference": difference, "limit": limit}
            axis.fault(cycle, GANTRY_DIFFERENCE, reason, setpoint, values=values)

    def ends(self, first_cycle: int, position: float, master: AxisBlock) -> bool:
        """The slave is in error: true when it ends, with its master, or alone if the master does not stop."""
        self._blocks_in_error += 1
        if not (master.set_velocity[0] or master.set_acceleration[0]):
            self._axis.end_with_master(first_cycle, position)
            return True
        if master.error_id[0] or self._blocks_in_error <= PAIR_PATIENCE:
            return False
        self._axis.end_alone(first_cycle)
        return True
