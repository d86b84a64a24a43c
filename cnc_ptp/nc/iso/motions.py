"""Motions of the vocabulary iso that differ from the first one's: arcs, dwell, reference point, G80."""

from collections.abc import Iterator

from cnc_ptp.nc import faults as nc_faults
from cnc_ptp.nc import motions
from cnc_ptp.nc.canonical import CircularMove, Dwell, LinearMove, number
from cnc_ptp.nc.coordinates import coordinate_faults
from cnc_ptp.nc.iso import iso_faults as faults
from cnc_ptp.nc.modal_state import NO_DRILLING, ModalState, Step
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.radius.changes import require_off


def end_cycle(state: ModalState) -> None:
    """G00 to G03: the numbers of a drilling cycle are forgotten."""
    if state.drilling.running:
        state.drilling = NO_DRILLING._replace(to_r=state.drilling.to_r)


def without_motion(state: ModalState) -> None:
    """G80: the cycle has ended; axis words need a path function again."""
    end_cycle(state)
    state.path = 80


def no_motion(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """Words behind G80: F is kept for later, an axis is an error."""
    if motions.target_of(channel, state, block, code) is not None:
        word = next(word for word in block.words if word in channel.axis_index)
        raise faults.NO_MOTION.at(block.source, block.source.column(word), word=word)


def circular(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> CircularMove | None:
    """G02, G03: R counts for its block alone."""
    state.radius = 0.0
    return motions.circular(channel, state, block, code)


def dwell(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> Dwell:
    """G04 P2.5 or G04 X2.5: seconds, alone in its block."""
    times = [word for word in block.words if word in "PX"]
    others = [word for word in block.words if word not in "PX"] + [m.name for m in block.m]
    others += [other.name for other in block.codes if other is not code] + times[1:]
    source = block.source
    if others:
        raise nc_faults.DWELL_NOT_ALONE.at(source, source.column(others[0]), word=others[0])
    if not times:
        raise nc_faults.DWELL_MISSING.at(source, source.column(code.name))
    seconds = block.words[times[0]]
    if seconds < 0.0:
        raise nc_faults.DWELL_NEGATIVE.at(source, source.column(times[0]), value=number(seconds))
    return Dwell(seconds)


def require_axes(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G28 moves the axes that it names. Raises ProgramError 21602 if it names none, 20797, 20651."""
    require_off(state, block.source, block.source.column(code.name), code.name)
    letters = channel.vocabulary.axis_letters
    unknown = next((word for word in block.words if word in letters and word not in channel.axis_index), "")
    if unknown:
        known = ", ".join(channel.axes)
        raise nc_faults.AXIS_UNKNOWN.at(block.source, block.source.column(unknown), word=unknown, known=known)
    if channel.axis_index.keys().isdisjoint(block.words):
        raise coordinate_faults.AXES_MISSING.at(block.source, block.source.column(code.name), word=code.name)


def reference_point(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> LinearMove:
    """G28: the axes of the block at rapid speed to the intermediate point, from there to the reference point."""
    target = motions.target_of(channel, state, block, code) or state.programmed
    axes = [channel.axis_index[word] for word in block.words if word in channel.axes]
    state.following = _to_reference(channel, state, axes)
    return LinearMove(tuple(target), True, 0.0)


def _to_reference(channel: Channel, state: ModalState, axes: list[int]) -> Iterator[Step]:
    target = list(state.position)
    for axis in axes:
        target[axis] = channel.references[axis] if channel.references else 0.0
    yield Step(LinearMove(tuple(target), True, 0.0), machine=True)
