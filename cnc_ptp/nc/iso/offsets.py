"""Offsets of the vocabulary iso: G54.1, G59.1, G10, G52, G53, G92, units and the tolerance of G64."""

from typing import Final

from cnc_ptp.nc.canonical import Function, number
from cnc_ptp.nc.contour import Contour, Smoothing, Transition
from cnc_ptp.nc.coordinates.codes import LAST_OFFSET, axis_values, offset_values, select_offset
from cnc_ptp.nc.coordinates.placement import refresh
from cnc_ptp.nc.iso import iso_faults as faults
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.radius.changes import require_off

G59: Final = 6
"""Index of the zero offset of G59; those of G59.1 and G54.1 P1 follow it."""
SYSTEMS: Final = 9
"""G10 P1 is G54, P9 is G59.3."""


def integer(block: NcBlock, code: GCode, word: str, low: int, high: int, what: str) -> int:
    """The value of a word that `code` needs. Raises ProgramError 21807, 21806."""
    value = block.words.get(word)
    if value is None:
        raise faults.WORD_MISSING.at(block.source, block.source.column(code.name), g=code.name, word=word, what=what)
    if value != int(value) or not low <= value <= high:
        column = block.source.column(word)
        raise faults.RANGE.at(block.source, column, word=word, value=number(value), low=low, high=high)
    return int(value)


def further_offset(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G59.1 to G59.3, G54.1 P1 to P90."""
    if code.number == 59:
        index = code.minor
    else:
        index = integer(block, code, "P", 1, LAST_OFFSET - G59, "the number of the zero offset")
    select_offset(channel, state, G59 + index)


def set_offset(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[Function, ...]:
    """G10 L2: the values of a zero offset; L20: those with which the present position has the values of the block."""
    kind = block.words.get("L")
    if kind is None:
        raise faults.WORD_MISSING.at(block.source, block.source.column("G10"), g="G10", word="L", what="L2 or L20")
    if kind not in (2.0, 20.0):
        raise faults.OFFSET_KIND.at(block.source, block.source.column("L"), value=number(kind))
    index = integer(block, code, "P", 0, SYSTEMS, "the number of the zero offset; P0 is the active one")
    own = state.coordinates.own
    index = index or own.zero_index
    changes = state.coordinates.changes
    values = list(offset_values(channel, changes, index))
    active = own.zero or (0.0,) * len(channel.axes)
    for axis, value in axis_values(channel, state, block, code):
        given = value * channel.turning.offset_factor(axis)
        values[axis] = given if kind == 2.0 else active[axis] + state.programmed[axis] - value
    state.coordinates.changes = changes._replace(values={**changes.values, index: tuple(values)})
    if index == own.zero_index:
        select_offset(channel, state, index)
    return ()


def local_offset(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[Function, ...]:
    """G52 X10: an offset on top of all zero offsets; 0 takes it back."""
    own = state.coordinates.own
    values = list(own.preset or (0.0,) * len(channel.axes))
    for axis, value in axis_values(channel, state, block, code):
        values[axis] = value
    state.coordinates.own = own._replace(preset=tuple(values))
    refresh(channel, state)
    return ()


def mirror_off(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[Function, ...]:
    """G50.1, G50.1 X0 Y0: nothing, since G51.1 is not there; its axis words are no motion."""
    if block.words:
        axis_values(channel, state, block, code)
    return ()


def set_position(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[Function, ...]:
    """G92 X0: the present position has these values from now on."""
    own = state.coordinates.own
    values = list(own.added or (0.0,) * len(channel.axes))
    for axis, value in axis_values(channel, state, block, code):
        values[axis] += state.programmed[axis] - value
    _shift(channel, state, tuple(values))
    return ()


def end_position(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G92.1: the offset of G92 is 0; G92.2: it is off; G92.3: on again."""
    coordinates = state.coordinates
    own, suspended = coordinates.own.added, coordinates.suspended
    coordinates.suspended = (own or suspended) if code.minor == 2 else ()
    _shift(channel, state, (suspended or own) if code.minor == 3 else ())


def _shift(channel: Channel, state: ModalState, added: tuple[float, ...]) -> None:
    state.coordinates.own = state.coordinates.own._replace(added=added)
    refresh(channel, state)


def machine_coordinates(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G53: the axis words of its block are machine positions, whatever other codes and tools are in it."""
    column = block.source.column(code.name)
    require_off(state, block.source, column, code.name)
    if state.path not in (0, 1):
        raise faults.MACHINE_PATH.at(block.source, column)
    if not state.absolute:
        raise faults.MACHINE_INCREMENTAL.at(block.source, column)
    state.machine_words = True


def path_tolerance(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G64 P0.01 Q0.01: how far the path may leave the programmed corners (P) and short blocks (Q), mm.

    Without them the path continues where the direction does.
    """
    for word in "PQ":
        value = block.words.get(word, 0.0)
        if value < 0.0:
            column = block.source.column(word)
            raise faults.TOLERANCE_NEGATIVE.at(block.source, column, word=word, value=number(value))
    unit = state.coordinates.unit
    path_dev, merged = block.words.get("P", 0.0) * unit, block.words.get("Q", 0.0) * unit
    contour = Contour(path_dev=path_dev) if path_dev else None
    state.transition = Transition(exact=False, contour=contour, smoothing=Smoothing(merged) if merged else None)
