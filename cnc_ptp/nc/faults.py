"""Errors of the NC language: the list of faults (number, text) and the exception with the place in the program.

Numbers are those of the vendor's diagnosis manual where it has the fault (20xxx and 21024, 21542), else 21001 and up.
"""

from collections.abc import Sequence
from typing import NamedTuple

from cnc_ptp.errors import CncError, Value
from cnc_ptp.nc.canonical import Source


class ProgramError(CncError):
    """A fault in an NC program: nothing of the block was executed.

    `reason` is the fault alone, `message` adds file, line, column and the line's text; `caret` is the line with a mark
    below it.
    """

    def __init__(self, number: int, reason: str, source: Source, column: int, /, **values: Value) -> None:
        where = f"{source.file} line {source.line} column {column} '{visible(source.text.strip())}'"
        super().__init__(number, visible(reason), where=where, **values)
        self.source = source
        self.file = source.file
        self.line = source.line
        self.column = column
        self.text = visible(source.text)
        self.calls: list[str] = []
        """From where the subroutine was called that has the fault, the innermost first."""
        self.note = ""
        """What helps to mend it; a line of its own."""
        self.unchecked = ""
        """Why a check did not look at what follows; empty where it did."""

    @property
    def full_message(self) -> str:
        effect = f"; {self.effect}" if self.effect else ""
        return f"{self.where}: {self.reason}{called_in(self.calls)}{effect}"

    @property
    def caret(self) -> str:
        """The program line and below it a caret under the column (1-based)."""
        indent = "".join(
            "\t" if character == "\t" else " " for character in visible(self.source.text[: self.column - 1])
        )
        return f"{self.text}\n{indent}^"


def called_in(calls: Sequence[str]) -> str:
    """From where a subroutine was called, for the end of a text; empty in the main program."""
    return "".join([f", called in {place}" for place in calls])


def line_of_program(source: Source, calls: Sequence[str]) -> str:
    """The place of a fault that a block causes while it is executed: file, line, text, callers."""
    return f"{source.file} line {source.line} '{visible(source.text.strip())}'{called_in(calls)}"


def visible(text: str) -> str:
    """A text of a program as it may go to a terminal: control characters but the tab as \\x1b and the like."""
    if text.isprintable():
        return text
    return "".join(
        [each if each.isprintable() or each == "\t" else each.encode("unicode_escape").decode() for each in text]
    )


class Fault(NamedTuple):
    """One kind of error: its number and the template of its reason."""

    number: int
    template: str

    def at(self, source: Source, column: int = 1, /, **values: Value) -> ProgramError:
        """The exception for this fault at a place in the program."""
        return ProgramError(self.number, self.template.format(**values), source, column, **values)


# Characters and words
UNEXPECTED_CHARACTER = Fault(21001, "unexpected character '{character}'")
UNKNOWN_WORD = Fault(21002, "unknown word '{word}'")
BAD_NUMBER = Fault(21003, "'{word}' is not a letter with a number")
NUMBER_TOO_LONG = Fault(21004, "number '{word}' has more than {limit} digits before the decimal point")
NUMBER_WITHOUT_WORD = Fault(21005, "number '{word}' without a letter; only G04 takes a bare number")
COMMAND_UNKNOWN = Fault(21006, "command '{word}' is not available")
COMMENT_NOT_OPEN = Fault(21007, "')' closes a comment that was never opened")
DUPLICATE_WORD = Fault(21008, "word {word} twice in one block: {first} and {second}")
TWICE = Fault(21042, "{word} twice in one block")
BLOCK_NUMBER_TWICE = Fault(20841, "second block number {word} in one block")
BLOCK_NUMBER_PLACE = Fault(21009, "block number {word} must be the first word of the block")
NOT_AN_INTEGER = Fault(21010, "{word}{value} must be an integer from 0 to {limit}")
SKIP_LEVEL = Fault(21011, "block skip /{level} must be /1 to /{limit}")
DUPLICATE_AXIS = Fault(20203, "axis {word} twice in one block: {first} and {second}")

