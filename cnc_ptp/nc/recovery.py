"""How a check continues behind a faulty block: the block is left out, modal state and position are those before it.

What a block that is left out would have changed is unknown. So errors that may come from that alone are not
shown (FOLLOW), and the check ends at a line that reads the state (V.A., V.G., V.SPDL_PROG.).
"""

import re
from typing import Final

from cnc_ptp.nc import faults, spindle_faults
from cnc_ptp.nc.canonical import CanonicalBlock, OrderedError
from cnc_ptp.nc.coordinates import coordinate_faults
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.execution import Execution
from cnc_ptp.nc.iso import iso_faults
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.tapping import CODES as TAPPING_CODES

MOST_ERRORS: Final = 20
"""Errors of one interpretation."""
OF_THE_LINE: Final = frozenset(
    fault.number
    for fault in (
        *(spindle_faults.HOMING_NOT_ALONE, spindle_faults.HOMING_OF_NOTHING, spindle_faults.HOMING_ORDER),
        *(spindle_faults.DYNAMICS_NOT_ALONE, spindle_faults.POSITION_ALONE, spindle_faults.POSITION_RANGE),
        *(spindle_faults.PLC_SPINDLE, spindle_faults.GEAR_TWICE, spindle_faults.GEAR_IN_BRACKET),
        *(spindle_faults.GEAR_AND_HOMING, spindle_faults.PITCH_TWICE, spindle_faults.PITCH_ZERO),
        *(spindle_faults.COMMAND_NOT_ALONE, spindle_faults.COMMAND_ARGUMENTS, spindle_faults.LINK_GROUP),
        *(spindle_faults.LINK_GROUP_DEFAULT, spindle_faults.LINK_RATIO, spindle_faults.LINK_DENOMINATOR),
        *(spindle_faults.LINK_GANTRY, spindle_faults.LINK_ITSELF),
        *(spindle_faults.MAIN_SPINDLE_NUMBER, spindle_faults.FREE_M_IN_BRACKET),
        *(coordinate_faults.OFFSET_INDEX, coordinate_faults.AXES_MISSING, coordinate_faults.SCALE_FACTOR),
        *(coordinate_faults.SYSTEM_NUMBER, coordinate_faults.SYSTEM_VALUES, coordinate_faults.ACTIVITY),
        *(coordinate_faults.MIRROR_VALUE, coordinate_faults.MACHINE_TOOL),
    )
)
"""Errors that a line has whatever was before it."""
FOLLOW: Final = (
    frozenset(
        fault.number
        for fault in (
            *(faults.FEED_MISSING, faults.DWELL_WITHOUT_SPEED, faults.SPEED_MISSING, faults.WORD_NOT_USED),
            *(faults.CENTRE_NOT_IN_PLANE, faults.ARC_WITHOUT_CENTRE, faults.RADIUS_ZERO, faults.FULL_CIRCLE_BY_RADIUS),
            *(faults.RADIUS_TOO_SMALL, faults.RADII_DIFFER, faults.MEASURING_NOWHERE, faults.MEASURING_CONTOURING),
            *(faults.MEASURING_IN_CYCLE, faults.SPEED_ABOVE_GEAR, faults.PLANE_AXIS_MISSING),
            *(value for value in vars(spindle_faults).values() if isinstance(value, faults.Fault)),
            *(value for value in vars(coordinate_faults).values() if isinstance(value, faults.Fault)),
            *(iso_faults.NO_MOTION, iso_faults.MACHINE_INCREMENTAL, iso_faults.RETRACT_BELOW, iso_faults.WORD_MISSING),
            *(iso_faults.SPINDLE_STANDS, iso_faults.CYCLE_FEED),
        )
    )
    - OF_THE_LINE
)
"""Errors that a block before them may have caused. LIMIT_POSITIVE and LIMIT_NEGATIVE are those of soft limits, too."""
WRITTEN: Final[dict[int, tuple[str, ...]]] = {
    faults.FEED_MISSING.number: ("{g}", "F"),
    faults.SPEED_ABOVE_GEAR.number: ("{spindle}{gear}",),
    faults.WORD_NOT_USED.number: ("{g}", "{word}"),
    faults.PLANE_AXIS_MISSING.number: ("{g}",),
    spindle_faults.TAPPING_FEED_ZERO.number: ("{g}", "F"),
    spindle_faults.TAPPING_SPEED_ZERO.number: ("{g}", "S"),
    spindle_faults.TAPPING_TWO.number: ("{g}", "{first}", "{second}"),
    spindle_faults.PITCH_DIFFERS.number: ("G63", "F", "S"),
}
"""Of FOLLOW: words that make it an error of its line alone where all of them are in it: F0, a speed above the maximum.

The maximum of a gear is no word, so it follows from the line that selected the gear.
"""
CAUSES_NOTHING: Final = re.compile(
    r"\s*(?:/\s*\d*\s*)?(?:N\s*\d+\s*:?\s*)?#\s*(?:CONTOUR|EXPL|FLUSH|HSC|MACHINE|MSG|SLOPE|TIMER)(?![A-Z])",
    re.ASCII | re.IGNORECASE,
)
"""Lines without which no other one has an error: they change neither positions nor feed nor spindles."""
DEPENDS: Final = "what follows depends on it"
ENOUGH: Final = f"{MOST_ERRORS} errors are enough"
READS: Final = "what follows reads a state that is not known behind a block with an error"


