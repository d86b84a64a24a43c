"""Spindle words of a block -> canonical functions: names, stored speeds and positions, gears, synchronous operation.

DIN words (M3 S1000, M19 S.POS=90, M41, G74 S1, G167) are those of the main spindle, brackets name any spindle.
Source: TF5200 spindle 2.2.3, 2.3, 2.4.1, 2.7, 2.8.2, 2.8.3.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf
from typing import Final

from cnc_ptp.errors import Value
from cnc_ptp.nc import faults, gears, spindle_faults
from cnc_ptp.nc.canonical import (
    AuxiliaryFunction,
    Function,
    GearChange,
    HomeAxes,
    SpindleCommand,
    SpindleFunction,
    number,
)
from cnc_ptp.nc.modal_state import ModalState, Pair
from cnc_ptp.nc.program import Channel, GCode, NcBlock, Spindle, SpindleTable, SpindleWords
from cnc_ptp.parameters.list_units import LARGEST_POSITION
from cnc_ptp.spindle.ratio import OPPOSITE, scaled

DIRECTIONS = {3: "cw", 4: "ccw"}
ROTATION = (3, 4)
M_OF_DIRECTION = {direction: m for m, direction in DIRECTIONS.items()}
MOST_AXES: Final = 32
"""Of a channel."""


def spindle_table(spindles: Sequence[str] | SpindleTable) -> SpindleTable:
    """A table of spindles that have nothing but names; a table is returned unchanged."""
    if isinstance(spindles, SpindleTable):
        return spindles
    return SpindleTable(tuple(Spindle(name, name) for name in spindles), spindles[0] if spindles else "S")


def require_spindle(channel: Channel, block: NcBlock, word: str) -> None:
    """Raises ProgramError 21548 in a channel without spindles: `word` needs the main spindle."""
    if not channel.table.spindles:
        raise faults.NO_SPINDLE.at(block.source, block.source.column(word), word=word)


def current_main(channel: Channel, state: ModalState) -> Spindle:
    """The spindle that #MAIN SPINDLE or P-CHAN-00051 has made the main one."""
    main = state.spindle.main
    return next((spindle for spindle in channel.table.spindles if spindle.key == main), channel.table.spindles[0])


def names(channel: Channel, state: ModalState) -> dict[str, Spindle]:
    """The present names of the spindles in programs: the main one by P-CHAN-00053, the others by P-CHAN-00007."""
    if not channel.table.spindles:
        return {}
    main = current_main(channel, state)
    others = {spindle.own_name: spindle for spindle in channel.table.spindles if spindle is not main}
    return {channel.table.main_name: main, **others}


def name_of(channel: Channel, state: ModalState, key: str) -> str:
    """The present name of a spindle in programs."""
    return next(name for name, spindle in names(channel, state).items() if spindle.key == key)