# G and M functions
UNKNOWN_G = Fault(20131, "unknown G function {word}")
UNKNOWN_M = Fault(20160, "unknown M function {word}")
SAME_GROUP = Fault(21012, "{first} and {second} belong to one group ({group}) and cannot be in one block")
M_NOT_THERE = Fault(22011, "{word} does not exist on this machine (P-CHAN-00041). Known: {known}")
LATER = Fault(21050, "{g} is not available yet: {what}")
CODE_NO_VALUE = Fault(21052, "{code} takes no value")
MACROS = Fault(21054, "{word} is no word: texts are values of expressions, macros are not available")
CODE_INTEGER = Fault(21053, "the value of {code} must be an integer, it is {value}")
CODE_VALUE = Fault(21051, "{g} needs a value, as in {g}=1")
WORD_NOT_USED = Fault(21013, "{word} has no meaning with {g}")

# Structure
NO_MAIN_PROGRAM = Fault(21014, "no main program")
SECOND_PROGRAM = Fault(21015, "{program} is defined twice, first in line {line}")
PROGRAM_NAME = Fault(21016, "'{word}' is not a program name")
END_MISSING = Fault(21017, "{program} has no {end} at its end")
RETURN_IN_MAIN = Fault(21018, "{word} ends a subroutine, but this is the main program")
UNKNOWN_SUBROUTINE = Fault(21019, "unknown subroutine {name}; known are: {known}")
CALL_DEPTH = Fault(21020, "call of subroutine {name} at depth {depth}, the limit is {limit}")
WORDS_AFTER_CALL = Fault(21542, "'{word}' after a subroutine call")
CALL_AND_END = Fault(21021, "subroutine call and {word} in one block")

# Motion
AXIS_UNKNOWN = Fault(20797, "axis {word} is not in the machine; axes of this channel: {known}")
WAIT_WITHOUT_SYN = Fault(21413, "#MACHINE DATA: WAIT needs SYN")
FEED_MISSING = Fault(20008, "{g} without a feed: no F greater than 0 was programmed")
FEED_NEGATIVE = Fault(21022, "feed F{value} is negative")
DWELL_MISSING = Fault(21023, "G04 without a time")
DWELL_NEGATIVE = Fault(21030, "dwell time of {value} s is negative")
DWELL_WITHOUT_SPEED = Fault(21041, "G04 S counts revolutions, but spindle {spindle} has no speed")
DWELL_TWICE = Fault(20013, "dwell time given directly and by {word}")
DWELL_NOT_ALONE = Fault(20685, "G04 must be alone in its block, not with {word}")
PLANE_AXIS_MISSING = Fault(21031, "plane {g} needs the axes {needed}; axes of this channel: {known}")

# The program itself
ORDERED = Fault(22029, "{text}; the program is aborted there")

# Measuring
MEASURING_WITHOUT_AXIS = Fault(21100, "{g} without an axis: its axis words are the end of the measuring run")
MEASURING_NOWHERE = Fault(21101, "{g} goes nowhere: the axes are at the end of the measuring run already")
MEASURING_IN_CYCLE = Fault(21102, "{g} while the drilling cycle G{cycle} is on; G80 ends it")
MEASURING_CONTOURING = Fault(120652, "{g} while contouring ({code}) is on; G260 ends it")

