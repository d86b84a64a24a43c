"""Lines between #VAR and #ENDVAR: `V.P.DEPTH = 5`, `V.L.NAME : STRING[20] = "top"`, `V.P.F[2][3] = [1, 2, 3]`."""

import re
from typing import Final

from cnc_ptp.nc.expressions.nodes import ComputedParameter, Constant, Node, Parameter, SelfDefined, Text
from cnc_ptp.nc.expressions.reader import ExpressionReader
from cnc_ptp.nc.expressions.values import INTEGERS
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.flow.lines import Line
from cnc_ptp.nc.flow.statements import Declaration
from cnc_ptp.nc.lexer import normalise

TYPES: Final = (*INTEGERS, "REAL64", "STRING")
LONGEST_STRING: Final = 126
_TYPE = re.compile(r"\s*:\s*([A-Z][A-Z0-9]*)", re.ASCII)
_BLOCK_NUMBER = re.compile(r"\s*N\s*\d{1,9}(?![\d.])", re.ASCII)


def declaration_of(line: Line) -> Declaration | None:
    """The declaration of a line; None for an empty one. Raises ProgramError."""
    text = normalise(line.source)
    number = _BLOCK_NUMBER.match(text)
    reader = ExpressionReader(text, line.source, number.end() if number else 0)
    begin = reader.skip_blanks()
    if begin >= len(text.rstrip()):
        return None
    target = reader.target()
    if isinstance(target, SelfDefined):
        name, sizes = target.name, list(target.indices)
    elif isinstance(target, ComputedParameter) and isinstance(target.index, Constant):
        name, sizes = f"P{target.index.constant:.0f}", list(target.indices)
    elif isinstance(target, Parameter):
        name, sizes = f"P{target.index}", []
    else:
        raise flow_faults.DECLARATION.at(line.source, begin + 1, word=text[begin:].split()[0])
    type_name, longest = _type(reader, line)
    values: list[Node] = []
    if reader.follows("="):
        if sizes:
            if not reader.follows("["):
                raise flow_faults.DECLARATION_LIST.at(line.source, reader.at + 1, name=name)
            values = reader.items()
        else:
            values = [reader.expression()]
            if not type_name and isinstance(values[0], Text):
                type_name = "STRING"
    if reader.skip_blanks() < len(text.rstrip()):
        raise flow_faults.WORDS_AFTER.at(line.source, reader.at + 1, word=reader.word(), keyword="a declaration")
    line.synchronises = reader.synchronises
    return Declaration(begin + 1, name, sizes, values, type=type_name, longest=longest)


def _type(reader: ExpressionReader, line: Line) -> tuple[str, int]:
    """The type that the line gives, "" for none, and the length of a text."""
    found = _TYPE.match(reader.line, reader.at)
    if found is None:
        return "", 0
    if found[1] not in TYPES:
        known = ", ".join(TYPES)
        raise flow_faults.TYPE_UNKNOWN.at(line.source, found.start(1) + 1, word=found[1], known=known)
    reader.at = found.end()
    if found[1] != "STRING":
        return found[1], 0
    begin = reader.at
    if not reader.follows("["):
        raise flow_faults.STRING_LENGTH.at(line.source, begin + 1, limit=LONGEST_STRING)
    (length, *more) = reader.items()
    if more or not isinstance(length, Constant) or not 1.0 <= length.constant <= LONGEST_STRING:
        raise flow_faults.STRING_LENGTH.at(line.source, begin + 1, limit=LONGEST_STRING)
    return found[1], int(length.constant)
