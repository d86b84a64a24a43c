"""The vocabulary `twincat`: G codes with their modal groups, M codes, words. A new code is a new row with its handler.

Group names and initial states follow the vendor's G groups (P-CHAN-00063).
"""

from typing import Final

from cnc_ptp.nc import (
    feedforward,
    feeds,
    functions,
    measuring,
    motions,
    spindles,
    tapping,
    thread_cutting,
    transitions,
    turning,
)
from cnc_ptp.nc.coordinates import codes
from cnc_ptp.nc.lexer import normalise
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import GCode, MCode, Vocabulary
from cnc_ptp.nc.radius import radius_codes
from cnc_ptp.nc.tools.compensation import follow_plane


def plane(number: int) -> GCode:
    """G17 to G19."""

    def select(state: ModalState) -> None:
        state.plane = number

    return GCode(number, "plane", select=select, prepare=follow_plane)


def dimension(number: int, absolute: bool) -> GCode:
    """G90, G91."""

    def select(state: ModalState) -> None:
        state.absolute = absolute

    return GCode(number, "dimensions", select=select)


def centre(number: int, absolute: bool, minor: int = 0) -> GCode:
    """I, J, K as positions or as distances from the start."""

    def select(state: ModalState) -> None:
        state.centre_absolute = absolute

    return GCode(number, "circle centre", select=select, minor=minor)


FULL_OVERRIDE: Final = 166
"""The override has no effect on the motion of the block."""
_ARC_WORDS = frozenset("IJKR")
_APPROACH: Final = "another way to a contour than at right angles (G138)"

_G_CODES = (
    GCode(0, "path", motion=motions.rapid),
    GCode(1, "path", motion=motions.straight),
    GCode(2, "path", motion=motions.circular, words=_ARC_WORDS),
    GCode(3, "path", motion=motions.circular, words=_ARC_WORDS),
    GCode(4, "path", motion=motions.dwell, modal=False, own_words=True),
    plane(17),
    plane(18),
    plane(19),
    GCode(feedforward.ON, feedforward.SELECTION, function=feedforward.block_function),
    GCode(feedforward.WEIGHTS, "feedforward weights", function=feedforward.block_function, takes_axes=True),
    GCode(feedforward.OFF, feedforward.SELECTION, function=feedforward.block_function),
    dimension(90, True),
    dimension(91, False),
    centre(161, True),
    centre(162, False),
    GCode(9, "block end", prepare=transitions.once),
    GCode(20, "mirror", prepare=codes.mirror),
    GCode(21, "mirror", prepare=codes.mirror),
    GCode(22, "mirror", prepare=codes.mirror),
    GCode(23, "mirror", prepare=codes.mirror),
    GCode(351, "mirror", function=codes.mirror_axes, takes_axes=True),
    GCode(33, "path", motion=thread_cutting.thread, words=thread_cutting.PITCH_WORDS),
    GCode(34, "path", motion=thread_cutting.thread, words=thread_cutting.PITCH_WORDS),
    GCode(35, "path", motion=thread_cutting.thread, words=thread_cutting.PITCH_WORDS),
    GCode(10, "feed of arcs", select=radius_codes.feed_of_arcs(at_contour=False)),
    GCode(11, "feed of arcs", select=radius_codes.feed_of_arcs(at_contour=True)),
    GCode(25, "outer corners", select=radius_codes.outer_corners(by_lines=True)),
    GCode(26, "outer corners", select=radius_codes.outer_corners(by_lines=False)),
    *(GCode(code, "tool radius", select=radius_codes.side(code)) for code in (40, 41, 42)),
    GCode(138, "approach"),
    *(GCode(code, "approach", later=_APPROACH) for code in (139, 236, 237, 238, 239)),
    GCode(51, "diameter", prepare=turning.diameter_on),
    GCode(52, "diameter", select=turning.diameter_off),
    *(GCode(code, "zero offset", prepare=codes.zero_offset) for code in range(53, 60)),
    GCode(159, "zero offset", prepare=codes.zero_offset, valued=True),
    GCode(160, "activity of offsets", function=codes.offset_activity, takes_axes=True, valued=True),
    GCode(60, "block transition", select=transitions.exact_stop),
    GCode(359, "block transition", select=transitions.through),
    GCode(360, "block transition", select=transitions.exact_stop),
    GCode(61, "block transition", prepare=transitions.once),
    GCode(260, "block transition", select=transitions.through),
    GCode(261, "block transition", select=transitions.contouring),
    *(GCode(code, "path", motion=tapping.tap, words=frozenset(tapping.PITCH_WORDS)) for code in tapping.CODES),
    GCode(70, "units", prepare=codes.unit),
    GCode(71, "units", prepare=codes.unit),
    GCode(92, "reference offset", function=codes.reference_offset, takes_axes=True),
    GCode(93, "feed", select=feeds.time_of_block),
    GCode(94, "feed", select=feeds.per_minute),
    GCode(95, "feed", select=feeds.per_turn),
    GCode(turning.CONSTANT, turning.GROUP, prepare=turning.constant_on),
    GCode(turning.SPEED, turning.GROUP),
    GCode(turning.LARGEST, turning.LIMIT_GROUP, valued=True, bare=True),
    GCode(98, "software limits", function=codes.software_limit, takes_axes=True),
    GCode(99, "software limits", function=codes.software_limit, takes_axes=True),
    GCode(74, "path", motion=spindles.homing, modal=False, own_words=True, spindle=True),
    GCode(100, "path", motion=measuring.measuring_run, modal=False, prepare=measuring.require_words),
    GCode(106, "path", later="measuring without a stop at the signal"),
    GCode(107, "edge", later="edge banding"),
    GCode(108, "edge", later="edge banding"),
    GCode(165, "centre correction"),
    GCode(FULL_OVERRIDE, "path override"),
    GCode(167, "spindle override", spindle=True),
)

