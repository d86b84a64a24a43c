"""Transitions between blocks: exact stop (G09, G60, G359, G360), contouring (G61, G260, G261, #CONTOUR MODE), #HSC."""

from __future__ import annotations

from typing import Final

from cnc_ptp.nc import faults
from cnc_ptp.nc.canonical import number
from cnc_ptp.nc.contour import DEV, DIST, EXACT_STOP, POS, THROUGH, Contour, Smoothing, Transition
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.flow.command_words import Words
from cnc_ptp.nc.flow.lines import Flow, Line, Statement
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.turning import radius_of

LENGTHS: Final = ("PATH_DEV", "PRE_DIST", "POST_DIST")
"""Words in mm or inch."""
TOLERANCES: Final = (*LENGTHS, "TRACK_DEV")
"""Words that must be above 0."""
OTHERS: Final = ("TRACK_DEV", "REMAIN_PART", "MAX_ANGLE")
MAIN_AXES: Final = "XYZ"
"""Positions of the interim point."""
SMOOTHING: Final = "#HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=5] or #HSC OFF"
OF_MODE: Final = {
    DEV: ("PATH_DEV", *OTHERS),
    DIST: ("PRE_DIST", "POST_DIST", *OTHERS),
    POS: ("PRE_DIST", "POST_DIST", "REMAIN_PART", "MAX_ANGLE", *MAIN_AXES),
    "OFF": (),
}
EXAMPLES: Final = {
    "PATH_DEV": "=0.01",
    "TRACK_DEV": "=5",
    "PRE_DIST": "=1",
    "POST_DIST": "=2",
    "REMAIN_PART": "=20",
    "MAX_ANGLE": "=120",
    "X": "10",
    "Y": "5",
    "Z": "0",
}
"""Each word with a value, for texts."""


def syntax(mode: str) -> str:
    """The bracket of a mode with all that it takes."""
    return f"[{' '.join([mode, *(f'{word}{EXAMPLES[word]}' for word in OF_MODE[mode])])}]"


CONTOUR: Final = f"#CONTOUR MODE {syntax(DEV)}, {syntax(DIST)}, {syntax(POS)} or {syntax('OFF')}, ON, OFF"
LARGEST: Final = {"REMAIN_PART": 100.0, "MAX_ANGLE": 180.0}


def exact_stop(state: ModalState) -> None:
    """G60, G360: the path stops at the end of each block that #HSC does not smooth."""
    smoothing = state.transition.smoothing
    state.transition = EXACT_STOP if smoothing is None else EXACT_STOP._replace(smoothing=smoothing)


def stop_always(state: ModalState) -> None:
    """G61 of the vocabulary iso: an exact stop also where G64 Q has smoothed short blocks."""
    state.transition = EXACT_STOP


def through(state: ModalState) -> None:
    """G359, G260: the path continues where the direction does; a corner is passed as slowly as its kink needs."""
    state.transition = THROUGH._replace(smoothing=state.transition.smoothing)


def contouring(state: ModalState) -> None:
    """G261: corners are rounded as #CONTOUR MODE says."""
    state.transition = Transition(exact=False, contour=state.contour, smoothing=state.transition.smoothing)


