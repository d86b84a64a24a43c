"""Calls of subroutines: `LL name`, `L name`, `L CYCLE [NAME=name @P1=5]`."""

import re
from typing import Final

from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow import flow_faults as faults
from cnc_ptp.nc.flow.lines import Call, Line
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.flow.statements import Declarations
from cnc_ptp.nc.flow.structures import Place
from cnc_ptp.nc.lexer import Token, normalise

_READ = re.compile(r"@\s*([A-Z]\w*+)(?!\s*=(?!=))", re.ASCII)
"""@P1, but not @P1=5, which gives it to a call."""
_NUMBERED = re.compile(r"P\d+", re.ASCII)
ANY_NUMBER: Final = "P"
"""From V.G.@P[number].VALID: any of @P1, @P2 ... may be meant."""


def call_of(token: Token, source: Source) -> Call:
    """The call of a token. Raises ProgramError for a parameter that is given twice, and for a name with a folder."""
    scope, *cycle = token.text.split()
    arguments: dict[str, Node] = {}
    for name, value in token.arguments:
        if name in arguments:
            raise faults.ARGUMENT_TWICE.at(source, value.column, name=f"@{name}")
        arguments[name] = value
    local = scope == "LL"
    if not local and ("/" in token.name or "\\" in token.name or token.name.startswith(".")):
        raise faults.FILE_FOLDER.at(source, token.column, name=token.name)
    modal = cycle[1] if len(cycle) > 1 else ""
    by_code = scope == "G"
    return Call(token.name, token.column, arguments, local=local, cycle=bool(cycle), modal=modal, by_code=by_code)


def check_arguments(call: Call, source: Source, program: Program, place: Place) -> None:
    """The called lines, which begin at `place`, read what the call gives. Raises ProgramError for what they do not."""
    read = arguments_read(program, place)
    for name, value in call.arguments.items():
        if name not in read and not (ANY_NUMBER in read and _NUMBERED.fullmatch(name)):
            known = ", ".join(f"@{each}" for each in sorted(read, key=lambda each: (len(each), each))) or "none"
            raise faults.ARGUMENT_UNREAD.at(source, value.column, name=f"@{name}", program=call.name, known=known)


def arguments_read(program: Program, place: Place) -> frozenset[str]:
    """Names of the @ parameters in a main program or subroutine, from its first line on."""
    known = program.arguments_read.get(place.line)
    if known is None:
        known = program.arguments_read[place.line] = _arguments_from(program, place)
    return known


def _arguments_from(program: Program, place: Place) -> frozenset[str]:
    names: set[str] = set()
    number, offset = place.line, place.offset
    while offset >= 0:
        line = program.line(number, offset)
        if line.header:
            break
        names |= _read_in(line)
        if isinstance(line.statement, Declarations):
            for declared, _ in line.statement.lines:
                names |= _read_in(declared)
        number, offset = line.next_number, line.next_offset
    return frozenset(names)


def _read_in(line: Line) -> set[str]:
    if "@" not in line.source.text:
        return set()
    try:
        text = normalise(line.source)
    except ProgramError:
        text = line.source.text.upper()  # its error is reported, none of its callers besides
    return set(_READ.findall(text))