class Recovery:
    """The errors of one interpretation."""

    def __init__(self, known: list[ProgramError]) -> None:
        """`known`: syntax errors of the program, which do not count again."""
        self.errors: list[ProgramError] = []
        self._places = {(error.file, error.line) for error in known}
        self._reasons: set[str] = set()
        self.unchecked = ""
        """Why what follows `last` was not checked."""
        self.last: ProgramError | None = None
        self._noted: list[ProgramError] = []
        """Errors of the block that comes next."""
        self._skipped = False
        """Blocks have been left out that may cause errors of others."""
        self._tapping = False
        """G63, G331 or G332 among them: a negative S leads out of the thread then."""

    def note(self, error: ProgramError) -> None:
        """An error that changes nothing for what follows: its block is executed; one position counts once."""
        if error.reason not in self._reasons:
            self._reasons.add(error.reason)
            self._noted.append(error)
            self._take(error)

    def of_block(self, error: ProgramError, block: CanonicalBlock | None) -> None:
        """As `note`, of a block that was interpreted already; each of its lines counts.

        None: behind the last block.
        """
        error.calls = [] if block is None else list(block.calls)
        self._take(error)

    def go_on(self, error: ProgramError, execution: Execution, state: ModalState, before: ModalState | None) -> bool:
        """Whether the check continues behind an error.

        `before`: the modal state before the block; None: the error came before there was a block.
        """
        self._take(error)
        if before is None and not execution.skip(error):
            self.unchecked, self.last = "" if execution.at_end else DEPENDS, error
            return False
        if before is not None:
            self._tapping = self._tapping or state.path in TAPPING_CODES
            state.take_over(before)
            execution.moved = False
        state.spindle.speedless.clear()
        execution.uncertain = True
        self._skipped = self._skipped or CAUSES_NOTHING.match(error.source.text) is None
        return len(self.errors) < MOST_ERRORS

    def ends_with(self, error: ProgramError) -> None:
        """An error of a contour whose blocks were executed already: the check ends."""
        self._take(error)
        self.unchecked, self.last = DEPENDS, error

    def ordered(self, block: CanonicalBlock) -> None:
        """Takes the #ERROR of a block, which stops the program there, and says from where the errors before came."""
        for error in self._noted:
            error.calls = list(block.calls)
        self._noted.clear()
        for function in block.functions:
            if isinstance(function, OrderedError) and function.severe:
                error = faults.ORDERED.at(block.source, block.source.text.index("#") + 1, text=function.text)
                error.calls = list(block.calls)
                self._take(error)

    def mark(self, errors: list[ProgramError]) -> None:
        """Says at one of the errors that what follows was not checked."""
        if not self.unchecked or not errors:
            return
        last = self.last
        places = [each for each in errors if last is not None and (each.file, each.line) == (last.file, last.line)]
        (places or errors)[-1].unchecked = self.unchecked

    def finish(self, execution: Execution) -> None:
        """The interpretation has come to an end."""
        if execution.reads_unknown:
            self.unchecked = READS

    def _take(self, error: ProgramError) -> None:
        place = (error.file, error.line)
        follows = may_follow(error) or (self._tapping and error.number == faults.SPEED_NEGATIVE.number)
        if place in self._places or (self._skipped and follows):
            return
        self._places.add(place)
        self.errors.append(error)
        self.last = error
        if len(self.errors) == MOST_ERRORS:
            self.unchecked = ENOUGH


def may_follow(error: ProgramError) -> bool:
    """Whether a block before it may have caused an error."""
    if error.number not in FOLLOW:
        return False
    words = WRITTEN.get(error.number)
    return words is None or not all(word.format(**error.values) in error.source.names for word in words)