def once(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """G09: an exact stop, G61: contouring at the end of this block."""
    smoothing = state.transition.smoothing
    state.once = EXACT_STOP if code.number == EXACT_ONCE else Transition(False, state.contour, smoothing)


EXACT_ONCE: Final = 9


def through_point(
    channel: Channel, state: ModalState, block: NcBlock, transition: Transition, corner: tuple[float, ...]
) -> Transition:
    """The transition at a `corner` (programmed position) with the interim point of POS, which is for this corner alone.

    Without a point it is an exact stop. Raises ProgramError 21115 where nothing is known of the curve beforehand.
    """
    contour, given = transition.contour, state.interim_point
    if contour is None or contour.mode != POS:
        return transition
    state.interim_point = None
    if given is None:
        return EXACT_STOP._replace(smoothing=transition.smoothing)
    kinematics = state.coordinates.kinematics
    if state.radius_compensation.on or kinematics is not None:
        what = "compensation of the tool radius" if kinematics is None else kinematics.name
        raise faults.POINT_NOT_POSSIBLE.at(block.source, 1, what=what)
    point = tuple([given.get(place, value) for place, value in enumerate(corner)])
    if state.frame is not None:
        point = state.frame.to_machine(point)
    room = list(channel.soft_limits)
    for place, (low, high) in (state.coordinates.limits or {}).items():
        if room:
            room[place] = max(low, room[place][0]), min(high, room[place][1])
    return transition._replace(contour=contour._replace(point=point, room=tuple(room)))


class ContourMode(Statement):
    """#CONTOUR MODE."""

    def __init__(self, column: int, switch: str, mode: str, options: dict[str, Node]) -> None:
        super().__init__(column, independent=True)
        self.switch, self.mode, self.options = switch, mode, options

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        state = execution.values.state
        if self.mode:
            options = {word: node for word, node in self.options.items() if word not in MAIN_AXES}
            given = values_of(execution, line, options, at_corner=self.mode == POS)
            fields = state.contour._asdict() | {word.lower(): value for word, value in given.items()}
            state.contour = Contour(**fields)._replace(mode=self.mode)
        state.interim_point = self.interim_point(execution, line) if self.mode == POS else None
        if self.switch == "OFF":
            through(state)
        elif self.switch == "ON" or state.transition.contour is not None:
            contouring(state)
        return None

    def interim_point(self, execution: Flow, line: Line) -> dict[int, float]:
        """Programmed positions by the place of the axis, those that are given.

        Raises ProgramError 20797 for an axis that the channel does not have.
        """
        values, state = execution.values, execution.values.state
        point: dict[int, float] = {}
        for axis, node in self.options.items():
            if axis not in MAIN_AXES:
                continue
            place = values.channel.axis_index.get(axis)
            if place is None:
                known = ", ".join(values.channel.axes)
                raise faults.AXIS_UNKNOWN.at(line.source, node.column, word=axis, known=known)
            value = values.bounded(node.value(values), node.column, "the command")
            point[place] = radius_of(state, place, value * state.coordinates.unit)
        return point


class SmoothingMode(Statement):
    """#HSC ON, #HSC OFF."""

    def __init__(self, column: int, options: dict[str, Node] | None) -> None:
        super().__init__(column, independent=True)
        self.options = options

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        state = execution.values.state
        smoothing: Smoothing | None = None
        if self.options is not None:
            if not execution.values.channel.axes:
                raise faults.NOTHING_TO_SMOOTH.at(line.source, self.column)
            given = values_of(execution, line, self.options)
            default = execution.values.channel.path.smoothing or Smoothing(given.get("PATH_DEV", 0.0))
            smoothing = Smoothing(given.get("PATH_DEV", default.path_dev), given.get("TRACK_DEV", default.track_dev))
            if smoothing.path_dev == 0.0:
                raise faults.NO_TOLERANCE.at(line.source, self.column)
        state.transition = state.transition._replace(smoothing=smoothing)
        return None


def values_of(execution: Flow, line: Line, options: dict[str, Node], *, at_corner: bool = False) -> dict[str, float]:
    """Values of options by their words. `at_corner`: the path may be left and met in the corner itself."""
    above = () if at_corner else TOLERANCES
    return {word: option(execution, line, word, node, above) for word, node in options.items()}


def option(execution: Flow, line: Line, word: str, node: Node, above: tuple[str, ...] = TOLERANCES) -> float:
    """Value of an option, mm, % or deg; of those in `above` it must be greater than 0.

    Raises ProgramError for one that is too small or above its limit.
    """
    values = execution.values
    value = values.bounded(node.value(values), node.column, "the command")
    if value < 0.0 or (value == 0.0 and word in above):
        least = "above 0" if word in above else "at least 0"
        raise faults.OPTION_TOO_SMALL.at(line.source, node.column, word=word, value=number(value), least=least)
    limit = LARGEST.get(word, value)
    if value > limit:
        raise faults.OPTION_TOO_LARGE.at(line.source, node.column, word=word, value=number(value), limit=number(limit))
    return value * values.state.coordinates.unit if word in LENGTHS else value


def read_contour_mode(line: Line, text: str, end: int, column: int) -> None:
    words = Words(line, text, end, "#CONTOUR MODE", CONTOUR)
    switch = words.takes("ON", "OFF")
    mode = ""
    options: dict[str, Node] = {}
    if not words.at_end and switch != "OFF":
        mode, options = words.bracket(
            (DEV, DIST, POS) if switch else (DEV, DIST, POS, "OFF"), (*LENGTHS, *OTHERS), MAIN_AXES
        )
        if not mode and not options:
            raise words.missing("values in brackets, ON or OFF")
        mode = mode or DEV
    elif not switch:
        raise words.missing("values in brackets, ON or OFF")
    if mode == POS and not set(MAIN_AXES) & set(options):
        raise words.missing("an interim point (X, Y, Z)")
    words.require_end()
    for word, node in options.items():
        if word not in OF_MODE[mode]:
            raise faults.OPTION_OF_OTHER_MODE.at(line.source, node.column, word=word, mode=mode)
    if mode == "OFF":
        switch, mode = "OFF", ""
    line.statement = ContourMode(column, switch, mode, options)
    line.synchronises = words.reader.synchronises


def read_smoothing(line: Line, text: str, end: int, column: int) -> None:
    words = Words(line, text, end, "#HSC", SMOOTHING)
    switch = words.takes("ON", "OFF")
    if not switch:
        raise words.stray() if not words.at_end else words.missing("ON or OFF")
    options: dict[str, Node] | None = None
    if switch == "ON":
        options = {} if words.at_end else words.bracket(("BSPLINE",), ("PATH_DEV", "TRACK_DEV"))[1]
    words.require_end()
    line.statement = SmoothingMode(column, options)
    line.synchronises = words.reader.synchronises