def homing(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> HomeAxes | None:
    """G74: the value of an axis is its place in the order; `spindle_functions` says which spindles it homes."""
    orders: dict[float, list[str]] = {}
    for word, value in block.words.items():
        if word in channel.axis_index:
            if value != int(value) or not 1 <= value <= MOST_AXES:
                words: dict[str, Value] = {"value": number(value), "limit": MOST_AXES}
                raise spindle_faults.HOMING_ORDER.at(block.source, block.source.column(word), word=word, **words)
            orders.setdefault(value, []).append(word)
        elif word not in channel.vocabulary.function_words:
            raise faults.WORD_NOT_USED.at(block.source, block.source.column(word), word=word, g=code.name)
    if orders:
        return HomeAxes(tuple([tuple(orders[order]) for order in sorted(orders)]))
    if "S" not in block.words and not block.spindles:
        main, column = channel.table.main_name, block.source.column(code.name)
        raise spindle_faults.HOMING_OF_NOTHING.at(block.source, column, main=main)
    return None


def spindle_functions(channel: Channel, state: ModalState, block: NcBlock) -> list[Function]:
    """The functions of all spindles of a block, those of the main spindle first."""
    functions: list[Function] = []
    used: set[str] = set()
    for words, place in _words(channel, state, block):
        spindle = _named(channel, state, block, words, place)
        if spindle.key in used:
            column = block.source.column(words.name, last=True)
            raise faults.SPINDLE_TWICE.at(block.source, column, spindle=words.name)
        used.add(spindle.key)
        _check_coupling(channel, state, block, words, place, spindle)
        for function in _SpindleBlock(channel, state, block, words, place, spindle).functions():
            together = [function, *_parallel(state, function)]
            for each in together:
                require_permitted_speed(channel, state, block, place, each)
                _check_position(channel, state, block, words, place, each)
            functions += together
    return functions


def _words(channel: Channel, state: ModalState, block: NcBlock) -> Iterator[tuple[SpindleWords, str]]:
    """The words of each spindle with the word that errors point at; DIN words together as those of the main spindle."""
    main_name = channel.table.main_name
    own = [words for words in block.spindles if words.din and words.name in (main_name, "")]
    m_code = next((code for code in block.m if code.group == "spindle"), None)
    positioning = any(code.number == 19 for code in block.m)
    g_codes = [code.number for code in block.codes if code.spindle]
    gear = next((code for code in block.m if channel.table.gear_change and code.number in gears.GEAR_M), None)
    place = "S" if "S" in block.words else m_code.name if m_code else "M19" if positioning else ""
    place = place or (own[0].name if own else gear.name if gear else f"G{g_codes[0]}" if g_codes else "")
    if "S" in block.words or m_code or positioning or own or gear or 167 in g_codes:
        words = SpindleWords(main_name, m_code.number if m_code else None, None, positioning=positioning, din=True)
        words = words._replace(homing=74 in g_codes and "S" in block.words, full_override=167 in g_codes)
        require_spindle(channel, block, m_code.name if m_code else "M19" if positioning else place)
        yield _with_values(block, words, own), place
    for others in block.spindles:
        if others not in own:
            yield others, others.name


def _with_values(block: NcBlock, words: SpindleWords, own: list[SpindleWords]) -> SpindleWords:
    """Speed and position of the main spindle: S word, `SPINDLE=1000`, `S.POS=90`."""
    speeds = [block.words["S"]] if "S" in block.words and not words.homing else []
    speeds += [other.speed_rpm for other in own if other.speed_rpm is not None]
    positions = [other.position_deg for other in own if other.position_deg is not None]
    if len(speeds) > 1 or len(positions) > 1:
        place = own[-1].name if len(speeds) > 1 else f"{words.name}.POS"
        raise faults.SPINDLE_TWICE.at(block.source, block.source.column(place, last=True), spindle=words.name)
    if positions and not words.positioning:
        column = block.source.column(f"{words.name}.POS")
        raise spindle_faults.POSITION_ALONE.at(block.source, column, spindle=words.name)
    speed, position = next(iter(speeds), None), next(iter(positions), None)
    return words._replace(speed_rpm=speed, position_deg=position)


def _named(channel: Channel, state: ModalState, block: NcBlock, words: SpindleWords, place: str) -> Spindle:
    known = names(channel, state)
    spindle = known.get(words.name)
    if spindle is None:
        column = block.source.column(place)
        main = channel.table.main_name
        if known and words.name == known[main].own_name:
            raise spindle_faults.MAIN_BY_OWN_NAME.at(block.source, column, word=words.name, main=main)
        raise faults.SPINDLE_UNKNOWN.at(block.source, column, word=words.name, known=", ".join(known) or "none")
    if words.din and words.name != channel.table.main_name:
        _require_no_position(block, words)
    return spindle


def _require_no_position(block: NcBlock, words: SpindleWords) -> None:
    if words.position_deg is not None:
        column = block.source.column(f"{words.name}.POS")
        raise spindle_faults.POSITION_ALONE.at(block.source, column, spindle=words.name)


def _check_coupling(
    channel: Channel, state: ModalState, block: NcBlock, words: SpindleWords, place: str, spindle: Spindle
) -> None:
    for group in state.spindle.active:
        for slave, master, _, _ in state.spindle.links[group]:
            if slave == spindle.key:
                column, leader = block.source.column(place), name_of(channel, state, master)
                raise spindle_faults.COUPLED.at(block.source, column, spindle=words.name, master=leader, group=group)


def is_slave(state: ModalState, key: str) -> bool:
    """The spindle follows another one."""
    return any(pair.slave == key for group in state.spindle.active for pair in state.spindle.links[group])


def _parallel(state: ModalState, function: Function) -> list[Function]:
    """The same function for the slaves of its spindle (2.8.3, parallel commanding); gears stay with the master."""
    if not state.spindle.active or not isinstance(function, (SpindleFunction, SpindleCommand)):
        return []
    pairs = [
        pair for group in state.spindle.active for pair in state.spindle.links[group] if pair.master == function.spindle
    ]
    speedless = state.spindle.speedless
    functions: list[Function] = []
    for pair in pairs:
        if function.spindle in speedless:
            speedless[pair.slave] = speedless[function.spindle]
        else:
            speedless.pop(pair.slave, None)
        of_slave = _of_slave(function, pair)
        _note(state, pair.slave, of_slave)
        functions.append(of_slave)
    return functions


def _of_slave(function: SpindleFunction | SpindleCommand, pair: Pair) -> SpindleFunction | SpindleCommand:
    """The function of a master as its slave has it: speed and position times the ratio, which may reverse it."""
    if isinstance(function, SpindleCommand):
        return function._replace(spindle=pair.slave)
    ratio, m = pair.num / pair.den, function.m
    if ratio < 0.0 and m in DIRECTIONS:
        m = M_OF_DIRECTION[OPPOSITE[DIRECTIONS[m]]]
    names = ("speed_rpm", "position_deg", "direction")
    values = scaled({name: getattr(function, name) for name in names}, ratio)
    return function._replace(spindle=pair.slave, m=m, **values)


def require_permitted_speed(
    channel: Channel, state: ModalState, block: NcBlock, place: str, function: Function
) -> None:
    """Raises ProgramError 22010 for a speed that the gear of the spindle does not permit (P-AXIS-00212)."""
    if not isinstance(function, SpindleFunction) or function.speed_rpm is None:
        return
    spindle = next(spindle for spindle in channel.table.spindles if spindle.key == function.spindle)
    stage = state.spindle.gears.get(spindle.key, spindle.gear)
    limit = spindle.limits[stage - 1] if stage <= len(spindle.limits) else inf
    if function.speed_rpm > limit:
        gear = f" of gear {stage}" if len(spindle.limits) > 1 else ""
        values = {"speed": f"{function.speed_rpm:g}", "limit": f"{limit:g}", "gear": gear}
        name, column = name_of(channel, state, spindle.key), block.source.column(place)
        raise faults.SPEED_ABOVE_GEAR.at(block.source, column, spindle=name, **values)


def _check_position(
    channel: Channel, state: ModalState, block: NcBlock, words: SpindleWords, place: str, function: Function
) -> None:
    """Raises ProgramError 21083 for a position beyond the range of the lists, at its word if the block has one."""
    if not isinstance(function, SpindleFunction) or abs(function.position_deg or 0.0) <= LARGEST_POSITION:
        return
    column = block.source.column(f"{words.name}.POS" if words.din else place)
    values = {"value": number(function.position_deg or 0.0), "limit": number(LARGEST_POSITION)}
    name = name_of(channel, state, function.spindle)
    raise spindle_faults.POSITION_RANGE.at(block.source, column, spindle=name, **values)


def _note(state: ModalState, key: str, function: SpindleFunction | SpindleCommand) -> None:
    """Stores what counts for later blocks: speed, position, rotation."""
    if isinstance(function, SpindleCommand):
        state.spindle.turning.pop(key, None)
        return
    if function.speed_rpm is not None and key not in state.spindle.speedless:
        state.speeds[key] = function.speed_rpm
    if function.m in (5, 19):
        state.spindle.speedless.pop(key, None)
    if function.position_deg is not None:
        state.spindle.positions[key] = function.position_deg
    if function.m in ROTATION:
        state.spindle.turning[key] = function.m
    elif function.m is not None:
        state.spindle.turning.pop(key, None)


class _SpindleBlock:
    """The words of one spindle in one block while they become functions."""

    def __init__(
        self, channel: Channel, state: ModalState, block: NcBlock, words: SpindleWords, place: str, spindle: Spindle
    ) -> None:
        self.channel, self.state, self.block, self.words, self.place = channel, state, block, words, place
        self.spindle, self.key = spindle, spindle.key

    def functions(self) -> Iterator[Function]:
        """Gear, rotation or positioning or speed, free M functions, in this order."""
        words = self.words
        self._check_plc_control()
        self._take_speed()
        stage = self._gear_stage()
        if words.homing or words.default_dynamics:
            self._check_homing_alone()
            yield self._noted(SpindleCommand(self.key, "home" if words.homing else "reset_limits"))
            return
        function = self._positioning() if words.positioning else self._rotation(stage)
        if stage:
            self.state.spindle.gears[self.key] = stage
            yield GearChange(self.key, stage)
        if function is not None:
            yield self._noted(function)
        for code in words.functions:
            yield AuxiliaryFunction("M", code, self.key)

    def _noted(self, function: SpindleFunction | SpindleCommand) -> Function:
        _note(self.state, self.key, function)
        return function

    def _fault(self, fault: faults.Fault, **values: Value) -> faults.ProgramError:
        column = self.block.source.column(self.place)
        return fault.at(self.block.source, column, spindle=self.words.name, **values)

    def _take_speed(self) -> None:
        speed = self.words.speed_rpm
        if speed is None:
            return
        if speed < 0.0:
            raise self._fault(faults.SPEED_NEGATIVE, value=number(speed))
        self.state.speeds[self.key] = speed
        self.state.tapping = self.state.tapping._replace(reversed=False)
        self.state.spindle.speedless.pop(self.key, None)

    def _check_homing_alone(self) -> None:
        """In DIN syntax; brackets were checked when they were read."""
        rival = next((code for code in self.block.m if code.group in ("spindle", "positioning")), None)
        if self.words.din and rival is not None:
            column = self.block.source.column(rival.name)
            raise spindle_faults.HOMING_NOT_ALONE.at(
                self.block.source, column, word=rival.name, spindle=self.words.name
            )

    def _check_plc_control(self) -> None:
        """P-CHAN-00069: only M3, M4, M5, M19, speed and position."""
        words = self.words
        if not self.spindle.plc_control:
            return
        word = "G74" if words.homing else "G167" if words.full_override else ""
        word = word or ("DEFAULT_DYNAMIC_DATA" if words.default_dynamics else "")
        word = word or (f"M{words.functions[0]:02d}" if words.functions else "")
        word = word or (f"M{self._gear_codes()[0]}" if self._gear_codes() else "")
        if word:
            raise self._fault(spindle_faults.PLC_SPINDLE, word=word)

    def _rotation(self, stage: int) -> SpindleFunction | None:
        """M3, M4, M5 or a speed; after M40 to M45 alone a turning spindle continues with the stored speed.

        M3 and M4 before any speed wait at standstill until it comes (TF5200 spindle p.30).
        """
        words, m = self.words, self.words.m
        if m == 5:
            return SpindleFunction(self.key, 5, None, full_override=words.full_override)
        stored = self.state.speeds.get(self.key)
        if m is None and words.speed_rpm is None:
            turns_on = stage and self.key in self.state.spindle.turning
            if not turns_on and not words.full_override:
                return None
            return SpindleFunction(self.key, None, stored if turns_on else None, full_override=words.full_override)
        if stored is None:
            self.state.spindle.speedless[self.key] = self._fault(faults.SPEED_MISSING, m=f"{m:02d}")
        return SpindleFunction(self.key, m, stored or 0.0, full_override=words.full_override)

    def _positioning(self) -> SpindleFunction:
        """M19: to the programmed, else the last position, else 0."""
        words = self.words
        if words.m == 5:
            raise self._fault(faults.SPINDLE_M_TWICE, first=5, second=19)
        position = words.position_deg
        if position is None:
            position = self.state.spindle.positions.get(self.key, 0.0)
        speed = self.state.speeds.get(self.key)
        if speed == 0.0:
            raise self._fault(spindle_faults.SPEED_ZERO, value=0)
        direction = DIRECTIONS[words.m] if words.m else ""
        return SpindleFunction(self.key, 19, speed, position, direction, words.full_override)

    # gears

    def _gear_codes(self) -> list[int]:
        if not (self.words.din and self.channel.table.gear_change):
            return []
        return [code.number for code in self.block.m if code.number in gears.GEAR_M]

    def _gear_stage(self) -> int:
        """The stage that the block needs, 0 if it does not matter. Raises ProgramError if none fits."""
        if not self.channel.table.gear_change:
            return 0
        words = self.words
        code = next((code for code in words.functions if code in gears.GEAR_M), None)
        if code is not None:
            raise self._fault(spindle_faults.GEAR_IN_BRACKET, word=f"M{code}")
        if self.spindle is not current_main(self.channel, self.state):
            return 0
        codes = self._gear_codes()
        if len(codes) > 1:
            column = self.block.source.column(f"M{codes[1]}")
            raise spindle_faults.GEAR_TWICE.at(self.block.source, column, first=codes[0], second=codes[1])
        if codes and words.homing:
            column = self.block.source.column(f"M{codes[0]}")
            raise spindle_faults.GEAR_AND_HOMING.at(self.block.source, column, stage=codes[0])
        if not codes and not any(high > 0.0 for _, high in self.spindle.ranges):
            return 0
        return self._stage(codes[0] - gears.FIRST_M + 1 if codes else 0)

    def _stage(self, programmed: int) -> int:
        """The stage that speed and M40 to M45 ask for, 0 for none.

        M5 has no speed in a range: its speed is checked with the next M3, M4 or S. M19 changes the gear if that is
        automatic; else any stage that reaches its speed is sufficient.
        """
        words = self.words
        active = self.state.spindle.gears.get(self.key, self.spindle.gear)
        turning = words.m in ROTATION or (words.m is None and self.key in self.state.spindle.turning)
        counts = words.m != 5 and (turning or words.speed_rpm is not None)
        if words.positioning:
            counts = self.spindle.automatic and bool(self.state.speeds.get(self.key))
        if not counts and not programmed:
            return 0
        speed = self.state.speeds.get(self.key) if counts else None
        if not words.din:
            self._require_active_gear(active, speed)
            return 0
        if words.positioning and not programmed:
            return (
                active if gears.holds(self.spindle, active, speed or 0.0) else gears.search(self.spindle, speed or 0.0)
            )
        return gears.stage_for(self.spindle, active, programmed, speed, self.block, words.name)

    def _require_active_gear(self, active: int, speed: float | None) -> None:
        """Brackets change no gear."""
        if speed is not None and not gears.holds(self.spindle, active, speed):
            raise self._fault(spindle_faults.GEAR_IN_BRACKET, word=f"speed {number(speed)} rpm")
