"""Faults of conditions, loops, jumps and subroutines."""

from cnc_ptp.nc.faults import Fault

STRAY = {
    keyword: Fault(number, f"{keyword} without {opened} before it")
    for keyword, number, opened in (
        ("$ELSEIF", 20216, "$IF"),
        ("$ELSE", 21560, "$IF"),
        ("$ENDIF", 20218, "$IF"),
        ("$CASE", 21561, "$SWITCH"),
        ("$DEFAULT", 20223, "$SWITCH"),
        ("$ENDSWITCH", 21562, "$SWITCH"),
        ("$ENDFOR", 20232, "$FOR"),
        ("$ENDWHILE", 20237, "$WHILE"),
        ("$ENDDO", 21563, "$DO"),
        ("$UNTIL", 21564, "$REPEAT"),
        ("$BREAK", 21565, "a loop or $SWITCH"),
        ("$CONTINUE", 20244, "a loop"),
    )
}
"""By the keyword that closes or divides a structure which was not opened."""
UNKNOWN_KEYWORD = Fault(21566, "{word} is no control statement{nearest}")
NOT_CLOSED = Fault(21501, "{keyword} of line {line} has no {closing} before the end of {program}")
CROSSED = Fault(21567, "{keyword} stands within {opened} of line {line}, which has no {closing} yet")
AFTER_ELSE = Fault(21568, "{keyword} after $ELSE of line {line}")
SECOND_DEFAULT = Fault(21569, "second $DEFAULT of one $SWITCH, the first is in line {line}")
BEFORE_CASE = Fault(21570, "'{word}' between $SWITCH and its first $CASE is never executed")
WORDS_BEFORE = Fault(21571, "{keyword} must be alone in its block, '{word}' stands before it")
WORDS_AFTER = Fault(21572, "'{word}' after {keyword}: it must be alone in its block")
WORDS_AFTER_WHILE = Fault(20235, "'{word}' after the condition of $WHILE")
WORDS_AFTER_BREAK = Fault(20242, "'{word}' after $BREAK: it must be alone in its block")
CONDITION_MISSING = Fault(21573, "{keyword} without a condition or a value")
COUNTER = Fault(20227, "$FOR needs a parameter or a variable to count with, not '{word}'")
COUNTER_EQUALS = Fault(20228, "$FOR without '=' behind its counter")
COUNTER_COMMA = Fault(20229, "$FOR needs start, end and step with commas between them")
STEP_ZERO = Fault(21574, "the step of $FOR is 0: the loop would never end")
LABEL_TARGET = Fault(20839, "'{word}' after $GOTO is neither a label N100 nor [NAME]")
LABEL_TWICE = Fault(20836, "label {label} twice in {program}, first in line {line}")
LABEL_UNKNOWN = Fault(21575, "{program} has no label {label}{nearest}")
LABEL_MISSING = Fault(21590, "$GOTO without a label")
JUMP_INTO_LOOP = Fault(21576, "$GOTO {label} leads into {keyword} of line {line}")
TOO_DEEP = Fault(21577, "{keyword} at level {depth}, the limit is {limit}")
LOOP_LIMIT = Fault(21578, "the program has {what} {limit} times (P-CHAN-90002): does it have a loop without an end?")
ENDLESS = Fault(21583, "a loop without an end: the program comes back with the same positions and values each time")
VALUE_MISSING = Fault(21579, "{target} without '=' and a value{hint}")
LINE_TOO_LONG = Fault(21580, "the block has {length} characters, the limit is {limit}")
SECTION_OPEN = Fault(21581, "{begin} of line {line} has no {end}")
SECTION_STRAY = Fault(21582, "{end} without {begin} before it")
ARGUMENT_TWICE = Fault(21584, "parameter {name} twice in one call")
ARGUMENT_UNREAD = Fault(21596, "{program} does not read parameter {name}; parameters that it reads: {known}")
CYCLE_NAME = Fault(21585, "a cycle call needs NAME=...")
ARGUMENT_MISSING = Fault(21599, "{call} does not give {name}, which {file} reads in line {line}")
CYCLE_WORD = Fault(
    21591, "'{word}' is not available in a cycle call; there are NAME=..., @P1=..., MODAL_MOVE and MODAL_BLOCK"
)
FILE_FOLDER = Fault(21592, "{name}: programs are called by their name alone, they are looked for in the search folders")
CALL_BRACKET = Fault(21597, "parameters need a cycle call: {scope} CYCLE [NAME={name} @P1=...]")
CYCLE_FILE = Fault(
    21598,
    "{g} calls {file} ({parameter}), which is in no search folder; put a program of this name beside the main one",
)
FILE_UNKNOWN = Fault(21586, "no program {name} in the search folders{nearest}")
DECLARATION = Fault(20908, "'{word}' between #VAR and #ENDVAR: only V.P., V.L., V.S., V.CYC. and P are declared")
DECLARATION_LIST = Fault(21587, "the first values of the array {name} need brackets: = [1, 2, 3]")
TYPE_UNKNOWN = Fault(21588, "type {word} is not known; known are: {known}")
STRING_LENGTH = Fault(21589, "STRING needs its length in brackets, 1 to {limit}")

# Words of # commands
COMMAND_SYNTAX = Fault(21615, "'{word}' is not available in {command}; its syntax is {syntax}")
COMMAND_VALUE = Fault(21616, "{command} without {missing}; its syntax is {syntax}")

# Messages
MESSAGE_VALUES = Fault(20721, "the text needs {wanted} for its %d, %f and %s, not {given}")
MESSAGE_FORMAT = Fault(20726, "'{word}' in the text of a message: there are %d, %f, %s, and %% for a percent sign")
MESSAGE_MODE = Fault(21593, "#MSG {mode} waits for an acknowledgement, which is not available yet")
ERROR_ID = Fault(21594, "#ERROR ID={value} is not within 1 ... {limit}")
ERROR_REACTION = Fault(21595, "#ERROR RC={value}: there are 0 (warning), 2 (error) and 7 (fatal error)")
