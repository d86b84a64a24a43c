"""Turning: diameters (G51, G52), feed per turn (G95), constant cutting speed (G96, G97, G196).

The facing axis is the one of the active plane with P-AXIS-00015 0x40; the turning centre is its programmed position 0.
Positions, centres and radii inside are radii, whatever the words were. Source: programming manual, turning functions.
"""

from __future__ import annotations

from math import inf, pi
from typing import Final

from cnc_ptp.errors import Value
from cnc_ptp.nc import faults, turning_faults
from cnc_ptp.nc.canonical import (
    CircularMove,
    CuttingSpeed,
    FeedPerTurn,
    Function,
    LanguageWarning,
    LinearMove,
    number,
)
from cnc_ptp.nc.coordinates.placement import PLANE_AXES
from cnc_ptp.nc.functions import block_functions
from cnc_ptp.nc.gears import speed_range
from cnc_ptp.nc.modal_state import FacingAxis, ModalState
from cnc_ptp.nc.program import Channel, GCode, NcBlock, Spindle
from cnc_ptp.nc.spindles import current_main, require_spindle

CONSTANT: Final = 96
SPEED: Final = 97
LARGEST: Final = 196
LARGEST_ISO: Final = 50
GROUP: Final = "cutting speed"
LIMIT_GROUP: Final = "largest speed"
STOPS: Final = (5, 19)
"""M functions behind which a spindle does not turn."""
M_PER_MINUTE: Final = 1000.0 / 60.0
FEET_PER_MINUTE: Final = 304.8 / 60.0
"""mm/s"""
SMALLEST_RADIUS: Final = 0.001
"""mm; nearer to the turning centre the speed is that of this radius, if nothing limits it."""
ROUNDING: Final = 1e-9
"""Part of a speed."""


# diameters


