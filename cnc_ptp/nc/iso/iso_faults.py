"""Faults of the vocabulary iso."""

from cnc_ptp.nc.faults import Fault

MACRO = Fault(21800, "'{word}': macro variables and expressions are not available in the vocabulary iso")
O_WORD = Fault(21801, "'{word}': O words are not available; M98 calls a subroutine, M99 ends it")
COMMENT_OPEN = Fault(21802, "'(' without ')' in its line")
PROGRAM_NUMBER = Fault(21803, "'{word}' is not a program number; a line O1234 has nothing else but a comment")
WORD_OF_TWO = Fault(21804, "{word} belongs to {first} and to {second}; write them in two blocks")
CALL_NUMBER = Fault(21805, "M98 without the program number P")
RANGE = Fault(21806, "{word}{value} must be an integer from {low} to {high}")
WORD_MISSING = Fault(21807, "{g} without {word}: {what}")
MACHINE_PATH = Fault(21808, "G53 moves with G00 or G01 only")
MACHINE_INCREMENTAL = Fault(21809, "G53 with G91: positions in machine coordinates are absolute; G90 first")
TOLERANCE_NEGATIVE = Fault(21810, "{word}{value}: the tolerance of G64 is negative")
OFFSET_KIND = Fault(21822, "G10 L{value}: G10 sets zero offsets with L2 and L20 only")
NO_MOTION = Fault(21811, "{word} without a motion: G80 has ended cycle and path function; program G00 to G03")
NO_TOOL_TABLE = Fault(
    21812,
    "{g} H{number}: no tool of the machine has a length;"
    " they are in a tool file (werkz_data) or in wz[{number}].laenge",
)
RETRACT_BELOW = Fault(21813, "{g}: the bottom of the hole {bottom} mm is beyond the retract plane R {retract} mm")
PECK = Fault(21814, "{g}: Q{value} must be greater than 0")
DWELL = Fault(21821, "{g}: P{value} is negative")
CYCLE_FEED = Fault(21815, "{g} with G93: a drilling cycle needs a feed per minute (G94)")
MOST_MOTIONS = Fault(21816, "{g} would make {count} motions, the limit of a block is {limit}")
DRILL_AXIS = Fault(21817, "{g} drills along {axis}, which this channel does not have; its axes: {known}")
SPINDLE_STANDS = Fault(21818, "{g} stops the spindle and starts it again, but it does not turn: M03 or M04 first")
REPEATS_TWICE = Fault(21819, "repeats by K and by L in one block")
GAP = Fault(21820, "'{word}' is not a letter with a number; numbers have no blanks between their digits")
