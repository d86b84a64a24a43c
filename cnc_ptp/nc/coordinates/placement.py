"""Motions from programmed to machine coordinates."""

from cnc_ptp.nc.canonical import CircularMove, LinearMove, Source
from cnc_ptp.nc.coordinates import coordinate_faults as faults
from cnc_ptp.nc.coordinates.frame import dot
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, NcBlock


def place(
    channel: Channel, state: ModalState, block: NcBlock, motion: LinearMove | CircularMove
) -> LinearMove | CircularMove:
    """The motion in machine coordinates. Raises ProgramError for an arc that is none there."""
    frame = state.frame
    if frame is None:
        return motion
    target = frame.target(motion.target, state.programmed, state.position)
    if isinstance(motion, LinearMove):
        return motion._replace(target=target)
    first, second = motion.plane
    circle = frame.circle(first, second)
    if circle is None:
        code = next((code.name for code in block.codes if code.motion is not None), "")
        names = {"first": channel.axes[first], "second": channel.axes[second]}
        raise faults.SCALED_ARC.at(block.source, block.source.column(code) if code else 1, **names)
    centre = list(motion.target)
    centre[first], centre[second] = motion.center
    placed = frame.to_machine(centre)
    sweep = -motion.sweep if circle.over else motion.sweep
    center = placed[first], placed[second]
    if circle.directions is not None:
        center = dot(placed, circle.directions[0]), dot(placed, circle.directions[1])
    return motion._replace(
        target=target, center=center, radius=motion.radius * circle.scale, sweep=sweep, directions=circle.directions
    )


def refresh(channel: Channel, state: ModalState) -> None:
    """After a change of the coordinates: the path stays where it is, its programmed position is another one."""
    state.frame = state.coordinates.frame(len(channel.axes), channel.main)
    state.programmed = state.position if state.frame is None else state.frame.to_programmed(state.position)
    state.reported = False


def leave_frame(state: ModalState) -> None:
    """Programmed positions are machine positions until the next `refresh`."""
    state.frame, state.programmed = None, state.position


def plane_axes(channel: Channel, state: ModalState, source: Source, word: str) -> tuple[int, int]:
    """Places of the two axes of the active plane, or of that of #FACE or #CYL.

    Raises ProgramError 21603 if one is missing.
    """
    if state.coordinates.kinematics is not None:
        return state.coordinates.kinematics.plane
    names = PLANE_AXES[state.plane]
    first, second = (channel.axis_index.get(name) for name in names)
    if first is None or second is None:
        values = {"word": word, "needed": " and ".join(names), "plane": f"G{state.plane}"}
        raise faults.ROTATION_PLANE.at(source, source.column(word), known=", ".join(channel.axes), **values)
    return first, second


PLANE_AXES = {17: ("X", "Y"), 18: ("Z", "X"), 19: ("Y", "Z")}
