"""Drilling cycles G73, G74, G81 to G86, G89: one line makes all motions of its holes.

R and Z are levels of the drill axis (Z in G17, Y in G18, X in G19), kept until G80 or G00 to G03: absolute with G90,
with G91 R counts from the level before the cycle and Z from R. Q and P are kept until the next cycle. Each hole: rapid
to its position, rapid to R, the work of the cycle, and back: to R with G99, with G98 to the level before the cycle
if that is above R.
Source: LinuxCNC, "canned cycles"; Fanuc where the text says so.
"""

from collections.abc import Callable, Iterator
from math import ceil
from typing import Final, NamedTuple

from cnc_ptp.nc import feeds, motions, tapping
from cnc_ptp.nc.canonical import Dwell, LinearMove, SpindleFunction, Tap, number
from cnc_ptp.nc.contour import EXACT_STOP
from cnc_ptp.nc.iso import iso_faults as faults
from cnc_ptp.nc.iso.offsets import integer
from cnc_ptp.nc.modal_state import Drilling, ModalState, Step
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.radius.changes import require_off
from cnc_ptp.nc.spindles import current_main, require_spindle
from cnc_ptp.nc.turning_faults import TAPPING_FEED
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM

BACKED_OFF: Final = 0.254
"""mm above the bottom of the hole so far, to which G73 lifts and G83 returns at rapid speed (LinuxCNC: 0.01 inch)."""
MOST_REPEATS: Final = 9999
MOST_MOTIONS: Final = 10_000
"""Of one block."""
TAPPING: Final = (74, 84)
DRILL_AXES: Final = {17: "Z", 18: "Y", 19: "X"}
NEEDED: Final = {73: "Q", 83: "Q", 82: "P", 89: "P"}
MEANING: Final = {
    "R": "the retract plane",
    "Z": "the bottom of the hole",
    "Q": "the depth of a peck",
    "P": "the dwell at the bottom in s",
}


class Hole(NamedTuple):
    """Levels of a drilling cycle (programmed positions of its axis, mm), peck depth (mm), dwell (s), feed (mm/s)."""

    axis: int
    r: float
    bottom: float
    clear: float
    q: float
    p: float
    feed: float


