"""T and D words: which compensation data act, and the offsets that they are in the axes.

The length acts in the main axis that is normal to the plane, offsets and wear in their axes. D0 is no tool. T goes to
the PLC alone, unless P-CHAN-00014 says that it selects the data of its number. In the vocabulary iso
G43 H selects: T calls the next tool while the last one cuts.
"""

from cnc_ptp.nc.canonical import LinearMove, Source, number
from cnc_ptp.nc.coordinates.placement import refresh
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.functions import MAX_TOOL, number_function
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.radius.changes import require_same_plane, require_same_radius
from cnc_ptp.nc.tools import tool_faults as faults
from cnc_ptp.nc.tools.tool_state import NO_TOOL
from cnc_ptp.parameters import Tool

NORMAL = {17: 2, 18: 1, 19: 0}
"""The main axis in which the length acts, by plane."""


def tool_words(channel: Channel, state: ModalState, block: NcBlock) -> bool:
    """T and D of a block; whether they have selected data. Raises ProgramError 21010, 21650, and as `select`."""
    letters = channel.vocabulary.function_words
    has_data = "D" in block.words and "D" in letters
    if "T" in block.words and "T" in letters:
        tool = number_function(block, "T", MAX_TOOL).number
        _require_tool(channel, block, tool)
        state.tool.t = tool
        if channel.t_selects and not has_data:
            select(channel, state, block.source, tool, "T")
            return True
    if has_data:
        select(channel, state, block.source, number_function(block, "D", MAX_TOOL).number, "D")
    return has_data


def _require_tool(channel: Channel, block: NcBlock, tool: int) -> None:
    known = {each.number for each in channel.tools.tools.values()}
    if channel.tools.present and tool and tool not in known:
        names = ", ".join(f"T{each}" for each in sorted(known)) or "none"
        raise faults.TOOL_UNKNOWN.at(block.source, block.source.column("T"), number=tool, known=names)


def select(channel: Channel, state: ModalState, source: Source, number: int, word: str) -> None:
    """Selects compensation data by a word of the block (D, T, H, G49); where no machine is known there are none.

    Raises ProgramError 20296, 21651, 21652, 21656, 20738.
    """
    shown, column = f"{word}{number}" if len(word) == 1 else word, source.column(word)
    name, file, line = state.tool.written
    if name and (file, line) == (source.file, source.line):
        raise faults.WRITTEN_WITH_D.at(source, column, name=name, word=shown)
    data = data_of(channel, state, number)
    if data is None:
        if channel.tools.present or channel.tools.complete:
            raise unknown_data(channel, source, column, shown, number)
        data = NO_TOOL
    if not data.valid:
        raise faults.DATA_INVALID.at(source, column, word=shown, number=number)
    if state.radius_compensation.data is None:
        require_same_radius(state, data, source, column, shown)
    state.tool.d, state.tool.data = number, data
    apply(channel, state, source, column)


def unknown_data(channel: Channel, source: Source, column: int, word: str, number: int) -> ProgramError:
    """20296, or 21656 where there are no data at all."""
    if not channel.tools.tools and not channel.tools.present:
        return faults.NO_TABLE.at(source, column, word=word, number=number)
    known = ", ".join(f"D{each}" for each in sorted(channel.tools.tools)) or "none"
    return faults.DATA_UNKNOWN.at(source, column, word=word, number=number, known=known)


def select_length(channel: Channel, state: ModalState, source: Source, number: int, word: str = "H") -> None:
    """G43 H5: the compensation data of this number act, as with D5, but no D goes out. Raises as `select`."""
    select(channel, state, source, number, word)


def cancel_length(channel: Channel, state: ModalState, source: Source) -> None:
    """G49: no compensation data, as with D0."""
    select(channel, state, source, 0, "G49")


def data_of(channel: Channel, state: ModalState, number: int) -> Tool | None:
    """Compensation data as the program has changed them, else as the tool table has them; None for unknown ones."""
    if number == 0:
        return NO_TOOL
    changed = (state.tool.changed or {}).get(number)
    return changed if changed is not None else channel.tools.tools.get(number)


def follow_plane(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G17 to G19: the length acts in the axis that is normal to the new plane."""
    require_same_plane(state, block.source, code.name)
    if state.tool.data is not NO_TOOL:
        apply(channel, state, block.source, block.source.column(code.name))


def apply(channel: Channel, state: ModalState, source: Source, column: int) -> None:
    """Makes offsets of the active data. Raises ProgramError 21652 for a length without an axis."""
    data = state.tool.data
    offsets = [0.0] * len(channel.axes)
    for values in (data.offsets, data.wear):
        for index, value in enumerate(values):
            offsets[index] += value
    length = data.length + data.wear_length
    if length:
        place = NORMAL[state.plane]
        index = channel.main[place]
        if index < 0:
            words = {"length": number(length), "axis": "XYZ"[place], "plane": str(state.plane)}
            raise faults.LENGTH_AXIS.at(source, column, number=state.tool.d, **words)
        offsets[index] += length
    coordinates = state.coordinates.lasting()
    coordinates.tool, coordinates.tool_fixed = tuple(offsets) if any(offsets) else (), data.fixed
    refresh(channel, state)


def compensating_move(state: ModalState) -> LinearMove:
    """P-CHAN-00100: the motion of a block with D alone; `state.programmed` is the point that stays programmed."""
    rapid = state.path == 0 or state.feed <= 0.0
    return LinearMove(tuple(state.programmed), rapid, 0.0 if rapid else state.feed)
