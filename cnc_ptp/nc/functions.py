"""M, S, T and D of a block -> canonical functions."""

from cnc_ptp.nc import faults, gears
from cnc_ptp.nc.canonical import AuxiliaryFunction, Function, number
from cnc_ptp.nc.program import Channel, MCode, ModalState, NcBlock
from cnc_ptp.nc.spindles import spindle_functions

MAX_TOOL = 999_999_999


def block_functions(channel: Channel, state: ModalState, block: NcBlock) -> tuple[Function, ...]:
    """All functions of a block in the order T, D, main spindle, other spindles, free M; keeps speeds in the state."""
    functions: list[Function] = [tool_function(block, letter) for letter in "TD" if letter in block.words]
    functions += spindle_functions(channel, state, block)
    gear_change = channel.table.gear_change
    for code in block.m:
        if code.handler is not None and not (gear_change and code.number in gears.GEAR_M):
            functions.append(code.handler(channel, state, block, code))
    return tuple(functions)


def tool_function(block: NcBlock, letter: str) -> AuxiliaryFunction:
    """T or D with its integer number."""
    value = block.words[letter]
    if value < 0 or value > MAX_TOOL or value != int(value):
        column = block.source.column(letter)
        raise faults.NOT_AN_INTEGER.at(block.source, column, word=letter, value=number(value), limit=MAX_TOOL)
    return AuxiliaryFunction(letter, int(value))


def free_m(channel: Channel, state: ModalState, block: NcBlock, code: MCode) -> Function:
    """An M function without a meaning in the language: it goes to the PLC."""
    return AuxiliaryFunction("M", code.number)
