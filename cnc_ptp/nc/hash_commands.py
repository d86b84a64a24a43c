"""Commands that start with #, alone in their block: #MAIN SPINDLE, #EXPL SYN, #SLOPE, couplings of spindles (#AX LINK).

A new command is a new row of COMMANDS. TF5200 spindle 2.2.3, 2.5, 2.8.3; #SLOPE and the spelling are those of the
vendor's programming manual.
"""

import re
from collections.abc import Callable

from cnc_ptp.nc import (
    c_axis,
    faults,
    messages,
    spindle_faults,
    spindle_links,
    thread_retract,
    transformations,
    transitions,
    turning_faults,
)
from cnc_ptp.nc.canonical import (
    AVAILABLE_SLOPES,
    SLOPES,
    ExplicitSynchronisation,
    Function,
    MachineData,
    Timer,
    WaitForPath,
)
from cnc_ptp.nc.coordinates import commands
from cnc_ptp.nc.expressions.nodes import SelfDefined
from cnc_ptp.nc.expressions.readable import LAST_TIMER
from cnc_ptp.nc.expressions.reader import ExpressionReader
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.flow.lines import Line
from cnc_ptp.nc.flow.statements import Declarations, Delete, EndOfModalCall, Mark
from cnc_ptp.nc.lexer import NUMBER
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, HashCommand, NcBlock
from cnc_ptp.nc.spindles import current_main, name_of, names
from cnc_ptp.nc.tools import tool_commands

Run = Callable[[Channel, ModalState, NcBlock, HashCommand], tuple[Function, ...]]

_ARGUMENTS = re.compile(r"\s*(?:\[\s*NBR\s*\]\s*)?(?:\[(.*)\])?\s*(.*)", re.ASCII)
"""[NBR] says that spindles are given by number; that is recognised anyway."""
_SLOPE = re.compile(r"TYPE\s*=\s*(\w+)(?:\s+NO_OPT\s*=\s*[01])?", re.ASCII)
"""NO_OPT limits the computation for the use of the jerk; here the jerk is always used in full."""
_TIMER_ACTION = re.compile(r"#\s*TIMER\b\s*([^\s\[]*)", re.ASCII)
_TIMER = re.compile(r"ID\s*=?\s*(\d{1,3})", re.ASCII)
_MACHINE_DATA = re.compile(
    rf"""(?:AX\s*=\s*(?P<axis>[A-Z_][A-Z0-9_]*)|AXNR\s*=?\s*(?P<number>\d{{1,5}}))[\s,]+
    (?:(?P<id>P-AXIS-\d{{5}}(?:\.\d{{1,4}})*)\s*=\s*(?P<value>{NUMBER})
    |AXPARAM\s*=?\s*"\s*(?P<name>[^"\s]+)\s+(?P<given>{NUMBER})\s*")(?P<wait>[\s,]+WAIT)?""",
    re.ASCII | re.VERBOSE,
)


def hash_line(line: Line, text: str, begin: int, outside: str) -> bool:
    """Reads a normalised line with a command; False if it has no known command (the tokens say why).

    `outside`: the same with blanks in place of texts.
    """
    found = _COMMAND.search(outside, begin)
    if found is None:
        _check_timer(line, outside, begin)
        return False
    name = " ".join(found[1].split())
    shown = "#" + name
    words = text[begin : found.start()].strip()
    if words:
        column = begin + len(text[begin:]) - len(text[begin:].lstrip()) + 1
        raise spindle_faults.COMMAND_NOT_ALONE.at(line.source, column, command=shown, word=words)
    statement = STATEMENTS.get(name)
    if statement is not None:
        statement(line, text, found.end(), found.start() + 1)
        return True
    rest = _ARGUMENTS.match(text, found.end())
    assert rest is not None
    if rest[2]:
        column = rest.start(2) + 1
        raise spindle_faults.COMMAND_NOT_ALONE.at(line.source, column, command=shown, word=rest[2].strip())
    arguments = None if rest[1] is None else split_arguments(rest[1])
    command = HashCommand(name, arguments, found.start() + 1, COMMANDS[name])
    line.block = NcBlock(line.source, (), {}, command=command)
    return True


def _check_timer(line: Line, text: str, begin: int) -> None:
    """Raises ProgramError for a #TIMER without one of its four actions."""
    found = _TIMER_ACTION.search(text, begin)
    if found is None:
        return
    syntax = "#TIMER START [ID=1], with START, STOP, READ or CLEAR"
    if not found[1]:
        column = found.start() + 1
        raise flow_faults.COMMAND_VALUE.at(line.source, column, command="#TIMER", missing="an action", syntax=syntax)
    raise flow_faults.COMMAND_SYNTAX.at(line.source, found.start(1) + 1, word=found[1], command="#TIMER", syntax=syntax)


def _nothing_behind(line: Line, text: str, end: int, command: str) -> None:
    rest = text[end:].strip()
    if rest:
        raise spindle_faults.COMMAND_NOT_ALONE.at(line.source, text.index(rest, end) + 1, command=command, word=rest)


