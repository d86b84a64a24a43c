"""M, S, T and D of a block -> canonical functions; the handlers that the M table names."""

from cnc_ptp.nc import faults
from cnc_ptp.nc.canonical import AuxiliaryFunction, Function, SpindleFunction, number
from cnc_ptp.nc.lexer import column_of
from cnc_ptp.nc.program import Block, Channel, MCode, ModalState, SpindleWords

MAX_TOOL = 999_999_999


def block_functions(channel: Channel, state: ModalState, block: Block) -> tuple[Function, ...]:
    """All functions of a block in the order T, D, main spindle, other spindles, free M; keeps speeds in the state."""
    functions: list[Function] = [tool_function(block, letter) for letter in "TD" if letter in block.words]
    in_order = sorted(block.m, key=lambda code: code.group != "spindle")
    spindle_m = [code for code in in_order if code.group == "spindle"]
    if "S" in block.words and not spindle_m:
        name = main_spindle(channel, block, "S")
        functions.append(spindle_function(state, block, SpindleWords(name, None, block.words["S"]), "S"))
    functions += [code.handler(channel, state, block, code) for code in spindle_m if code.handler is not None]
    functions += _bracketed(channel, state, block, functions)
    others = [code for code in in_order if code.group != "spindle" and code.handler is not None]
    functions += [code.handler(channel, state, block, code) for code in others if code.handler is not None]
    return tuple(functions)


def tool_function(block: Block, letter: str) -> AuxiliaryFunction:
    """T or D with its integer number."""
    value = block.words[letter]
    if value < 0 or value > MAX_TOOL or value != int(value):
        column = column_of(block.source, letter)
        raise faults.NOT_AN_INTEGER.at(block.source, column, word=letter, value=number(value), limit=MAX_TOOL)
    return AuxiliaryFunction(letter, int(value))


def free_m(channel: Channel, state: ModalState, block: Block, code: MCode) -> Function:
    """An M function without a meaning in the language: it goes to the PLC."""
    return AuxiliaryFunction("M", code.number)


def rotation(channel: Channel, state: ModalState, block: Block, code: MCode) -> Function:
    """M03, M04, M05 in DIN syntax: for the main spindle, with the block's S word."""
    name = main_spindle(channel, block, code.name)
    words = SpindleWords(name, code.number, block.words.get("S"))
    return spindle_function(state, block, words, "S" if "S" in block.words else code.name)


def main_spindle(channel: Channel, block: Block, word: str) -> str:
    """Name of the main spindle."""
    if not channel.spindles:
        raise faults.NO_SPINDLE.at(block.source, column_of(block.source, word), word=word)
    return channel.spindles[0]


def spindle_function(state: ModalState, block: Block, words: SpindleWords, place: str) -> SpindleFunction:
    """One spindle's function; a given speed is stored, M3 and M4 without one take the stored speed.

    `place` is the word that an error points at.
    """
    name, m, speed = words
    if speed is not None:
        if speed < 0.0:
            column = column_of(block.source, place)
            raise faults.SPEED_NEGATIVE.at(block.source, column, value=number(speed), spindle=name)
        state.speeds[name] = speed
    if m == 5:
        return SpindleFunction(name, 5, None)
    stored = state.speeds.get(name)
    if stored is None:
        column = column_of(block.source, place)
        raise faults.SPEED_MISSING.at(block.source, column, m=f"{m:02d}", spindle=name)
    return SpindleFunction(name, m, stored)


def _bracketed(channel: Channel, state: ModalState, block: Block, before: list[Function]) -> list[SpindleFunction]:
    used = {function.spindle for function in before if isinstance(function, SpindleFunction)}
    functions: list[SpindleFunction] = []
    for words in block.spindles:
        column = column_of(block.source, words.name)
        if words.name not in channel.spindles:
            known = ", ".join(channel.spindles) or "none"
            raise faults.SPINDLE_UNKNOWN.at(block.source, column, word=words.name, known=known)
        if words.name in used:
            raise faults.SPINDLE_TWICE.at(block.source, column, spindle=words.name)
        used.add(words.name)
        functions.append(spindle_function(state, block, words, words.name))
    return functions