# Arcs
CENTRE_NOT_IN_PLANE = Fault(21032, "centre word {word} is not in the plane {g} ({plane})")
ARC_WITHOUT_CENTRE = Fault(21033, "{g} without a centre ({words}) and without a radius (R)")
CENTRE_AND_RADIUS = Fault(21024, "circle centre ({word}) and radius (R) in one block")
RADIUS_ZERO = Fault(20036, "the radius of the circle is 0")
FULL_CIRCLE_BY_RADIUS = Fault(20034, "a full circle needs its centre: with R alone start and target must differ")
RADIUS_TOO_SMALL = Fault(
    21034, "radius R {radius} mm is too small: start and target are {chord} mm apart, at most {limit} mm can be reached"
)
RADII_DIFFER = Fault(
    21035,
    "radius {start} mm at the start and {target} mm at the target differ by {difference} mm:"
    " the centre would have to move by {offset} mm, the limit is {limit} mm"
    " (P-CHAN-00059 {absolute} mm, P-CHAN-00060 {percent} % of radius {radius} mm)",
)

# Feedforward and compensations
WEIGHT_RANGE = Fault(21090, "feedforward weight {value} % of {unit} is below 0 %")
WEIGHTS_WITHOUT_AXIS = Fault(21091, "G136 without an axis: axis words are its weights in percent")
WEIGHTS_AND_MOTION = Fault(21092, "G136 takes the axis words of its block as weights, {g} cannot be in the same block")
FEEDFORWARD_ALONE = Fault(
    21093, "'{word}' with feedforward in the brackets of spindle {spindle}: G135, G136 and G137 must be alone there"
)
WEIGHT_MISSING = Fault(21094, "G136 of spindle {spindle} without a weight in percent, as in G136=80")
SELECTION_WITH_VALUE = Fault(21095, "{g} of spindle {spindle} takes no value")
COMP_FIRST = Fault(21096, "the brackets of axis {axis} begin with COMP, not with '{word}'")
COMP_WORD = Fault(21097, "'{word}' is not available after COMP of axis {axis}; known are: {known}")
COMP_INCOMPLETE = Fault(21098, "COMP of axis {axis} does not say {missing}")
COMP_TWICE = Fault(21099, "COMP of axis {axis} twice in one block")

# Slope
SLOPE_UNKNOWN = Fault(21110, "slope {slope} is not known; known are: {known}")
SLOPE_NOT_AVAILABLE = Fault(21111, "slope {slope} is not available; available are: STEP, TRAPEZ, SIN2")

# Transitions between blocks
OPTION_TOO_SMALL = Fault(120129, "{word}={value} must be {least}")
NOTHING_TO_SMOOTH = Fault(21629, "#HSC smooths the path of axes, but the channel has none")
OPTION_TOO_LARGE = Fault(21112, "{word}={value} must be at most {limit}")
NO_TOLERANCE = Fault(
    21114,
    "#HSC ON without PATH_DEV, and the machine file has none (P-CHAN-90014); e.g. #HSC ON [BSPLINE PATH_DEV=0.01]",
)
POINT_NOT_POSSIBLE = Fault(21115, "mode POS of #CONTOUR MODE with {what}: its interim point is one of the axes")
OPTION_OF_OTHER_MODE = Fault(21113, "{word} has no meaning in mode {mode} of #CONTOUR MODE")

# Spindles
SPINDLE_UNKNOWN = Fault(20180, "spindle {word} does not belong to this channel; its spindles are: {known}")
SPEED_ABOVE_GEAR = Fault(22010, "spindle {spindle}: {speed} rpm is above the maximum {limit} rpm{gear} (P-AXIS-00212)")
NO_SPINDLE = Fault(21548, "{word} needs a spindle, this channel has none")
SPEED_NEGATIVE = Fault(20991, "speed {value} rpm of spindle {spindle} is negative")
SPEED_MISSING = Fault(21036, "M{m} of spindle {spindle} without a speed: none was programmed before")
SPINDLE_TWICE = Fault(21037, "spindle {spindle} is programmed twice in one block")
SPINDLE_M_TWICE = Fault(20155, "M{first} and M{second} for spindle {spindle} in one block")
BRACKET_WORD = Fault(21038, "'{word}' is not available in the brackets of spindle {spindle}; known are: {known}")
BRACKET_EMPTY = Fault(21039, "the brackets of {spindle} are empty")
BRACKET_OPEN = Fault(21040, "'[' without ']'")