def _variables(line: Line, text: str, end: int, column: int) -> None:
    """#VAR: the lines up to #ENDVAR declare variables."""
    _nothing_behind(line, text, end, "#VAR")
    line.statement = Declarations(column)


def _end_of_variables(line: Line, text: str, end: int, column: int) -> None:
    raise flow_faults.SECTION_STRAY.at(line.source, column, begin="#VAR", end="#ENDVAR")


def _comment(line: Line, text: str, end: int, column: int) -> None:
    line.comment = True
    line.statement = Mark(column)


def _end_of_comment(line: Line, text: str, end: int, column: int) -> None:
    raise flow_faults.SECTION_STRAY.at(line.source, column, begin="#COMMENT BEGIN", end="#COMMENT END")


def _delete(line: Line, text: str, end: int, column: int) -> None:
    """#DELETE V.P.A, V.L.B."""
    reader = ExpressionReader(text, line.source, end)
    names: list[tuple[str, int]] = []
    while True:
        begin = reader.skip_blanks()
        target = reader.target()
        if not isinstance(target, SelfDefined) or target.indices:
            raise flow_faults.DECLARATION.at(line.source, begin + 1, word=text[begin:].strip())
        names.append((target.name, begin + 1))
        if not reader.follows(","):
            break
    _nothing_behind(line, text, reader.at, "#DELETE")
    line.statement = Delete(column, names)


def split_arguments(text: str) -> tuple[str, ...]:
    """The parts between commas."""
    return tuple(part.strip() for part in text.split(","))


