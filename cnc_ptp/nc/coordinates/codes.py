"""G codes of coordinates: units, zero offsets, G92, mirror, software limits."""

from typing import Final

from cnc_ptp.nc import faults as nc_faults
from cnc_ptp.nc.canonical import Function, number
from cnc_ptp.nc.coordinates import coordinate_faults as faults
from cnc_ptp.nc.coordinates.coordinates import INCH, NO_CHANGES, Coordinates, OffsetChanges, Offsets
from cnc_ptp.nc.coordinates.placement import plane_axes, refresh
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.radius.radius_state import NOT_COMPENSATED

LAST_OFFSET = 96
"""P-ZERO: np_grp[0] to np_grp[96]."""
FIRST_OFFSET_CODE = 53
INCH_CODES: Final = (20, 70)
"""Of the two vocabularies."""


def unit(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G70 (iso: G20): lengths and feeds in inch, G71 (G21): in mm."""
    state.coordinates.unit = INCH if code.number in INCH_CODES else 1.0


def zero_offset(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G53: none; G54 to G59: the first to the sixth; G159=n: any of them."""
    select_offset(channel, state, offset_index(block, code) if code.valued else code.number - FIRST_OFFSET_CODE)


def offset_index(block: NcBlock, code: GCode) -> int:
    """The value of G159 or G160. Raises ProgramError 21600."""
    index = (block.values or {})[code.name]
    if index != int(index) or not 0 <= index <= LAST_OFFSET:
        column = block.source.column(code.name)
        raise faults.OFFSET_INDEX.at(block.source, column, index=number(index), limit=LAST_OFFSET, word=code.name)
    return int(index)


def select_offset(channel: Channel, state: ModalState, index: int) -> None:
    """An offset without values has none: it is 0 for all axes."""
    use_offset(channel, state.coordinates, index)
    refresh(channel, state)


def use_offset(channel: Channel, coordinates: Coordinates, index: int) -> None:
    """The change alone; the frame follows from it."""
    zero: Offsets = ()
    if has_offset(channel, index):
        changes = coordinates.changes
        inactive = inactive_axes(channel, changes, index)
        values = offset_values(channel, changes, index)
        zero = tuple([0.0 if place in inactive else value for place, value in enumerate(values)])
    coordinates.own = coordinates.own._replace(zero_index=index, zero=zero)


def has_offset(channel: Channel, index: int) -> bool:
    """Index 0 (G53) has one on machines with P-ZERO-00001."""
    return index > 0 or channel.offsets.g53


def offset_values(channel: Channel, changes: OffsetChanges, index: int) -> Offsets:
    """Values of a zero offset, one for each axis: as they were changed, else as the machine file has them."""
    changed = changes.values.get(index)
    none = (0.0,) * len(channel.axes)
    return changed if changed is not None else channel.offsets.zero.get(index, none)


def inactive_axes(channel: Channel, changes: OffsetChanges, index: int) -> frozenset[int]:
    """Places of the axes for which a zero offset does not count."""
    changed = changes.inactive.get(index)
    return changed if changed is not None else channel.offsets.inactive.get(index, frozenset())


def default_offset(channel: Channel, changes: OffsetChanges) -> int:
    """Index of the zero offset with which a program starts."""
    return channel.offsets.default if changes.default < 0 else changes.default


def initial_state(channel: Channel, changes: OffsetChanges = NO_CHANGES, clamp_index: int = 0) -> ModalState:
    """That with which a program starts."""
    coordinates = initial_coordinates(channel, changes, clamp_index)
    state = ModalState(coordinates=coordinates, transition=channel.path.transition, contour=channel.path.contour)
    state.radius_compensation = NOT_COMPENSATED._replace(by_lines=channel.radius.by_lines)
    return state


def initial_coordinates(channel: Channel, changes: OffsetChanges, clamp_index: int) -> Coordinates:
    """Those with which a program starts."""
    coordinates = Coordinates(changes=changes, clamp_index=clamp_index)
    coordinates.clamp = channel.offsets.clamp.get(clamp_index, ())
    use_offset(channel, coordinates, default_offset(channel, changes))
    return coordinates


def offset_activity(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[Function, ...]:
    """G160=2 X1 Y0: zero offset 2 does not count for X, but for Y, when it is selected next."""
    index = offset_index(block, code)
    if not has_offset(channel, index):
        raise faults.NO_OFFSET_OF_G53.at(block.source, block.source.column(code.name), word=f"{code.name}=0")
    changes = state.coordinates.changes
    places = set(inactive_axes(channel, changes, index))
    for place, value in axis_values(channel, state, block, code, scaled=False):
        if value not in (0.0, 1.0):
            axis = channel.axes[place]
            raise faults.ACTIVITY.at(block.source, block.source.column(axis), axis=axis, value=number(value))
        if value:
            places.add(place)
        else:
            places.discard(place)
    inactive = {**changes.inactive, index: frozenset(places)}
    state.coordinates.changes = changes._replace(inactive=inactive)
    return ()


def reference_offset(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[Function, ...]:
    """G92 X10: an offset beside the zero offset; G90 sets it, G91 adds to it."""
    own = state.coordinates.own
    values = list(own.added or (0.0,) * len(channel.axes))
    for index, given in axis_values(channel, state, block, code):
        value = given * channel.turning.offset_factor(index)
        values[index] = value if state.absolute else values[index] + value
    state.coordinates.own = own._replace(added=tuple(values))
    refresh(channel, state)
    return ()


def axis_values(
    channel: Channel, state: ModalState, block: NcBlock, code: GCode, *, scaled: bool = True
) -> list[tuple[int, float]]:
    """Places and values (mm, deg) of the axes of a block. Raises ProgramError without an axis, and for other words."""
    found: list[tuple[int, float]] = []
    for word, value in block.words.items():
        index = channel.axis_index.get(word)
        if word in code.words:
            continue
        if index is None:
            column = block.source.column(word)
            if word[0] not in channel.vocabulary.axis_letters:
                raise nc_faults.WORD_NOT_USED.at(block.source, column, word=word, g=code.name)
            raise nc_faults.AXIS_UNKNOWN.at(block.source, column, word=word, known=", ".join(channel.axes))
        plain = not scaled or word in channel.rotary
        found.append((index, value if plain else value * state.coordinates.unit))
    if not found:
        raise faults.AXES_MISSING.at(block.source, block.source.column(code.name), word=code.name)
    return found


def mirror(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G20: off; G21: the first axis of the plane changes its sign, G22: the second, G23: both."""
    if code.number == 20:
        state.coordinates.mirror = ()
    else:
        first, second = plane_axes(channel, state, block.source, code.name)
        signs = [1.0] * len(channel.axes)
        signs[first] = -1.0 if code.number in (21, 23) else 1.0
        signs[second] = -1.0 if code.number in (22, 23) else 1.0
        state.coordinates.mirror = tuple(signs)
    refresh(channel, state)


def mirror_axes(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[Function, ...]:
    """G351 X-1 Y1: X changes its sign, Y does not, the other axes as before. Raises ProgramError 20860."""
    signs = list(state.coordinates.mirror or (1.0,) * len(channel.axes))
    for place, value in axis_values(channel, state, block, code, scaled=False):
        if abs(value) != 1.0:
            axis = channel.axes[place]
            raise faults.MIRROR_VALUE.at(block.source, block.source.column(axis), axis=axis, value=number(value))
        signs[place] = value
    state.coordinates.mirror = tuple(signs) if -1.0 in signs else ()
    refresh(channel, state)
    return ()


def software_limit(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[Function, ...]:
    """G98 X-10: negative software limits in machine coordinates, G99: positive ones; within those of the lists."""
    limits = dict(state.coordinates.limits or {})
    for index, value in axis_values(channel, state, block, code):
        low, high = limits.get(index, (float("-inf"), float("inf")))
        if code.number == 98:
            low = value if state.absolute or low == float("-inf") else low + value
        else:
            high = value if state.absolute or high == float("inf") else high + value
        if low >= high:
            name = channel.axes[index]
            values = {"axis": name, "unit": "deg" if name in channel.rotary else "mm"}
            column = block.source.column(name)
            raise faults.LIMIT_ORDER.at(block.source, column, low=number(low), high=number(high), **values)
        limits[index] = (low, high)
    state.coordinates.limits = limits
    return ()
