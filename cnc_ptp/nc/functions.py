"""M, S, T, D and H of a block -> canonical functions."""

from cnc_ptp.nc import faults, gears
from cnc_ptp.nc.canonical import AuxiliaryFunction, Function, code_name, number
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, MCode, NcBlock
from cnc_ptp.nc.spindles import spindle_functions

MAX_TOOL = 999_999_999
MAX_H = 65_535


def block_functions(channel: Channel, state: ModalState, block: NcBlock) -> tuple[Function, ...]:
    """All functions of a block in the order T, D, main spindle, other spindles, M, H; keeps speeds in the state."""
    letters = channel.vocabulary.function_words
    used = [letter for letter in "TDH" if letter in block.words and letter in letters]
    functions: list[Function] = [number_function(block, letter, MAX_TOOL) for letter in used if letter != "H"]
    if channel.t_selects and "T" in used and "D" not in used:
        functions.append(AuxiliaryFunction("D", state.tool.d))
    functions += spindle_functions(channel, state, block)
    gear_change = channel.table.gear_change
    for code in block.m:
        if code.handler is not None and not (gear_change and code.number in gears.GEAR_M):
            functions.append(code.handler(channel, state, block, code))
    if "H" in used:
        functions.append(number_function(block, "H", MAX_H))
    return tuple(functions)


def number_function(block: NcBlock, letter: str, limit: int) -> AuxiliaryFunction:
    """T, D or H with its integer number."""
    value = block.words[letter]
    if value < 0 or value > limit or value != int(value):
        column = block.source.column(letter)
        raise faults.NOT_AN_INTEGER.at(block.source, column, word=letter, value=number(value), limit=limit)
    return AuxiliaryFunction(letter, int(value), value=function_value(block, code_name(letter, int(value))))


def free_m(channel: Channel, state: ModalState, block: NcBlock, code: MCode) -> Function:
    """An M function without a meaning in the language: it goes to the PLC."""
    return AuxiliaryFunction("M", code.number, value=function_value(block, code.name))


def function_value(block: NcBlock, name: str) -> float:
    """The value that a function passes to the PLC (M52=-345), 0 without one."""
    return block.values.get(name, 0.0) if block.values else 0.0
