"""G33, G34, G35: thread cutting with a spindle that turns endlessly: pitch, offset of the start, what leads the motion.

The pitch belongs to the axis with the longest way (DIN 66025: I to X, J to Y, K to Z). That is the rule of 45 degrees:
below 45 degrees to the longitudinal axis Z it is K, from there on I or J. Pitch and OFFSET stay to the end of the
program; F has no effect on G33. Source: TF5200 spindle 2.8.7.

G34 and G35 are our own, with the words of SINUMERIK: the lead grows or falls by F with each revolution. After n of them
it has come K·n ± F·n²/2, so a length L takes n = 2·L/(K + √(K² ± 2·F·L)).
"""

from collections.abc import Sequence
from math import hypot, sqrt
from typing import Final

from cnc_ptp.nc import faults, thread_faults
from cnc_ptp.nc.canonical import (
    CircularMove,
    Dwell,
    Function,
    HomeAxes,
    LinearMove,
    Motion,
    SpindleFunction,
    Thread,
    led_by_spindle,
    number,
)
from cnc_ptp.nc.coordinates.frame import LEAST
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.motions import target_of
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.spindles import ROTATION, current_main, name_of, names, require_spindle
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM

PITCH_WORDS: Final = frozenset("IJK")
LETTERS: Final = {"Z": "K", "X": "I", "Y": "J"}
"""Letter of the pitch by axis."""
CONSTANT: Final = 33
GROWING: Final = 34
"""G codes with a constant and with a growing lead; that of G35 falls."""
TURN: Final = 360.0
SAME_WAY: Final = 1e-9
"""mm by which ways may differ at 45 degrees."""


