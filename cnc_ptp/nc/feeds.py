"""Feeds: G94 in mm/min, G93 as the time of a block or its inverse, G95 in mm per turn of the main spindle."""

from math import hypot, radians
from typing import Final

from cnc_ptp.nc import faults, turning
from cnc_ptp.nc.arcs import linear_part
from cnc_ptp.nc.canonical import CircularMove, LinearMove
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, GCode, NcBlock

TIME: Final = 93
INVERSE: Final = 930
"""G93 of the vocabulary iso."""
PER_MINUTE: Final = 94
PER_TURN: Final = 95


def per_minute(state: ModalState) -> None:
    """G94: F is the feed that was programmed last with G94 until the next one."""
    state.feed_mode = PER_MINUTE


def time_of_block(state: ModalState) -> None:
    """G93: F is the time of each block in s."""
    state.feed_mode = TIME


def per_turn(state: ModalState) -> None:
    """G95: F is the feed that was programmed last with G95 until the next one."""
    state.feed_mode = PER_TURN


def inverse_time(state: ModalState) -> None:
    """G93 of the vocabulary iso: each block lasts 1/F minutes and needs an F of its own."""
    state.feed_mode = INVERSE
    state.block_time = 0.0


def note(state: ModalState, value: float) -> None:
    """Takes an F that is not negative into the state."""
    if state.feed_mode == PER_MINUTE:
        state.feed = value * state.coordinates.unit / 60.0
    elif state.feed_mode == PER_TURN:
        state.turning = state.turning._replace(feed=value * state.coordinates.unit)
    elif state.feed_mode == TIME:
        state.block_time = value
    else:
        state.block_time = 60.0 / value if value else 0.0


def require_feed(state: ModalState, block: NcBlock, code: GCode) -> None:
    """Raises ProgramError 20008 for a motion without a feed."""
    per_turn = state.feed_mode == PER_TURN
    if state.turning.feed if per_turn else state.feed if state.feed_mode == PER_MINUTE else state.block_time:
        return
    word = "F" if "F" in block.words else code.name
    raise faults.FEED_MISSING.at(block.source, block.source.column(word), g=code.name)


def timed(
    channel: Channel,
    state: ModalState,
    block: NcBlock,
    programmed: tuple[float, ...],
    motion: LinearMove | CircularMove,
) -> LinearMove | CircularMove:
    """With G93: the motion (machine coordinates) with the feed that takes the programmed time at a constant speed.

    With G95: with that of the commanded speed of the spindle; `programmed`: its target as the program names it.
    """
    if state.feed_mode == PER_MINUTE or (isinstance(motion, LinearMove) and (motion.rapid or motion.thread)):
        return motion
    if state.feed_mode == PER_TURN:
        return turning.with_spindle(channel, state, block, programmed, motion)
    kinematics = state.coordinates.kinematics
    also = () if kinematics is None else kinematics.plane
    feed = path_length(channel, state.position, motion, also) / state.block_time
    if state.feed_mode == INVERSE:
        state.block_time = 0.0
    return motion._replace(feed=feed)


def path_length(
    channel: Channel, start: tuple[float, ...], motion: LinearMove | CircularMove, also: tuple[int, ...] = ()
) -> float:
    """Of the main axes and `also` of others, by their places; of all axes if these do not move."""
    places = {index for index in (*channel.main, *also) if index >= 0}
    distances = [target - begin for begin, target in zip(start, motion.target, strict=True)]
    if isinstance(motion, CircularMove):
        linear = linear_part(distances, motion)
        return hypot(motion.radius * radians(motion.sweep), *[linear[index] for index in sorted(places)])
    main = hypot(*[distances[index] for index in sorted(places)])
    return main or hypot(*distances)
