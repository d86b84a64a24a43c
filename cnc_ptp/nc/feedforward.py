"""Feedforward in programs: G135 (on), G137 (off), G136 (weights) for the axes, `S[G135 G136=90]` for a spindle.

Source: TF5200 feedforward 3. The weights are percent; they and the selection are kept until they are programmed again.
"""

import re
from collections.abc import Iterator
from typing import Final

from cnc_ptp.errors import Value
from cnc_ptp.nc import faults, motions
from cnc_ptp.nc.canonical import AxisFeedforward, Function, Source, SpindleFeedforward, number
from cnc_ptp.nc.lexer import NUMBER, Token
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, GCode, NcBlock

ON: Final = 135
WEIGHTS: Final = 136
OFF: Final = 137
SELECTION = "feedforward"

_BRACKET = re.compile(r"G\s*=?\s*0*13[567](?!\d)", re.ASCII)
_WORD = re.compile(r"\s*G\s*=?\s*0*(13[567])(?!\d)(?:\s*=\s*([^\sA-Z]*))?", re.ASCII)
_NUMBER = re.compile(NUMBER, re.ASCII)


def block_function(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[Function, ...]:
    """G135, G136 and G137 of a block as one function for the channel's axes, made at the first of them.

    With G136 the axis words are weights, so no path function can be in the block (21092). Raises 21090, 21091 for
    weights below 0 % and for a G136 without an axis; weights above 100 % are limited where they act, with a warning.
    """
    codes = [other for other in block.codes if other.number in (ON, WEIGHTS, OFF)]
    if code is not codes[0]:
        return ()
    selected = next((other.number for other in codes if other.number != WEIGHTS), None)
    with_weights = next((other for other in codes if other.number == WEIGHTS), None)
    weights = _weights(channel, state, block, with_weights) if with_weights else ()
    return (AxisFeedforward(None if selected is None else selected == ON, weights),)


def _weights(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[tuple[str, float], ...]:
    path = next((other for other in block.codes if other.motion is not None), None)
    if path is not None:
        raise faults.WEIGHTS_AND_MOTION.at(block.source, block.source.column(path.name), g=path.name)
    if motions.target_of(channel, state, block, code) is None:
        raise faults.WEIGHTS_WITHOUT_AXIS.at(block.source, block.source.column(code.name))
    weights = tuple((word, value) for word, value in block.words.items() if word in channel.axis_index)
    for axis, value in weights:
        if value < 0.0:
            column = block.source.column(axis)
            raise faults.WEIGHT_RANGE.at(block.source, column, value=number(value), unit=f"axis {axis}")
    return weights


def is_in(token: Token) -> bool:
    """True for brackets with feedforward words."""
    return _BRACKET.search(token.text) is not None


def bracket(token: Token, source: Source) -> SpindleFeedforward:
    """The words in a spindle's brackets: G135 or G137, and G136=weight; nothing else.

    Raises 21093 for other words, 21003 for a value that is not a number, 21012 and 21042 for words that exclude each
    other or come twice, 21090 for the weight, 21094 for a G136 without and 21095 for a G135 or G137 with a value.
    """
    found: dict[int, float] = {}
    for code, value, column in _codes(token, source):
        fault = _fault(token.name, found, code, value)
        if fault is not None:
            raise fault[0].at(source, column, **fault[1])
        found[code] = 0.0 if value is None else value
    selected = next((code for code in found if code != WEIGHTS), None)
    return SpindleFeedforward(token.name, None if selected is None else selected == ON, found.get(WEIGHTS))


def _codes(token: Token, source: Source) -> Iterator[tuple[int, float | None, int]]:
    """Code, value and column of each word."""
    begin = token.column + token.shown.index("[") + 1
    position, length = 0, len(token.text.rstrip())
    while position < length:
        match = _WORD.match(token.text, position)
        rest = token.text[position:]
        column = begin + position + len(rest) - len(rest.lstrip())
        if match is None:
            raise faults.FEEDFORWARD_ALONE.at(source, column, word=rest.split()[0], spindle=token.name)
        if match[2] is not None and _NUMBER.fullmatch(match[2]) is None:
            raise faults.BAD_NUMBER.at(source, column, word=match[0].strip())
        yield int(match[1]), None if match[2] is None else float(match[2]), column
        position = match.end()


def _fault(
    spindle: str, found: dict[int, float], code: int, value: float | None
) -> tuple[faults.Fault, dict[str, Value]] | None:
    """The fault of a word after the words `found`, and the values for its text."""
    rival = next((other for other in found if other != WEIGHTS), None)
    if code in found:
        return faults.TWICE, {"word": f"G{code}"}
    if code == WEIGHTS and value is None:
        return faults.WEIGHT_MISSING, {"spindle": spindle}
    if code == WEIGHTS and value is not None and value < 0.0:
        return faults.WEIGHT_RANGE, {"value": number(value), "unit": f"spindle {spindle}"}
    if code != WEIGHTS and value is not None:
        return faults.SELECTION_WITH_VALUE, {"g": f"G{code}", "spindle": spindle}
    if code != WEIGHTS and rival is not None:
        return faults.SAME_GROUP, {"first": f"G{rival}", "second": f"G{code}", "group": SELECTION}
    return None