_M_CODES = (
    MCode(0, "program flow", "M00", None),
    MCode(1, "program flow", "M01", None),
    MCode(2, "program flow", "end", None),
    MCode(3, "spindle", "", None),
    MCode(4, "spindle", "", None),
    MCode(5, "spindle", "", None),
    MCode(17, "program flow", "return", None),
    MCode(19, "positioning", "", None),
    MCode(29, "program flow", "return", None),
    MCode(30, "program flow", "end", None),
)


MAX_SKIP_LEVEL: Final = 10
_INDEPENDENT: Final = (
    *("ACS", "CONTOUR", "CS", "EXPL", "FLUSH", "HSC", "MACHINE", "MCS", "MSG", "PRESET", "PSET", "ROTATION", "SCALE"),
    *("SLOPE", "THREAD", "TIMER", "TOOL"),
)
"""First words of # commands that set no variable and change neither the order of lines nor the names of axes."""
_NOT_READ: Final = r"(?<![-+*/=,\[])(?<![-+*/=,\[]\s)"
"""A parameter behind such a sign is only read."""
_DECIDES: Final = (
    rf"^(?!\s*(?:/\s*\d*\s*)?(?:N\s*\d+\s*:?\s*|\[\s*\w+\s*\]\s*)*\#\s*(?:{'|'.join(_INDEPENDENT)})(?![A-Z]))"
    rf".*?(?:[$#@%]|\bLL?\s|G\s*8\d|{_NOT_READ}\b[PV]\s*[\d.\[]|M\s*0*(?:2|17|29|30)(?![\d.]))"
)

TWINCAT: Final = Vocabulary(
    "twincat",
    _G_CODES,
    _M_CODES,
    axis_letters=frozenset("ABCQUVWXYZ"),
    value_words=frozenset("FSTDHIJKR"),
    function_words=frozenset("STDH"),
    free_m=functions.free_m,
    decides=_DECIDES,
    without_comments=normalise,
)
"""Axis names of several letters begin with one of these, too (X1, Y_ACHSE)."""
