"""Faults of spindle functions and of commands that start with #; numbers as in faults.py, our own from 21061."""

from cnc_ptp.nc.faults import Fault

# Words of one spindle
MAIN_BY_OWN_NAME = Fault(21081, "spindle {word} is the main spindle and is programmed as {main}")
FREE_M_IN_BRACKET = Fault(
    21061, "M{number:02d} is not a function of a spindle, but is in the brackets of spindle {spindle}"
)
POSITION_ALONE = Fault(21062, "a position of spindle {spindle} (POS) without M19")
HOMING_NOT_ALONE = Fault(21063, "G74 must be the only function of spindle {spindle} in its block, not with {word}")
HOMING_OF_NOTHING = Fault(21064, "G74 without an axis or spindle; it is written G74 X1, G74 {main}1 or {main}[G74]")
HOMING_ORDER = Fault(21065, "the order of axis {word} in G74 must be an integer from 1 to {limit}, it is {value}")
DYNAMICS_NOT_ALONE = Fault(
    21066, "DEFAULT_DYNAMIC_DATA must be the only function of spindle {spindle} in its block, not with {word}"
)
SPEED_ZERO = Fault(21067, "M19 of spindle {spindle} needs a speed above 0, it has {value} rpm")
PLC_SPINDLE = Fault(21202, "{word} is not available for spindle {spindle}, which the PLC controls (P-CHAN-00069)")
COUPLED = Fault(
    21068, "spindle {spindle} follows spindle {master} (coupling group {group}) and takes no functions of its own"
)

POSITION_RANGE = Fault(21083, "position {value} deg of spindle {spindle} is not within ±{limit} deg")

# Gears
NO_GEAR_FOR_SPEED = Fault(
    21069, "speed {speed} rpm of spindle {spindle} is in no gear stage (P-CHAN-00058, P-CHAN-00055): {ranges}"
)
GEAR_TOO_NARROW = Fault(
    21070, "speed {speed} rpm of spindle {spindle} is not in gear stage M{stage}, {low} to {high} rpm"
)
GEAR_NOT_PROGRAMMED = Fault(
    21071,
    "speed {speed} rpm of spindle {spindle} is not in the active gear stage M{stage}, {low} to {high} rpm;"
    " it needs {fitting} in the block",
)
GEAR_UNUSED = Fault(21072, "M{stage} is not a gear stage of spindle {spindle} (P-CHAN-00058, P-CHAN-00055): {ranges}")
GEAR_TWICE = Fault(21073, "gear stages M{first} and M{second} in one block")
GEAR_IN_BRACKET = Fault(21074, "{word} in brackets: gears are changed in DIN syntax only (M40 to M45 and S)")
GEAR_AND_HOMING = Fault(20942, "M{stage} and G74 in one block")

# Tapping
TAPPING_AND_M = Fault(21640, "{word} with {g}: the path turns the spindle; end {g} with another path function first")
TAPPING_WITHOUT_POSITION = Fault(
    21641,
    "{g} needs a spindle with an actual position (P-AXIS-00320, P-SIM-00050) that the NC moves, {spindle} is none",
)
TAPPING_WHILE_TURNING = Fault(
    21654, "{g} while spindle {spindle} turns: it must be at a standstill (M05 or M19 in a block before)"
)
TAPPING_TWO = Fault(21655, "{g} with the speeds of two spindles, {first} and {second}: the path turns one of them")
TAPPING_FEED_MODE = Fault(21642, "{g} needs a feed in mm/min (G94), G{mode} is active")
TAPPING_FEED_ZERO = Fault(21643, "{g} with feed 0: it needs F = S times the pitch")
TAPPING_SPEED_ZERO = Fault(21644, "{g} with speed 0 of spindle {spindle}: it needs S = F / pitch")
TAPPING_PITCH_MISSING = Fault(21645, "{g} without a pitch (I, J or K in mm per turn)")
PITCH_TWICE = Fault(21646, "pitches {first} and {second} in one block")
PITCH_ZERO = Fault(21647, "pitch {word}0 of {g} must not be 0")
PITCH_DIFFERS = Fault(
    21648,
    "feed {feed} mm/min with speed {speed} rpm makes a pitch of {made} mm, not {pitch} mm: it needs F{needed}"
    " (within {limit} %, P-CHAN-90020)",
)

# Commands
COMMAND_NOT_ALONE = Fault(21075, "{command} must be alone in its block, not with '{word}'")
COMMAND_ARGUMENTS = Fault(21076, "{command} is written {syntax}")
MAIN_SPINDLE_NUMBER = Fault(
    21306, "no spindle of this channel has the logical axis number {number}; known are: {known}"
)
MAIN_WITHOUT_NAME = Fault(
    21082, "spindle {spindle} has no name of its own (P-CHAN-00007) for use while {other} is the main spindle"
)
LINK_GROUP = Fault(21077, "coupling group {group} must be a number from {first} to {last}")
LINK_GROUP_DEFAULT = Fault(21078, "coupling group 0 is defined by P-CHAN-00037 and P-CHAN-00038 only")
LINK_RATIO = Fault(
    21084,
    "ratio {num} / {den} of spindle {spindle}: both must be numbers other than 0, their ratio within"
    " ±{smallest} ... ±{largest}",
)
LINK_DENOMINATOR = Fault(21085, "ratio {num} of spindle {spindle} without a denominator")
LINK_GANTRY = Fault(21086, "gantry coupling (G) of {slave}: path axes cannot be coupled by programs, spindles can")
LINK_EMPTY = Fault(21079, "coupling group {group} has no coupled pair")
LINK_NOT_ACTIVE = Fault(21080, "{what} active")
LINK_ACTIVE = Fault(20472, "coupling group {group} is active and cannot be redefined")
LINK_ITSELF = Fault(20475, "spindle {spindle} cannot be its own slave")
SLAVE_TWICE = Fault(20476, "spindle {spindle} is slave of two masters")
SLAVE_AND_MASTER = Fault(20477, "spindle {spindle} cannot be slave and master in one coupling group")
SLAVE_ELSEWHERE = Fault(21283, "slave {spindle} is slave in the active coupling group {group} already")
SLAVE_MASTERS = Fault(21284, "slave {spindle} is master in the active coupling group {group}")
MASTER_FOLLOWS = Fault(21285, "master {spindle} is slave in the active coupling group {group}")
SLAVE_IS_MAIN = Fault(21347, "slave {spindle} is the main spindle")
