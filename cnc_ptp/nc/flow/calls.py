"""Calls of subroutines: `LL name`, `L name`, `L CYCLE [NAME=name @P1=5]`."""

from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.flow import flow_faults as faults
from cnc_ptp.nc.flow.lines import Call
from cnc_ptp.nc.lexer import Token

MODAL = ("MODAL_MOVE", "MODAL_BLOCK")


def call_of(token: Token, source: Source) -> Call:
    """The call of a token. Raises ProgramError for a parameter that is given twice."""
    arguments: dict[str, Node] = {}
    for name, value in token.arguments:
        if name in arguments:
            raise faults.ARGUMENT_TWICE.at(source, value.column, name=f"@{name}")
        arguments[name] = value
    return Call(token.name, token.column, local=token.text != "L", arguments=arguments, cycle=bool(token.arguments))
