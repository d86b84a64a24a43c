"""Tapping without a compensating chuck: G63, G331 and G332 (TF5200 spindle 2.8.6).

The main spindle, or one that has its own speed in the block (S2=200), becomes an axis of the path: it turns 360 degrees
for each pitch. With G63 the pitch is F / S; a pitch that is programmed too (I, J or K) is only compared with it. G331
has the pitch instead of F, and G332 leads out of the thread again: the same pitch with the spindle turning the other
way. A negative S, or a negative pitch of G331, is a left-hand thread.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from cnc_ptp.errors import Value
from cnc_ptp.nc import faults, feeds, spindle_faults, turning_faults
from cnc_ptp.nc.canonical import Function, GearChange, LinearMove, SpindleFunction, Tap, number
from cnc_ptp.nc.contour import EXACT_STOP
from cnc_ptp.nc.functions import block_functions
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.motions import target_of
from cnc_ptp.nc.program import Channel, GCode, NcBlock, Spindle
from cnc_ptp.nc.spindles import current_main, is_slave, names, require_permitted_speed, require_spindle
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM

TAPPING: Final = 63
TAPPING_IN: Final = 331
TAPPING_OUT: Final = 332
CODES: Final = (TAPPING, TAPPING_IN, TAPPING_OUT)
PITCH_WORDS: Final = ("I", "J", "K")


class Turn(NamedTuple):
    """How the spindle turns while the path moves: speed in rpm and feed in mm/s, both positive; sense +1 or -1."""

    speed: float
    feed: float
    sense: float


def functions(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> tuple[Function, ...]:
    """Those of the block besides S, which is the speed on the path; the gear for it first (P-AXIS-00052).

    Raises ProgramError for M3, M4, M5 and M19.
    """
    rival = next((m.name for m in block.m if m.group in ("spindle", "positioning")), "")
    if rival:
        raise _fault(spindle_faults.TAPPING_AND_M, block, rival, word=rival, g=code.name)
    gear: tuple[Function, ...] = ()
    require_spindle(channel, block, code.name)
    main = _tapping_spindle(channel, state)
    if main.path_gear and state.spindle.gears.get(main.key, main.gear) != main.path_gear:
        state.spindle.gears[main.key] = main.path_gear
        gear = (GearChange(main.key, main.path_gear),)
    words = {word: value for word, value in block.words.items() if word != "S"}
    others = block._replace(words=words, spindles=tuple([each for each in block.spindles if not each.din]))
    return gear + (block_functions(channel, state, others) if block.functions else ())


def tap(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> LinearMove | None:
    """G63, G331, G332: straight to the target while the spindle turns with it."""
    require_spindle(channel, block, code.name)
    _take_speed(channel, state, block, code)
    main = _tapping_spindle(channel, state)
    if state.turning.facing >= 0:
        raise _fault(turning_faults.TAPPING, block, code.name, g=code.name)
    if state.feed_mode == feeds.PER_TURN:
        raise _fault(turning_faults.TAPPING_FEED, block, code.name, g=code.name)
    if code.number != TAPPING:
        _take_pitch(state, block, code)
    target = target_of(channel, state, block, code)
    if target is None:
        return None
    require_usable(state, block, code, main)
    if main.key in state.spindle.turning and not is_slave(state, main.key):
        raise _fault(spindle_faults.TAPPING_WHILE_TURNING, block, code.name, g=code.name, spindle=main.key)
    if state.feed_mode != feeds.PER_MINUTE:
        raise _fault(spindle_faults.TAPPING_FEED_MODE, block, code.name, g=code.name, mode=state.feed_mode)
    turn = (
        _by_feed(channel, state, block, code, main) if code.number == TAPPING else _by_pitch(state, block, code, main)
    )
    degrees_per_mm = turn.sense * turn.speed * DEG_S_PER_RPM / turn.feed
    return LinearMove(tuple(target), False, turn.feed, transition=EXACT_STOP, tap=Tap(main.key, degrees_per_mm))


def require_main(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """Raises ProgramError for a main spindle that cannot be an axis of the path, or has no speed."""
    require_spindle(channel, block, code.name)
    require_usable(state, block, code, current_main(channel, state))


def require_usable(state: ModalState, block: NcBlock, code: GCode, spindle: Spindle) -> None:
    """The same for any spindle."""
    if not spindle.positioned:
        raise _fault(spindle_faults.TAPPING_WITHOUT_POSITION, block, code.name, g=code.name, spindle=spindle.key)
    _speed(state, block, code, spindle)


def _tapping_spindle(channel: Channel, state: ModalState) -> Spindle:
    """That whose speed was programmed last with G63, G331 or G332; else the main one."""
    named = state.tapping.spindle
    others = (spindle for spindle in channel.table.spindles if spindle.key == named)
    return next(others, current_main(channel, state))


def _take_speed(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """S with its sign, or that of another spindle (S2=200). Raises ProgramError for both, and for one that is too high.

    Errors 20180, 21655, 22010.
    """
    speeds = {channel.table.main_name: block.words["S"]} if "S" in block.words else {}
    speeds |= {each.name: each.speed_rpm for each in block.spindles if each.din and each.speed_rpm is not None}
    if not speeds:
        return
    (name, speed), *more = speeds.items()
    if more:
        raise _fault(spindle_faults.TAPPING_TWO, block, more[0][0], g=code.name, first=name, second=more[0][0])
    known = names(channel, state)
    if name not in known:
        raise _fault(faults.SPINDLE_UNKNOWN, block, name, word=name, known=", ".join(known))
    key = known[name].key
    tapped = "" if known[name] is current_main(channel, state) else key
    state.speeds[key] = abs(speed)
    state.tapping = state.tapping._replace(reversed=speed < 0.0, spindle=tapped)
    require_permitted_speed(channel, state, block, name, SpindleFunction(key, None, abs(speed)))


def _by_feed(channel: Channel, state: ModalState, block: NcBlock, code: GCode, main: Spindle) -> Turn:
    """G63: the pitch is F / S."""
    speed = _speed(state, block, code, main)
    if state.feed == 0.0:
        word = "F" if "F" in block.words else code.name
        raise _fault(spindle_faults.TAPPING_FEED_ZERO, block, word, g=code.name)
    _check_pitch(channel.table.pitch_tolerance, state, block, code, speed)
    return Turn(speed, state.feed, -1.0 if state.tapping.reversed else 1.0)


def _by_pitch(state: ModalState, block: NcBlock, code: GCode, main: Spindle) -> Turn:
    """G331, G332: the feed is S times the pitch, which stays until the next one."""
    speed, pitch = _speed(state, block, code, main), state.tapping.pitch
    if pitch == 0.0:
        raise _fault(spindle_faults.TAPPING_PITCH_MISSING, block, code.name, g=code.name)
    right = (pitch > 0.0) != state.tapping.reversed
    inwards = code.number == TAPPING_IN
    return Turn(speed, speed / 60.0 * abs(pitch), 1.0 if right == inwards else -1.0)


def _speed(state: ModalState, block: NcBlock, code: GCode, main: Spindle) -> float:
    speed = state.speeds.get(main.key, 0.0)
    if speed == 0.0:
        word = "S" if "S" in block.source.names else code.name
        raise _fault(spindle_faults.TAPPING_SPEED_ZERO, block, word, g=code.name, spindle=main.key)
    return speed


def _take_pitch(state: ModalState, block: NcBlock, code: GCode) -> None:
    """It stays until the next one."""
    pitch = _pitch(state, block, code)
    if pitch is not None:
        state.tapping = state.tapping._replace(pitch=pitch)


def _pitch(state: ModalState, block: NcBlock, code: GCode) -> float | None:
    """mm in a turn, None without one in the block. Raises ProgramError for two, and for 0."""
    given = [word for word in PITCH_WORDS if word in block.words]
    if not given:
        return None
    if len(given) > 1:
        raise _fault(spindle_faults.PITCH_TWICE, block, given[1], first=given[0], second=given[1])
    if block.words[given[0]] == 0.0:
        raise _fault(spindle_faults.PITCH_ZERO, block, given[0], word=given[0], g=code.name)
    return block.words[given[0]] * state.coordinates.unit


def _check_pitch(tolerance: float, state: ModalState, block: NcBlock, code: GCode, speed: float) -> None:
    """A pitch beside F and S must be the one that they make, within P-CHAN-90020."""
    pitch = _pitch(state, block, code)
    if pitch is None:
        return
    made = state.feed * 60.0 / speed
    if abs(made - abs(pitch)) > tolerance * abs(pitch):
        word = next(word for word in PITCH_WORDS if word in block.words)
        values = {"made": number(made), "pitch": number(abs(pitch)), "feed": number(state.feed * 60.0)}
        needed = number(abs(pitch) * speed)
        limit = number(tolerance * 100.0)
        raise _fault(
            spindle_faults.PITCH_DIFFERS, block, word, **values, speed=number(speed), needed=needed, limit=limit
        )


def _fault(fault: faults.Fault, block: NcBlock, place: str, /, **values: Value) -> faults.ProgramError:
    return fault.at(block.source, block.source.column(place), **values)
