"""G43 and G49: the length of the tool. Tables of lengths come with the tool management."""

from cnc_ptp.nc.canonical import number as shown
from cnc_ptp.nc.coordinates.placement import refresh
from cnc_ptp.nc.iso import iso_faults as faults
from cnc_ptp.nc.program import Channel, GCode, ModalState, NcBlock


def select_length(channel: Channel, state: ModalState, block: NcBlock, number: int) -> None:
    """The length of tool `number` acts from this block on; 0: none. Raises ProgramError 21812."""
    if number:
        raise faults.NO_TOOL_TABLE.at(block.source, block.source.column("H"), g="G43", number=number)
    state.coordinates.tool = ()
    refresh(channel, state)


def length_on(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G43 H5."""
    value = block.words.get("H")
    if value is None:
        what = "the number of the tool length"
        raise faults.WORD_MISSING.at(block.source, block.source.column(code.name), g=code.name, word="H", what=what)
    if value < 0.0 or value != int(value) or value > 999_999_999.0:
        column = block.source.column("H")
        raise faults.RANGE.at(block.source, column, word="H", value=shown(value), low=0, high=999_999_999)
    select_length(channel, state, block, int(value))


def length_off(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G49."""
    select_length(channel, state, block, 0)