def main_spindle(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#MAIN SPINDLE [name or logical axis number]; without one, that of P-CHAN-00051 is the main spindle again."""
    if not channel.table.spindles:
        raise faults.NO_SPINDLE.at(block.source, command.column, word="#MAIN SPINDLE")
    if command.arguments is None:
        key = channel.table.spindles[0].key
    elif len(command.arguments) != 1 or not command.arguments[0]:
        raise arguments_fault(block, command, "#MAIN SPINDLE [name or logical axis number]")
    else:
        key = _spindle_key(channel, state, block, command, command.arguments[0])
    first = channel.table.spindles[0]
    if key != first.key and first.own_name == channel.table.main_name:
        raise spindle_faults.MAIN_WITHOUT_NAME.at(
            block.source, command.column, spindle=first.own_name, other=name_of(channel, state, key)
        )
    spindle_links.check_main(channel, state, block, command, key)
    if state.turning.facing >= 0 and key != current_main(channel, state).key:
        raise turning_faults.MAIN_SPINDLE.at(block.source, command.column)
    state.spindle.main = key
    return ()


def _spindle_key(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand, argument: str) -> str:
    """A spindle by its own name, the main one also by the name of the main spindle, or by number."""
    spindles = channel.table.spindles
    if argument.isdecimal():
        key = next((spindle.key for spindle in spindles if spindle.number == int(argument) > 0), None)
        if key is None:
            known = ", ".join(str(spindle.number) for spindle in spindles if spindle.number) or "none"
            raise spindle_faults.MAIN_SPINDLE_NUMBER.at(block.source, command.column, number=argument, known=known)
        return key
    if argument == channel.table.main_name:
        return current_main(channel, state).key
    key = next((spindle.key for spindle in spindles if spindle.own_name == argument), None)
    if key is None:
        known = ", ".join(names(channel, state))
        raise faults.SPINDLE_UNKNOWN.at(block.source, command.column, word=argument, known=known)
    return key


def explicit_synchronisation(
    channel: Channel, state: ModalState, block: NcBlock, command: HashCommand
) -> tuple[Function, ...]:
    """#EXPL SYN."""
    if command.arguments is not None:
        raise arguments_fault(block, command, "without arguments")
    return (ExplicitSynchronisation(),)


def flush(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#FLUSH, #FLUSH WAIT: the path stands before the next block; with WAIT also before that is interpreted."""
    if command.arguments is not None:
        raise arguments_fault(block, command, "without arguments")
    return (WaitForPath(),)


def flush_continue(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#FLUSH CONTINUE: no block waits for blocks behind it here."""
    if command.arguments is not None:
        raise arguments_fault(block, command, "without arguments")
    return ()


def slope(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#SLOPE [TYPE=STEP], [TYPE=TRAPEZ], [TYPE=SIN2]: for the motions of the blocks after it."""
    words = _SLOPE.fullmatch(",".join(command.arguments or ()))
    available = " or ".join(f"[TYPE={name}]" for name in AVAILABLE_SLOPES)
    if words is None:
        raise arguments_fault(block, command, f"{available}, or #SLOPE DEFAULT")
    if words[1] not in AVAILABLE_SLOPES:
        fault = faults.SLOPE_NOT_AVAILABLE if words[1] in SLOPES.values() else faults.SLOPE_UNKNOWN
        raise fault.at(block.source, command.column, slope=words[1], known=", ".join(AVAILABLE_SLOPES))
    state.slope = words[1]
    return ()


def default_slope(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#SLOPE DEFAULT: that of P-CHAN-00071 again."""
    if command.arguments is not None:
        raise arguments_fault(block, command, "without arguments")
    state.slope = ""
    return ()


def timer(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#TIMER START [ID=1], also with SYN: all of them act when the path reaches the block."""
    found = _TIMER.fullmatch(",".join(command.arguments or ()))
    if found is None or int(found[1]) > LAST_TIMER:
        raise arguments_fault(block, command, f"with [ID=0] to [ID={LAST_TIMER}]")
    return (Timer(command.name.split()[1], int(found[1])),)


def machine_data(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#MACHINE DATA [AX=X P-AXIS-00099.0=5000], [AXNR=1 AXPARAM="getriebe[0].kv 5000"]; SYN acts as without it.

    The path stands until the axis has the new value, so WAIT, which needs SYN, says nothing new.
    """
    found = _MACHINE_DATA.fullmatch(",".join(command.arguments or ()))
    if found is None:
        raise arguments_fault(block, command, '[AX=X P-AXIS-00099.0=5000] or [AX=X AXPARAM="getriebe[0].kv 5000"]')
    if found["wait"] and not command.name.endswith("SYN"):
        raise faults.WAIT_WITHOUT_SYN.at(block.source, block.source.place_of("WAIT"))
    axis = found["axis"]
    if axis and axis not in channel.axes:
        known = ", ".join(channel.axes) or "none"
        raise faults.AXIS_UNKNOWN.at(block.source, block.source.place_of(f"={axis}"), word=axis, known=known)
    parameter, value = found["id"] or found["name"], float(found["value"] or found["given"])
    return (MachineData(axis or str(int(found["number"])), parameter, value),)


def arguments_fault(block: NcBlock, command: HashCommand, syntax: str) -> faults.ProgramError:
    """The error for a command with wrong syntax."""
    return spindle_faults.COMMAND_ARGUMENTS.at(block.source, command.column, command=f"#{command.name}", syntax=syntax)


COMMANDS: dict[str, Run] = {
    "MAIN SPINDLE": main_spindle,
    "EXPL SYN": explicit_synchronisation,
    "SET AX LINK": spindle_links.define,
    "ENABLE AX LINK": spindle_links.enable,
    "AX LINK ON": spindle_links.enable,
    "DISABLE AX LINK": spindle_links.disable,
    "AX LINK OFF ALL": spindle_links.disable_all,
    "AX LINK OFF": spindle_links.disable,
    "AX LINK": spindle_links.define,
    "SLOPE DEFAULT": default_slope,
    "SLOPE": slope,
    "CAX OFF": c_axis.end,
    "CAX": c_axis.begin,
    "FACE OFF": transformations.off,
    "FACE": transformations.face,
    "CYL OFF": transformations.off,
    "CYL": transformations.cylinder,
    "FLUSH": flush,
    "FLUSH WAIT": flush,
    "FLUSH CONTINUE": flush_continue,
    "MACHINE DATA": machine_data,
    "MACHINE DATA SYN": machine_data,
    **{f"TIMER {action}{mode}": timer for action in ("START", "STOP", "READ", "CLEAR") for mode in ("", " SYN")},
}


def _disable_modal_cycle(line: Line, text: str, end: int, column: int) -> None:
    _nothing_behind(line, text, end, "#DISABLE MODAL CYCLE")
    line.statement = EndOfModalCall(column)


STATEMENTS: dict[str, Callable[[Line, str, int, int], None]] = {
    "VAR": _variables,
    "ENDVAR": _end_of_variables,
    "DELETE": _delete,
    "DISABLE MODAL CYCLE": _disable_modal_cycle,
    "MSG": messages.read_message,
    "ERROR": messages.read_error,
    "ROTATION": commands.read_rotation,
    "SCALE": commands.read_scale,
    "CS": commands.read_system,
    "ACS": commands.read_system,
    "MCS": commands.read_machine_coordinates,
    "PSET": commands.read_preset,
    "PRESET": commands.read_preset,
    "THREAD RETRACT": thread_retract.read_thread_retract,
    "TOOL DATA": tool_commands.read_tool_data,
    "TOOL PREP": tool_commands.read_tool_preparation,
    "CONTOUR MODE": transitions.read_contour_mode,
    "HSC": transitions.read_smoothing,
    "COMMENT BEGIN": _comment,
    "COMMENT END": _end_of_comment,
}
"""Commands that change the order of execution or the variables: line, its text, place behind the command, column."""
_NAMES = sorted([*COMMANDS, *STATEMENTS], key=len, reverse=True)
_COMMAND = re.compile(r"#\s*(" + "|".join(name.replace(" ", r"\s+") for name in _NAMES) + r")\b", re.ASCII)
