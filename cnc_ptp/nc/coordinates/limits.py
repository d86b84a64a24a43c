"""Software limits that a program has set (G98, G99), within those of the axis lists.

An axis that does not move may be beyond a limit that came later.
"""

from cnc_ptp.nc.arcs import extreme_points
from cnc_ptp.nc.canonical import CircularMove, LinearMove
from cnc_ptp.nc.coordinates import coordinate_faults as faults
from cnc_ptp.nc.program import Channel, ModalState, NcBlock


def check_limits(channel: Channel, state: ModalState, block: NcBlock, motion: LinearMove | CircularMove) -> None:
    """Raises ProgramError 120002 / 120003 for a motion (machine coordinates) beyond a limit of G98 or G99."""
    points = [motion.target]
    if isinstance(motion, CircularMove):
        points += extreme_points(state.position, motion)
    ends = zip(motion.target, state.position, strict=True)
    moving = {place for place, (target, position) in enumerate(ends) if target != position}
    if isinstance(motion, CircularMove):
        moving.update(index for index in range(len(channel.axes)) if motion.turns(index))
    for index, (low, high) in (state.coordinates.limits or {}).items():
        for point in points:
            if low <= point[index] <= high or index not in moving:
                continue
            name = channel.axes[index]
            fault, limit = (faults.LIMIT_POSITIVE, high) if point[index] > high else (faults.LIMIT_NEGATIVE, low)
            values = {"axis": name, "unit": "deg" if name in channel.rotary else "mm", "limit": f"{limit:g}"}
            raise fault.at(block.source, block.source.column(name), position=f"{point[index]:g}", **values)