def drill(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """Notes the numbers of the cycle; with an axis word or R it drills. The motions are in `state.following`."""
    source = block.source
    require_off(state, source, source.columns[0] if source.columns else 1, f"the drilling cycle {code.name}")
    target = motions.target_of(channel, state, block, code)
    words = _own_words(block, code)
    name = DRILL_AXES[state.plane]
    axis = channel.axis_index.get(name)
    if axis is None:
        column, known = block.source.column(code.name), ", ".join(channel.axes)
        raise faults.DRILL_AXIS.at(block.source, column, g=code.name, axis=name, known=known)
    numbers = state.drilling
    if not numbers.running or numbers.plane != state.plane:
        numbers = Drilling(numbers.to_r, code.number, state.plane, state.programmed[axis])
    elif numbers.running != code.number:
        numbers = numbers._replace(running=code.number, q=None, p=None)
    state.drilling = numbers = _with_words(state, words, name, numbers)
    if target is None and "R" not in words:
        return
    hole = _hole(state, block, code, numbers, name, axis)
    target = target or list(state.programmed)
    step = [0.0 if state.absolute else end - begin for begin, end in zip(state.programmed, target, strict=True)]
    step[axis], target[axis] = 0.0, state.programmed[axis]
    work = CYCLES[code.number]
    if code.number == 86:
        _require_turning(channel, state, block, code)
    elif code.number in TAPPING:
        _take_speed(channel, state, block)
        tapping.require_main(channel, state, block, code)
    state.following = _holes(channel, state, hole, target, step, _repeats(block, code, words, hole), work)


def _own_words(block: NcBlock, code: GCode) -> dict[str, float]:
    """The words of a block without those of its other codes: P of G54.1, P and Q of G64."""
    others = [other for other in block.codes if other is not code and other.words]
    return {word: value for word, value in block.words.items() if all(word not in other.words for other in others)}


def _with_words(state: ModalState, words: dict[str, float], name: str, numbers: Drilling) -> Drilling:
    """The sticky numbers with those of the block."""
    unit = state.coordinates.unit
    if "R" in words:
        numbers = numbers._replace(r=words["R"] * unit + (0.0 if state.absolute else numbers.initial))
    if name in words and (state.absolute or numbers.r is not None):
        numbers = numbers._replace(z=words[name] * unit + (0.0 if state.absolute else numbers.r or 0.0))
    if "Q" in words:
        numbers = numbers._replace(q=words["Q"] * unit)
    if "P" in words:
        numbers = numbers._replace(p=words["P"])
    return numbers


def _hole(state: ModalState, block: NcBlock, code: GCode, numbers: Drilling, name: str, axis: int) -> Hole:
    """The numbers of the cycle, checked. Raises ProgramError."""
    source, column = block.source, block.source.column(code.name)
    given = {"R": numbers.r, "Z": numbers.z, "Q": numbers.q, "P": numbers.p}
    for word in ("R", "Z", NEEDED.get(code.number, "R")):
        if given[word] is None:
            letter = name if word == "Z" else word
            raise faults.WORD_MISSING.at(source, column, g=code.name, word=letter, what=MEANING[word])
    r, bottom, q, p = numbers.r or 0.0, numbers.z or 0.0, numbers.q or 0.0, numbers.p or 0.0
    if bottom > r:
        raise faults.RETRACT_BELOW.at(source, column, g=code.name, bottom=number(bottom), retract=number(r))
    if NEEDED.get(code.number) == "Q" and q <= 0.0:
        raise faults.PECK.at(source, source.column("Q"), g=code.name, value=number(q))
    if p < 0.0:
        raise faults.DWELL.at(source, source.column("P"), g=code.name, value=number(p))
    if state.feed_mode == feeds.PER_TURN and code.number in TAPPING:
        raise TAPPING_FEED.at(source, column, g=code.name)
    if state.feed_mode not in (feeds.PER_MINUTE, feeds.PER_TURN):
        raise faults.CYCLE_FEED.at(source, column, g=code.name)
    feeds.require_feed(state, block, code)
    return Hole(axis, r, bottom, r if numbers.to_r else max(r, numbers.initial), q, p, state.feed)


def _repeats(block: NcBlock, code: GCode, words: dict[str, float], hole: Hole) -> int:
    """L (LinuxCNC) or K (Fanuc): how many holes. Raises ProgramError, also for too many motions."""
    given = [word for word in "LK" if word in words]
    if len(given) > 1:
        raise faults.REPEATS_TWICE.at(block.source, block.source.column("K"))
    repeats = integer(block, code, given[0], 1, MOST_REPEATS, "") if given else 1
    of_a_hole = 6.0 + (3.0 * pecks(hole) if hole.q else 0.0)
    if repeats * of_a_hole > MOST_MOTIONS:
        column, count = block.source.column(code.name), number(repeats * of_a_hole)
        raise faults.MOST_MOTIONS.at(block.source, column, g=code.name, count=count, limit=MOST_MOTIONS)
    return repeats


def _take_speed(channel: Channel, state: ModalState, block: NcBlock) -> None:
    """S of the block counts for its thread; the function itself is made behind the motions."""
    if "S" in block.words and channel.table.spindles:
        state.speeds[current_main(channel, state).key] = block.words["S"]


def _require_turning(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """The M functions of the block act before its motions."""
    require_spindle(channel, block, code.name)
    commanded = [each.number for each in block.m]
    turns = current_main(channel, state).key in state.spindle.turning and 5 not in commanded and 19 not in commanded
    if not turns and 3 not in commanded and 4 not in commanded:
        raise faults.SPINDLE_STANDS.at(block.source, block.source.column(code.name), g=code.name)


class _Drill:
    """Where the tool is while the motions of a block are made."""

    def __init__(self, channel: Channel, state: ModalState, hole: Hole) -> None:
        self.channel, self.state, self.hole = channel, state, hole
        self.here = list(state.programmed)

    def rapid(self, level: float) -> Step:
        return self._move(level, True)

    def feed(self, level: float) -> Step:
        return self._move(level, False)

    def tap(self, level: float, tap: Tap) -> Step:
        """At the feed while the spindle turns with the path."""
        self.here[self.hole.axis] = level
        return Step(LinearMove(tuple(self.here), False, self.hole.feed, transition=EXACT_STOP, tap=tap))

    def _move(self, level: float, rapid: bool) -> Step:
        self.here[self.hole.axis] = level
        return Step(LinearMove(tuple(self.here), rapid, 0.0 if rapid else self.hole.feed))

    def to(self, target: list[float]) -> Step:
        """To the position of a hole, at the present level."""
        target[self.hole.axis] = self.here[self.hole.axis]
        self.here = list(target)
        return Step(LinearMove(tuple(target), True, 0.0))


def _holes(
    channel: Channel,
    state: ModalState,
    hole: Hole,
    target: list[float],
    step: list[float],
    repeats: int,
    work: Callable[[_Drill, Hole], Iterator[Step]],
) -> Iterator[Step]:
    tool = _Drill(channel, state, hole)
    if tool.here[hole.axis] < hole.r:
        yield tool.rapid(hole.r)
    for count in range(repeats):
        yield tool.to([end + count * each for end, each in zip(target, step, strict=True)])
        if tool.here[hole.axis] != hole.r:
            yield tool.rapid(hole.r)
        yield from work(tool, hole)
        if tool.here[hole.axis] != hole.clear:
            yield tool.rapid(hole.clear)


def _plain(tool: _Drill, hole: Hole) -> Iterator[Step]:
    """G81, G82: down at the feed, dwell."""
    yield tool.feed(hole.bottom)
    if hole.p > 0.0:
        yield Step(Dwell(hole.p))


def _drilling(tool: _Drill, hole: Hole) -> Iterator[Step]:
    """G81: a P of another cycle has no effect."""
    yield tool.feed(hole.bottom)


def _reaming(tool: _Drill, hole: Hole) -> Iterator[Step]:
    """G85: down and up to R at the feed."""
    yield tool.feed(hole.bottom)
    yield tool.feed(hole.r)


def _boring(tool: _Drill, hole: Hole) -> Iterator[Step]:
    """G89: as G85 with a dwell at the bottom."""
    yield from _plain(tool, hole)
    yield tool.feed(hole.r)


def _boring_stopped(tool: _Drill, hole: Hole) -> Iterator[Step]:
    """G86: down at the feed, dwell, the spindle stops, up at rapid speed, the spindle turns again."""
    key = current_main(tool.channel, tool.state).key
    yield from _plain(tool, hole)
    yield Step(None, (SpindleFunction(key, 5, None),))
    yield tool.rapid(hole.clear)
    yield Step(None, (SpindleFunction(key, tool.state.spindle.turning[key], tool.state.speeds[key]),))


def _tapping(tool: _Drill, hole: Hole) -> Iterator[Step]:
    """G84: the spindle turns clockwise with the path to the bottom, and back; it turns again as before."""
    yield from _tapped(tool, hole, 1.0)


def _tapping_left(tool: _Drill, hole: Hole) -> Iterator[Step]:
    """G74: as G84 the other way round."""
    yield from _tapped(tool, hole, -1.0)


def _tapped(tool: _Drill, hole: Hole, sense: float) -> Iterator[Step]:
    """The pitch is F / S."""
    key = current_main(tool.channel, tool.state).key
    speed, turning = tool.state.speeds[key], tool.state.spindle.turning.get(key)
    if turning is not None:
        yield Step(None, (SpindleFunction(key, 5, None),))
    yield tool.tap(hole.bottom, Tap(key, sense * speed * DEG_S_PER_RPM / hole.feed))
    if hole.p > 0.0:
        yield Step(Dwell(hole.p))
    yield tool.tap(hole.r, Tap(key, -sense * speed * DEG_S_PER_RPM / hole.feed))
    if turning is not None:
        yield Step(None, (SpindleFunction(key, turning, speed),))


def pecks(hole: Hole) -> float:
    """How often a drill goes down, Q each time."""
    return max(1.0, ceil((hole.r - hole.bottom) / hole.q - 1e-9))


def _deep(tool: _Drill, hole: Hole) -> Iterator[Step]:
    """G83: after each peck to R and back at rapid speed, to a little above the bottom so far."""
    count = int(pecks(hole))
    for peck in range(1, count):
        depth = hole.r - peck * hole.q
        yield tool.feed(depth)
        yield tool.rapid(hole.r)
        yield tool.rapid(min(depth + BACKED_OFF, hole.r))
    yield from _plain(tool, hole)


def _chip_breaking(tool: _Drill, hole: Hole) -> Iterator[Step]:
    """G73: after each peck a little up at rapid speed."""
    count = int(pecks(hole))
    for peck in range(1, count):
        depth = hole.r - peck * hole.q
        yield tool.feed(depth)
        yield tool.rapid(min(depth + BACKED_OFF, hole.r))
    yield from _plain(tool, hole)


CYCLES: Final[dict[int, Callable[[_Drill, Hole], Iterator[Step]]]] = {
    73: _chip_breaking,
    74: _tapping_left,
    81: _drilling,
    82: _plain,
    83: _deep,
    84: _tapping,
    85: _reaming,
    86: _boring_stopped,
    89: _boring,
}
