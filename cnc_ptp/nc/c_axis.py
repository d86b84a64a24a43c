"""The main spindle as an axis of the path: #CAX [S, C], #CAX, #CAX OFF (TF5200 spindle 2.3.3, 2.8.8).

Its name is that of P-CHAN-00010, its place is behind the axes of the channel. Where it stands is known when the path
has taken it over, so the interpreter waits for that.
"""

from __future__ import annotations

from typing import Final

from cnc_ptp.nc import c_axis_faults as own
from cnc_ptp.nc import faults, feedforward, spindle_faults, tapping, turning
from cnc_ptp.nc.canonical import (
    CompensationSwitch,
    Function,
    GearChange,
    LinearMove,
    Motion,
    SpindleAxis,
    SpindleCommand,
    SpindleFunction,
    SpindleLink,
)
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, GCode, HashCommand, NcBlock, Spindle
from cnc_ptp.nc.spindles import current_main, names

CAX: Final = "[S, C], or #CAX, #CAX OFF"
HOMING: Final = 74
THREADS: Final = (33, 34, 35)
AXIS_CODES: Final = (HOMING, 100, 31, 28)
"""Path functions that move axes as such: homing, measuring, reference points."""
TOOL_WORDS: Final = ("D", "T")
"""Their offsets are in axes."""


def begin(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#CAX: the gear of P-AXIS-00052 first, then the spindle becomes an axis of the path where it stands."""
    source, column = block.source, command.column
    spindle = _spindle(channel, state, block, command)
    if state.c_axis:
        raise own.C_AXIS_ON.at(source, column, axis=channel.table.c_axis)
    if not spindle.positioned:
        raise spindle_faults.TAPPING_WITHOUT_POSITION.at(source, column, g="#CAX", spindle=spindle.key)
    if spindle.key in state.spindle.turning:
        raise own.C_AXIS_TURNS.at(source, column, spindle=spindle.key)
    for group in state.spindle.active:
        if any(spindle.key in (pair.slave, pair.master) for pair in state.spindle.links[group]):
            raise own.C_AXIS_COUPLED.at(source, column, spindle=spindle.key, group=group)
    state.c_axis = spindle.key
    gear: tuple[Function, ...] = ()
    if spindle.path_gear and state.spindle.gears.get(spindle.key, spindle.gear) != spindle.path_gear:
        state.spindle.gears[spindle.key] = spindle.path_gear
        gear = (GearChange(spindle.key, spindle.path_gear),)
    return (*gear, SpindleAxis(spindle.key, True))


def _spindle(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> Spindle:
    """The main spindle. Raises ProgramError for another one, and for another name of the axis than P-CHAN-00010."""
    source, column, axis = block.source, command.column, channel.table.c_axis
    if not channel.table.spindles:
        raise faults.NO_SPINDLE.at(source, column, word="#CAX")
    if not axis:
        raise own.NO_C_AXIS.at(source, column)
    main = current_main(channel, state)
    arguments = command.arguments
    if arguments is None:
        return main
    if len(arguments) != 2:
        raise spindle_faults.COMMAND_ARGUMENTS.at(source, column, command="#CAX", syntax=CAX)
    spindle, name = arguments
    known = names(channel, state)
    if spindle not in known:
        raise faults.SPINDLE_UNKNOWN.at(source, column, word=spindle, known=", ".join(known))
    if known[spindle] is not main:
        raise own.NOT_MAIN.at(source, column, spindle=spindle, main=channel.table.main_name)
    if name != axis:
        raise own.C_AXIS_NAME.at(source, column, name=name, axis=axis)
    return main


def end(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    """#CAX OFF: the spindle stands where the path has brought it."""
    if command.arguments is not None:
        raise spindle_faults.COMMAND_ARGUMENTS.at(block.source, command.column, command="#CAX", syntax=CAX)
    if not state.c_axis:
        raise own.C_AXIS_NOT_ON.at(block.source, command.column)
    kinematics = state.coordinates.kinematics
    if kinematics is not None:
        raise own.NOT_WITH_KINEMATICS.at(block.source, command.column, word="#CAX OFF", command=kinematics.name)
    spindle, state.c_axis = state.c_axis, ""
    return (SpindleAxis(spindle, False),)


def check_words(channel: Channel, state: ModalState, block: NcBlock, path: GCode) -> None:
    """Raises ProgramError for words of the C axis without #CAX, for G74 of it, for threads and G96 beside it."""
    axis, column = channel.table.c_axis, block.source.column
    if axis in block.words:
        if path.number == HOMING:
            raise own.C_AXIS_HOMING.at(block.source, column(axis), axis=axis, spindle=channel.table.main_name)
        if not state.c_axis:
            raise own.C_AXIS_OFF.at(block.source, column(axis), axis=axis)
    controlled = any(code.number == feedforward.WEIGHTS for code in block.codes) and axis in block.words
    if controlled or any(isinstance(each, CompensationSwitch) and each.axis == axis for each in block.controls):
        spindle = channel.table.main_name
        raise own.C_AXIS_CONTROL.at(block.source, column(axis), axis=axis, spindle=spindle)
    if state.c_axis and (path.number in tapping.CODES or path.number in THREADS):
        raise _taken(channel, state, block, path.name)
    if state.c_axis and any(code.number == turning.CONSTANT for code in block.codes):
        raise _taken(channel, state, block, f"G{turning.CONSTANT}")
    kinematics = state.coordinates.kinematics
    if kinematics is not None:
        word = path.name if path.number in AXIS_CODES else next((w for w in TOOL_WORDS if w in block.words), "")
        if word:
            raise own.NOT_WITH_KINEMATICS.at(block.source, column(word), word=word, command=kinematics.name)


def check_functions(channel: Channel, state: ModalState, block: NcBlock, functions: tuple[Function, ...]) -> None:
    """Raises ProgramError for a function of the spindle that is an axis of the path."""
    for function in functions:
        if isinstance(function, (SpindleFunction, SpindleCommand, GearChange)):
            if function.spindle == state.c_axis:
                raise _taken(channel, state, block, _word(block))
        elif isinstance(function, SpindleLink) and state.c_axis in (function.slave, function.master):
            raise _taken(channel, state, block, _word(block))


def check_motion(channel: Channel, block: NcBlock, motion: Motion) -> None:
    """Raises ProgramError for a measuring run that moves the C axis: a spindle has no probe."""
    place = len(channel.axes) - 1
    if isinstance(motion, LinearMove) and place in motion.measures:
        axis = channel.table.c_axis
        raise own.C_AXIS_MEASURES.at(block.source, block.source.column(axis), axis=axis)


def _word(block: NcBlock) -> str:
    """That of the spindle, for the error."""
    if block.command is not None:
        return f"#{block.command.name}"
    named = [m.name for m in block.m if m.group in ("spindle", "positioning")]
    return next(iter(named), "S" if "S" in block.words else block.source.names[0])


def _taken(channel: Channel, state: ModalState, block: NcBlock, word: str) -> faults.ProgramError:
    column = block.source.column(word) if block.command is None else block.command.column
    axis = channel.table.c_axis
    return own.SPINDLE_IS_AXIS.at(block.source, column, word=word, spindle=state.c_axis, axis=axis)
