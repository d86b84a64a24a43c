"""Software limits that a program has set (G98, G99), within those of the axis lists."""

from cnc_ptp.axis.faults import SOFT_LIMIT_NEGATIVE, SOFT_LIMIT_POSITIVE
from cnc_ptp.nc.arcs import extreme_points
from cnc_ptp.nc.canonical import CircularMove, LinearMove
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.program import Channel, ModalState, NcBlock


def check_limits(channel: Channel, state: ModalState, block: NcBlock, motion: LinearMove | CircularMove) -> None:
    """Raises ProgramError 120002 / 120003 for a motion (machine coordinates) beyond a limit of G98 or G99."""
    points = [motion.target]
    if isinstance(motion, CircularMove):
        points += extreme_points(state.position, motion)
    for index, (low, high) in (state.coordinates.limits or {}).items():
        name = channel.axes[index]
        unit = "deg" if name in channel.rotary else "mm"
        for point in points:
            if point[index] > high:
                text = f"axis {name}: {point[index]:g} {unit} lies beyond the software limit {high:g} {unit} of G99"
                raise ProgramError(SOFT_LIMIT_POSITIVE, text, block.source, block.source.column(name))
            if point[index] < low:
                text = f"axis {name}: {point[index]:g} {unit} lies beyond the software limit {low:g} {unit} of G98"
                raise ProgramError(SOFT_LIMIT_NEGATIVE, text, block.source, block.source.column(name))
