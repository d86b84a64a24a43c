"""Calls of subroutines: `LL name`, `L name`, `L CYCLE [NAME=name @P1=5]`."""

from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.flow import flow_faults as faults
from cnc_ptp.nc.flow.lines import Call
from cnc_ptp.nc.lexer import Token


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
    return Call(token.name, token.column, arguments, local=local, cycle=bool(cycle), modal=modal)
