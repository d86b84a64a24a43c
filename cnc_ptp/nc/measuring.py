"""Measuring runs: G100, and G31 of the vocabulary iso; a straight line that the signal of a probe ends."""

from collections.abc import Sequence
from typing import NamedTuple

from cnc_ptp.nc import faults
from cnc_ptp.nc.canonical import LinearMove, Motion
from cnc_ptp.nc.contour import EXACT_STOP
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.motions import straight
from cnc_ptp.nc.program import Channel, GCode, NcBlock


class Touch(NamedTuple):
    """How a measuring run has ended: where the axes were at the signal (mm, deg), None without one."""

    position: tuple[float, ...] | None


class Measured(NamedTuple):
    """Results for one axis, mm (deg); in machine coordinates and as programs name the point.

    `offset`: from the end of the measuring run to the measured point; `reached`: the signal came before that end.
    """

    machine: float = 0.0
    programmed: float = 0.0
    offset: float = 0.0
    reached: bool = False


NOT_MEASURED = Measured()


def measuring_run(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> LinearMove:
    """G100: straight at the feed, with an exact stop; refused while G261 or G61 rounds corners, as the vendor does."""
    once = state.once is not None and state.once.contour is not None
    if once or state.transition.contour is not None:
        word = "G61" if once else "G261"
        raise faults.MEASURING_CONTOURING.at(block.source, block.source.column(code.name), g=code.name, code=word)
    return skip(channel, state, block, code)


def require_words(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """A block without any word has no motion, so that nothing else looks at it. Raises ProgramError 21100."""
    if not block.words:
        raise faults.MEASURING_WITHOUT_AXIS.at(block.source, block.source.column(code.name), g=code.name)


def skip(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> LinearMove:
    """G31: the same, with an exact stop whatever G64 says."""
    column = block.source.column(code.name)
    if state.drilling.running:
        raise faults.MEASURING_IN_CYCLE.at(block.source, column, g=code.name, cycle=state.drilling.running)
    named = tuple([channel.axis_index[word] for word in block.words if word in channel.axis_index])
    motion = straight(channel, state, block, code)
    if motion is None:
        raise faults.MEASURING_WITHOUT_AXIS.at(block.source, column, g=code.name)
    return motion._replace(measures=named)


def placed(motion: LinearMove, start: Sequence[float], block: NcBlock) -> LinearMove:
    """A measuring run in machine coordinates from `start`: all axes that move take part. Raises ProgramError 21101."""
    moved = [axis for axis, (begin, end) in enumerate(zip(start, motion.target, strict=True)) if begin != end]
    if not moved:
        name = next(code.name for code in block.codes if code.motion is not None)
        raise faults.MEASURING_NOWHERE.at(block.source, block.source.column(name), g=name)
    axes = tuple(sorted({*motion.measures, *moved}))
    return motion._replace(transition=EXACT_STOP, measures=axes)


def measures(motion: Motion | None) -> bool:
    """The motion ends with the signal of the probe, so where it ends only the run knows."""
    return isinstance(motion, LinearMove) and motion.measures != ()


def results(
    motion: LinearMove, touch: Touch, programmed: Sequence[float], before: dict[int, Measured]
) -> dict[int, Measured]:
    """Results by axis after a measuring run; `programmed`: the measured point as programs name it.

    Axes that did not take part keep theirs; without a signal so do the others, but for `reached`.
    """
    after = dict(before)
    for axis in motion.measures:
        if touch.position is None:
            after[axis] = before.get(axis, NOT_MEASURED)._replace(reached=False)
        else:
            point = touch.position[axis]
            after[axis] = Measured(point, programmed[axis], point - motion.target[axis], True)
    return after
