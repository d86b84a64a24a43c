"""Software limits that a program has set (G98, G99), within those of the axis lists.

An axis that does not move may be beyond a limit that came later.
"""

from collections.abc import Collection, Mapping, Sequence

from cnc_ptp.nc.arcs import extreme_points
from cnc_ptp.nc.canonical import CircularMove, LinearMove, Source
from cnc_ptp.nc.coordinates import coordinate_faults as faults
from cnc_ptp.nc.machine_points import machine_points
from cnc_ptp.nc.program import Channel

Limits = Mapping[int, tuple[float, float]]
"""The lowest and highest position by place of the axis."""


def check_limits(
    channel: Channel, limits: Limits, start: tuple[float, ...], motion: LinearMove | CircularMove, source: Source
) -> None:
    """Raises ProgramError 120002 / 120003 for a motion from `start` (machine coordinates) beyond a limit.

    Of a Cartesian one (#FACE, #CYL) all axes count.
    """
    if motion.kinematics is not None:
        points = machine_points(start, motion, source)[1:]
        require_within(channel, limits, points, range(len(channel.axes)), source)
        return
    points = [motion.target]
    moving = moving_axes(start, motion.target)
    if isinstance(motion, CircularMove):
        points += extreme_points(start, motion)
        moving.update(index for index in range(len(channel.axes)) if motion.turns(index))
    require_within(channel, limits, points, moving, source)


def moving_axes(start: tuple[float, ...], target: tuple[float, ...]) -> set[int]:
    """Places of the axes that a straight motion moves."""
    return {place for place, (a, b) in enumerate(zip(start, target, strict=True)) if a != b}


def require_within(
    channel: Channel, limits: Limits, points: Sequence[tuple[float, ...]], moving: Collection[int], source: Source
) -> None:
    """Raises ProgramError 120002 / 120003 if one of the `moving` axes is beyond a limit of G98 or G99 in a point."""
    for index, (low, high) in limits.items():
        for point in points:
            if low <= point[index] <= high or index not in moving:
                continue
            name = channel.axes[index]
            fault, limit = (faults.LIMIT_POSITIVE, high) if point[index] > high else (faults.LIMIT_NEGATIVE, low)
            values = {"axis": name, "unit": "deg" if name in channel.rotary else "mm", "limit": f"{limit:g}"}
            raise fault.at(source, source.column(name), position=f"{point[index]:g}", **values)
