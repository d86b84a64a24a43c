"""G43 and G49: the length of the tool, from the compensation data of its H number."""

from cnc_ptp.nc.canonical import number as shown
from cnc_ptp.nc.iso import iso_faults as faults
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.tools.compensation import cancel_length, select_length


def length_on(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G43 H5; H0 is no length. Raises ProgramError 21812 without a tool table, and as `select_length`."""
    value = block.words.get("H")
    if value is None:
        what = "the number of the tool length"
        raise faults.WORD_MISSING.at(block.source, block.source.column(code.name), g=code.name, word="H", what=what)
    column = block.source.column("H")
    if value < 0.0 or value != int(value) or value > 999_999_999.0:
        raise faults.RANGE.at(block.source, column, word="H", value=shown(value), low=0, high=999_999_999)
    if value and not channel.tools.present:
        raise faults.NO_TOOL_TABLE.at(block.source, column, g=code.name, number=int(value))
    select_length(channel, state, block.source, int(value))


def length_off(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G49."""
    cancel_length(channel, state, block.source)
