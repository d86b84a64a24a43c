"""The tables of the vocabulary iso."""

from typing import Final

from cnc_ptp.nc import feeds, functions, measuring, motions, transitions, turning
from cnc_ptp.nc.coordinates import codes
from cnc_ptp.nc.iso import cycles, lengths, offsets
from cnc_ptp.nc.iso import motions as own
from cnc_ptp.nc.iso.comments import without_comments
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import GCode, MCode, Vocabulary
from cnc_ptp.nc.radius import radius_codes
from cnc_ptp.nc.vocabulary import centre, dimension, plane


def _return_level(number: int, to_r: bool) -> GCode:
    def select(state: ModalState) -> None:
        state.drilling = state.drilling._replace(to_r=to_r)

    return GCode(number, "return level", select=select)


def _cycle(number: int, words: str = "") -> GCode:
    return GCode(number, "path", motion=cycles.drill, words=frozenset("RLK" + words))


_ARC_WORDS: Final = frozenset("IJKR")
_BORING: Final = "boring with an oriented spindle"

_G_CODES = (
    GCode(0, "path", motion=motions.rapid, select=own.end_cycle),
    GCode(1, "path", motion=motions.straight, select=own.end_cycle),
    GCode(2, "path", motion=own.circular, select=own.end_cycle, words=_ARC_WORDS),
    GCode(3, "path", motion=own.circular, select=own.end_cycle, words=_ARC_WORDS),
    GCode(4, "block", motion=own.dwell, modal=False, own_words=True, words=frozenset("P")),
    GCode(9, "block end"),
    GCode(10, "block", function=offsets.set_offset, takes_axes=True, words=frozenset("LP")),
    GCode(15, "polar coordinates"),
    GCode(16, "polar coordinates", later="polar coordinates"),
    plane(17),
    plane(18),
    plane(19),
    GCode(20, "units", prepare=codes.unit),
    GCode(21, "units", prepare=codes.unit),
    GCode(28, "block", motion=own.reference_point, modal=False, prepare=own.require_axes),
    GCode(30, "block", later="a second reference point"),
    GCode(31, "path", motion=measuring.skip, modal=False, prepare=measuring.require_words),
    GCode(33, "path", later="thread cutting"),
    GCode(40, "tool radius", select=radius_codes.side(40)),
    *(
        GCode(
            code,
            "tool radius",
            select=radius_codes.side(code),
            prepare=radius_codes.take_data,
            words=frozenset("D"),
        )
        for code in (41, 42)
    ),
    GCode(43, "tool length", prepare=lengths.length_on, words=frozenset("H")),
    GCode(43, "tool length", minor=1, later="tool lengths without a table"),
    GCode(49, "tool length", prepare=lengths.length_off),
    GCode(turning.LARGEST_ISO, turning.LIMIT_GROUP),
    GCode(50, "block", minor=1, function=offsets.mirror_off, takes_axes=True),
    GCode(51, "scale", later="scaling"),
    GCode(51, "block", minor=1, later="mirror images"),
    GCode(52, "block", function=offsets.local_offset, takes_axes=True),
    GCode(53, "block", prepare=offsets.machine_coordinates),
    *(GCode(number, "zero offset", prepare=codes.zero_offset) for number in range(54, 60)),
    GCode(54, "zero offset", minor=1, prepare=offsets.further_offset, words=frozenset("P")),
    *(GCode(59, "zero offset", minor=minor, prepare=offsets.further_offset) for minor in (1, 2, 3)),
    GCode(61, "block transition", select=transitions.stop_always),
    GCode(61, "block transition", minor=1, select=transitions.stop_always),
    GCode(64, "block transition", prepare=offsets.path_tolerance, words=frozenset("PQ")),
    GCode(65, "block", later="macro calls"),
    GCode(68, "rotation", later="rotation of coordinates"),
    GCode(69, "rotation"),
    _cycle(73, "PQ"),
    _cycle(74, "P"),
    GCode(76, "path", later=_BORING),
    GCode(80, "cycle end", select=own.without_motion),
    _cycle(81),
    _cycle(82, "P"),
    _cycle(83, "PQ"),
    _cycle(84, "P"),
    _cycle(85),
    _cycle(86, "P"),
    GCode(87, "path", later=_BORING),
    GCode(88, "path", later="boring with a stop and a retraction by hand"),
    _cycle(89, "P"),
    dimension(90, True),
    dimension(91, False),
    centre(90, True, minor=1),
    centre(91, False, minor=1),
    GCode(92, "block", function=offsets.set_position, takes_axes=True),
    *(GCode(92, "block", minor=minor, prepare=offsets.end_position) for minor in (1, 2, 3)),
    GCode(93, "feed", select=feeds.inverse_time),
    GCode(94, "feed", select=feeds.per_minute),
    GCode(95, "feed", select=feeds.per_turn),
    GCode(turning.CONSTANT, turning.GROUP, prepare=turning.constant_on),
    GCode(turning.SPEED, turning.GROUP),
    _return_level(98, False),
    _return_level(99, True),
)

_M_CODES = (
    MCode(0, "program flow", "M00", None),
    MCode(1, "program flow", "M01", None),
    MCode(2, "program flow", "end", None),
    MCode(3, "spindle", "", None),
    MCode(4, "spindle", "", None),
    MCode(5, "spindle", "", None),
    MCode(19, "positioning", "", None),
    MCode(30, "program flow", "end", None),
    MCode(98, "program flow", "", None),
    MCode(99, "program flow", "return", None),
)

NO_MOTION: Final = GCode(80, "path", motion=own.no_motion)
"""The path function behind G80."""
FIRST_OFFSET: Final = 1
"""G54 is on at the start."""

ISO: Final = Vocabulary(
    "iso",
    _G_CODES,
    _M_CODES,
    axis_letters=frozenset("ABCUVWXYZ"),
    value_words=frozenset("FSTDHIJKLPQR"),
    function_words=frozenset("ST"),
    free_m=functions.free_m,
    decides=r"[%O]|M\s*0*(?:2|30|98|99)(?![\d.])",
    without_comments=without_comments,
    further_paths=(NO_MOTION,),
    careful_words=frozenset("DHLPQ"),
    first_offset=FIRST_OFFSET,
)