def diameter_on(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G51: words of the facing axis are diameters. Raises ProgramError 20042, 20064, 21720."""
    axis = _facing_axis(channel, state, block, code, turning_faults.NO_FACING_AXIS)
    if not (axis.absolute or axis.relative):
        raise _fault(turning_faults.NO_DIAMETERS, block, code.name, axis=channel.axes[axis.place])
    state.turning = state.turning._replace(diameter=axis)
    state.reported = False


def diameter_off(state: ModalState) -> None:
    """G52: words of the facing axis are radii."""
    state.turning = state.turning._replace(diameter=None)
    state.reported = False


def take_diameter(channel: Channel, state: ModalState, block: NcBlock, target: list[float]) -> None:
    """A word of the facing axis is a diameter, with G91 the change of one. Raises ProgramError 20019, 21721."""
    axis = state.turning.diameter
    assert axis is not None
    name = channel.axes[axis.place]
    if name not in block.words or is_cartesian(state, axis.place):
        return
    mirror = state.coordinates.mirror
    if mirror and mirror[axis.place] < 0.0:
        raise _fault(turning_faults.MIRRORED, block, name, axis=name, g="G21, G22, G23 or G351")
    radius = block.words[name] * state.coordinates.unit / 2.0
    if state.absolute and axis.absolute:
        if radius < 0.0:
            raise _fault(turning_faults.NEGATIVE_DIAMETER, block, name, axis=name, value=number(block.words[name]))
        target[axis.place] = radius
    elif not state.absolute and axis.relative:
        target[axis.place] = state.programmed[axis.place] + radius


def as_programmed(state: ModalState, index: int, position: float) -> float:
    """A position of an axis as absolute words name it: diameters with G51."""
    axis = state.turning.diameter
    if axis is None or axis.place != index or not axis.absolute or is_cartesian(state, index):
        return position
    return 2.0 * position


def radius_of(state: ModalState, place: int, value: float) -> float:
    """An absolute position of an axis (mm, deg) from its word, which is a diameter with G51."""
    axis = state.turning.diameter
    if axis is None or axis.place != place or not axis.absolute or is_cartesian(state, place):
        return value
    return 0.5 * value


def is_cartesian(state: ModalState, place: int) -> bool:
    """Words of the axis are Cartesian (#FACE), and no diameters with G51."""
    kinematics = state.coordinates.kinematics
    return kinematics is not None and place in kinematics.plane


def _facing_axis(channel: Channel, state: ModalState, block: NcBlock, code: GCode, missing: faults.Fault) -> FacingAxis:
    """The one of the active plane. Raises ProgramError."""
    names = PLANE_AXES[state.plane]
    found = [axis for axis in channel.turning.facing if channel.axes[axis.place] in names]
    plane = f"G{state.plane}"
    if not found:
        raise _fault(missing, block, code.name, g=code.name, plane=plane)
    if len(found) > 1:
        first, second = (channel.axes[axis.place] for axis in found)
        raise _fault(
            turning_faults.TWO_FACING_AXES, block, code.name, g=code.name, plane=plane, first=first, second=second
        )
    return found[0]


# feed per turn


def with_spindle(
    channel: Channel,
    state: ModalState,
    block: NcBlock,
    programmed: tuple[float, ...],
    motion: LinearMove | CircularMove,
) -> LinearMove | CircularMove:
    """G95: the motion with its feed in a turn, and that at the commanded speed.

    Raises ProgramError 50499, 21548, 21726, 21727. A spindle of the PLC reports no speed: the programmed one counts.
    """
    word = "F" if "F" in block.words else _g_name(block)
    require_spindle(channel, block, "G95")
    main = current_main(channel, state)
    _require_rotation(channel, state, block, main, word)
    speed, modal = state.speeds.get(main.key, 0.0), state.turning
    if modal.speed:
        speed = speed_at(state, main, 0.5 * (state.programmed[modal.facing] + programmed[modal.facing]))
    if not speed:
        raise _fault(turning_faults.SPEED_ZERO, block, word, spindle=main.key)
    link = None if main.plc_control else FeedPerTurn(main.key, modal.feed)
    return motion._replace(feed=modal.feed * speed / 60.0, per_turn=link)


def _require_rotation(channel: Channel, state: ModalState, block: NcBlock, main: Spindle, word: str) -> None:
    """Raises ProgramError for a spindle that cannot turn: the path would wait for it without end.

    M05 of the same block may come behind the motion, and one of the PLC may turn whatever the program says.
    """
    if main.key == state.c_axis:
        raise _fault(turning_faults.FEED_OF_C_AXIS, block, word, spindle=main.key, axis=channel.table.c_axis)
    if main.key in state.thread.stopped and not main.plc_control and not _stops_spindle(block):
        raise _fault(turning_faults.FEED_OF_STOPPED, block, word, spindle=main.key)


def _stops_spindle(block: NcBlock) -> bool:
    return any(code.number in STOPS for code in block.m) or any(
        words.m == 5 or words.positioning for words in block.spindles
    )


def _g_name(block: NcBlock) -> str:
    return next((code.name for code in block.codes if code.motion is not None), "")


# constant cutting speed


def constant_on(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G96: S is a cutting speed from here on. Raises ProgramError 20634, 20064, 21548, 21724."""
    require_spindle(channel, block, code.name)
    main = current_main(channel, state)
    if main.plc_control:
        raise _fault(turning_faults.PLC_SPINDLE, block, code.name, g=code.name, spindle=main.key)
    axis = _facing_axis(channel, state, block, code, turning_faults.NO_FACING_AXIS_FOR_SPEED)
    if state.turning.facing < 0:
        state.turning = state.turning._replace(facing=axis.place, speed=0.0)


def concerns(state: ModalState, block: NcBlock) -> bool:
    """S of the block may be no speed in rpm, or a function of turning is in it."""
    groups = (GROUP, LIMIT_GROUP)
    return state.turning.facing >= 0 or any(code.group in groups for code in block.codes)


def functions(channel: Channel, state: ModalState, block: NcBlock) -> tuple[Function, ...]:
    """Those of the block, with S as the turning functions mean it."""
    numbers = [code.number for code in block.codes]
    told: tuple[Function, ...] = ()
    if _limit_code(block) is not None:
        block = _take_limit(channel, state, block, with_constant=CONSTANT in numbers)
    if SPEED in numbers:
        told = _constant_off(channel, state)
    elif state.turning.facing >= 0:
        block, told = _take_cutting_speed(channel, state, block)
    return told + (block_functions(channel, state, block) if block.functions else ())


def _limit_code(block: NcBlock) -> GCode | None:
    """G196, in the vocabulary iso G50."""
    return next((code for code in block.codes if code.group == LIMIT_GROUP), None)


def _take_limit(channel: Channel, state: ModalState, block: NcBlock, *, with_constant: bool) -> NcBlock:
    """G196 S2500, G196=2500, G50 S2500: the block without this S. Raises ProgramError 120169, 21722, 21723, 21548."""
    code = _limit_code(block)
    assert code is not None
    g, in_iso = code.name, code.number == LARGEST_ISO
    require_spindle(channel, block, g)
    value = (block.values or {}).get(g)
    if value is None:
        if "S" not in block.words:
            examples = f"{g} S2500" if in_iso else f"{g} S2500 or {g}=2500"
            raise _fault(turning_faults.LIMIT_MISSING, block, g, g=g, examples=examples)
        value = block.words["S"]
        if with_constant or (state.turning.facing >= 0 and not in_iso):
            instead = "" if in_iso else f"; beside G96 it is written {g}={number(value)}"
            raise _fault(turning_faults.LIMIT_TOO_LATE, block, g, g=g, value=number(value), instead=instead)
        block = block._replace(words={word: each for word, each in block.words.items() if word != "S"})
    if value <= 0.0:
        raise _fault(turning_faults.MAX_SPEED, block, g, value=number(value), g=g)
    state.turning = state.turning._replace(max_rpm=value)
    return block


def _constant_off(channel: Channel, state: ModalState) -> tuple[Function, ...]:
    """G97: the spindle keeps its speed, and S is in rpm."""
    was_on = state.turning.speed > 0.0
    state.turning = state.turning._replace(facing=-1, speed=0.0)
    return (CuttingSpeed(current_main(channel, state).key, 0.0),) if was_on else ()


def _take_cutting_speed(channel: Channel, state: ModalState, block: NcBlock) -> tuple[NcBlock, tuple[Function, ...]]:
    """S in m/min (ft/min): the block with the speed for the present position, rpm.

    Raises ProgramError 20642, 120167.
    """
    main = current_main(channel, state)
    _refuse_positioning(channel, block)
    value, modal = _programmed_speed(channel, block), state.turning
    told: tuple[Function, ...] = ()
    if value is not None:
        if value <= 0.0:
            raise _fault(turning_faults.CUTTING_SPEED, block, "S", value=number(value))
        in_feet = channel.turning.feet and state.coordinates.unit != 1.0
        speed = value * (FEET_PER_MINUTE if in_feet else M_PER_MINUTE)
        state.turning = modal._replace(speed=speed)
        told = (CuttingSpeed(main.key, speed, modal.max_rpm, modal.facing),)
    elif _limit_code(block) is not None and modal.speed:
        told = (CuttingSpeed(main.key, modal.speed, modal.max_rpm, modal.facing),)
    if state.turning.speed and (value is not None or main.key not in state.spindle.turning):
        rpm = speed_at(state, main, state.programmed[modal.facing], any_gear=main.automatic)
        state.speeds[main.key] = rpm
        if value is not None:
            block, told = _with_rpm(channel, block, rpm), told + _limited(channel, state, main, rpm)
    return block, told


def _limited(channel: Channel, state: ModalState, main: Spindle, rpm: float) -> tuple[Function, ...]:
    """The warning 20633 for a start so near to the turning centre that the cutting speed is not reached."""
    radius = abs(state.programmed[state.turning.facing])
    if rpm >= rpm_at(state.turning.speed, radius) * (1.0 - ROUNDING):
        return ()
    axis, most = channel.axes[state.turning.facing], number(round(rpm, 3))
    place = f"axis {axis} is {number(round(radius, 4))} mm from the turning centre"
    text = f"{place}: spindle {main.key} turns at {most} rpm (G196, P-AXIS-00212), slower than the cutting speed needs"
    return (LanguageWarning(turning_faults.SPEED_LIMITED, text),)


def _refuse_positioning(channel: Channel, block: NcBlock) -> None:
    name = channel.table.main_name
    if any(code.number == 19 for code in block.m):
        raise _fault(turning_faults.POSITIONING, block, "M19", spindle=name)
    if any(words.positioning and words.name == name for words in block.spindles):
        raise _fault(turning_faults.POSITIONING, block, name, spindle=name)


def _programmed_speed(channel: Channel, block: NcBlock) -> float | None:
    """Of the main spindle: S100, SPINDLE=100, S[REV100]."""
    if "S" in block.words:
        return block.words["S"]
    own = [words for words in block.spindles if words.name == channel.table.main_name]
    return next((words.speed_rpm for words in own if words.speed_rpm is not None), None)


def _with_rpm(channel: Channel, block: NcBlock, rpm: float) -> NcBlock:
    if "S" in block.words:
        return block._replace(words={**block.words, "S": rpm})
    name = channel.table.main_name
    changed = [
        words._replace(speed_rpm=rpm) if words.name == name and words.speed_rpm is not None else words
        for words in block.spindles
    ]
    return block._replace(spindles=tuple(changed))


def follow(channel: Channel, state: ModalState, motion: LinearMove | CircularMove) -> None:
    """The commanded speed at the end of a motion; in rapid traverse it stays."""
    if not (isinstance(motion, LinearMove) and motion.rapid):
        main = current_main(channel, state)
        state.speeds[main.key] = speed_at(state, main, state.programmed[state.turning.facing])


def speed_at(state: ModalState, main: Spindle, radius: float, *, any_gear: bool = False) -> float:
    """The speed, rpm, that has the cutting speed at this radius, in the limits of G196 and of the gear.

    `any_gear`: one is chosen for the speed; else that of the active one counts.
    """
    active = state.spindle.gears.get(main.key, main.gear)
    stages = range(1, len(main.ranges) + 1) if any_gear and main.ranges else (active,)
    low = min([speed_range(main, stage)[0] for stage in stages])
    high = max([highest(main, stage) for stage in stages])
    return max(low, min(state.turning.max_rpm or inf, high, rpm_at(state.turning.speed, radius)))


def highest(main: Spindle, stage: int) -> float:
    """The largest speed of a gear stage, rpm."""
    limit = main.limits[stage - 1] if stage <= len(main.limits) else inf
    return min(limit, speed_range(main, stage)[1] or inf)


def rpm_at(speed: float, radius: float) -> float:
    """The speed of a spindle, rpm, for a cutting speed (mm/s) at a radius (mm)."""
    return speed * 60.0 / (2.0 * pi * max(SMALLEST_RADIUS, abs(radius)))


def _fault(fault: faults.Fault, block: NcBlock, place: str, /, **values: Value) -> faults.ProgramError:
    return fault.at(block.source, block.source.column(place), **values)