def thread(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> LinearMove | None:
    """Straight to the target, led by the main spindle; takes the pitch into the state."""
    require_spindle(channel, block, code.name)
    _take_pitch(state, block)
    target = _target_of(channel, state, block, code)
    if target is None:
        return None
    ways = _ways(channel, state.programmed, target, block, code)
    axis = max(ways, key=lambda name: ways[name] + (SAME_WAY if name != "Z" else 0.0), default="")
    if not axis or ways[axis] == 0.0:
        return None
    _require_pitch(state, block, code, axis, ways)
    modes, change = state.thread, _change(state, block, code, ways[axis])
    turns = 2.0 * ways[axis] / (modes.pitch + sqrt(modes.pitch**2 + 2.0 * change * ways[axis]))
    spindle, place = current_main(channel, state).key, channel.axis_index[axis]
    retract = _machine_retract(state, block, code)
    led = Thread(spindle, TURN * turns, modes.pitch, place, modes.offset, change=change, retract=retract)
    return LinearMove(tuple(target), False, 0.0, thread=led)


def _machine_retract(state: ModalState, block: NcBlock, code: GCode) -> tuple[int, float] | None:
    """Place of the axis and way (mm) of the retract of the program, as mirror, scale and rotation make them.

    None: that of the machine file. Raises ProgramError 21673.
    """
    retract, frame = state.thread.retract, state.frame
    if retract is None or retract[1] == 0.0 or frame is None or not frame.turned:
        return retract
    column = frame.main.index(retract[0])
    ways = [row[column] * retract[1] for row in frame.linear]
    largest = max(range(3), key=lambda place: abs(ways[place]))
    if sum(map(abs, ways)) - abs(ways[largest]) > LEAST * abs(ways[largest]):
        raise thread_faults.RETRACT_ASKEW.at(block.source, block.source.column(code.name))
    return frame.main[largest], ways[largest]


def _target_of(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> list[float] | None:
    """As of other motions; F of G34 and G35 is no feed."""
    feed, block_time = state.feed, state.block_time
    target = target_of(channel, state, block, code)
    if code.number != CONSTANT and "F" in block.words:
        state.feed, state.block_time = feed, block_time
        state.thread = state.thread._replace(change=block.words["F"] * state.coordinates.unit)
    return target


def _change(state: ModalState, block: NcBlock, code: GCode, way: float) -> float:
    """Of the lead with each revolution, mm, signed. Raises ProgramError 21670, 21671."""
    modes = state.thread
    if code.number == CONSTANT:
        return 0.0
    if not modes.change:
        column = block.source.column("F" if "F" in block.words else code.name)
        raise thread_faults.CHANGE_MISSING.at(block.source, column, g=code.name)
    if code.number == GROWING:
        return modes.change
    length = modes.pitch**2 / (2.0 * modes.change)
    if way >= length:
        values = {"lead": number(modes.pitch), "change": number(modes.change)}
        column, values["length"], values["way"] = block.source.column(code.name), number(length), number(way)
        raise thread_faults.LEAD_ENDS.at(block.source, column, **values)
    return -modes.change


def _take_pitch(state: ModalState, block: NcBlock) -> None:
    given = [letter for letter in "IJK" if letter in block.words]
    if len(given) > 1:
        column = block.source.column(given[1])
        raise thread_faults.PITCH_TWICE.at(block.source, column, first=given[0], second=given[1])
    for letter in given:
        value = block.words[letter]
        if not value > 0.0:
            column = block.source.column(letter)
            raise thread_faults.PITCH_RANGE.at(block.source, column, word=letter, value=number(value))
        state.thread = state.thread._replace(letter=letter, pitch=value * state.coordinates.unit)


def _ways(
    channel: Channel, start: Sequence[float], target: Sequence[float], block: NcBlock, code: GCode
) -> dict[str, float]:
    """How far X, Y and Z move, mm. Raises ProgramError 21664 for another axis."""
    ways = {}
    for name, begin, end in zip(channel.axes, start, target, strict=True):
        if name in LETTERS:
            ways[name] = abs(end - begin)
        elif name in block.words:
            raise thread_faults.AXIS.at(block.source, block.source.column(name), word=name, g=code.name)
    return ways


def _require_pitch(state: ModalState, block: NcBlock, code: GCode, axis: str, ways: dict[str, float]) -> None:
    """Raises ProgramError 21660 and 21663."""
    letter, given = LETTERS[axis], state.thread.letter
    if not given:
        raise thread_faults.PITCH_MISSING.at(block.source, block.source.column(code.name), g=code.name, letter=letter)
    if given != letter:
        travels = ", ".join(f"{name} {number(way)} mm" for name, way in ways.items() if way)
        column = block.source.column(given if given in block.words else code.name)
        raise thread_faults.PITCH_LETTER.at(
            block.source, column, axis=axis, travels=travels, letter=letter, given=given
        )


def take_offset(channel: Channel, state: ModalState, block: NcBlock) -> None:
    """S.OFFSET=180: where the next threads begin, deg. Raises ProgramError 21668, 21669."""
    for word, value in (block.values or {}).items():
        if not word.endswith(".OFFSET"):
            continue
        require_spindle(channel, block, word)
        name, column = word.removesuffix(".OFFSET"), block.source.column(word)
        main = channel.table.main_name
        if name not in names(channel, state):
            known = ", ".join(names(channel, state))
            raise faults.SPINDLE_UNKNOWN.at(block.source, column, word=name, known=known)
        if name != main:
            raise thread_faults.OFFSET_SPINDLE.at(block.source, column, spindle=name, main=main)
        if not 0.0 <= value < TURN:
            raise thread_faults.OFFSET_RANGE.at(block.source, column, spindle=name, value=number(value))
        state.thread = state.thread._replace(offset=value)


def note_functions(channel: Channel, state: ModalState, functions: Sequence[Function]) -> None:
    """Keeps what functions do to spindles: whether they turn, and whether that is within a thread."""
    for function in functions:
        if not isinstance(function, SpindleFunction):
            continue
        modes, m = state.thread, function.m
        if m in ROTATION:
            modes = modes._replace(stopped=modes.stopped - {function.spindle})
        elif m is not None:
            modes = modes._replace(stopped=modes.stopped | {function.spindle})
        if modes.runs and function.spindle == current_main(channel, state).key:
            modes = modes._replace(changed="S" if m is None else f"M{m:02d}")
        state.thread = modes


def with_speed(channel: Channel, state: ModalState, block: NcBlock, motion: LinearMove, led: Thread) -> LinearMove:
    """The motion with the speed of its spindle, as the block has left it. Raises ProgramError 21665, 21666."""
    modes, key = state.thread, led.spindle
    name, code = name_of(channel, state, key), f"G{state.path}"
    column = block.source.column(code)
    m, speed = state.spindle.turning.get(key), state.speeds.get(key)
    if key in modes.stopped:
        why = "the program has stopped it"
        raise thread_faults.SPINDLE_STANDS.at(block.source, column, spindle=name, g=code, why=why)
    if m is not None and speed == 0.0:
        raise thread_faults.SPINDLE_STANDS.at(block.source, column, spindle=name, g=code, why="its speed is 0 rpm")
    if modes.runs and modes.changed:
        word = modes.changed
        raise thread_faults.SPINDLE_COMMANDED.at(block.source, block.source.column(word), spindle=name, word=word)
    if m is None or not speed:
        return motion
    rate = speed * DEG_S_PER_RPM
    ways = [end - begin for begin, end in zip(state.programmed, motion.target, strict=True)]
    feed = hypot(*[ways[index] for index in channel.main if index >= 0]) * rate / led.angle
    return motion._replace(feed=feed, thread=led._replace(speed=rate if m == ROTATION[0] else -rate))


def note_motion(state: ModalState, motion: Motion | None) -> None:
    """A motion of G33 begins or continues a thread, any other one ends it."""
    if isinstance(motion, (LinearMove, CircularMove, Dwell, HomeAxes)):
        runs = led_by_spindle(motion)
        if runs or state.thread.runs:
            state.thread = state.thread._replace(runs=runs, changed="")


def end_thread(state: ModalState) -> None:
    """The program stops or begins: a thread does not continue behind it."""
    if state.thread.runs:
        state.thread = state.thread._replace(runs=False, changed="")
