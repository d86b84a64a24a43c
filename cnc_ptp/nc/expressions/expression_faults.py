"""Faults of expressions and variables."""

from cnc_ptp.nc.faults import Fault

# While a line is read
OPERAND_MISSING = Fault(21400, "an expression needs a value here, not '{word}'")
PARENTHESIS_OPEN = Fault(21401, "'{bracket}' is not closed in its line")
NAME_UNKNOWN = Fault(21402, "'{word}' is no function, constant or variable{nearest}")
ARGUMENT_COUNT = Fault(21403, "{function} takes {wanted}, not {given}")
TOO_DEEP = Fault(21404, "the expression is nested deeper than {limit} levels")
NUMBER_EXPECTED = Fault(21405, "{what} is a text where a number is needed")
TEXT_EXPECTED = Fault(21406, "a text is needed here, not a number")
TEXT_OPEN = Fault(21407, "the text in quotation marks is not closed in its line")
NOT_ASSIGNABLE = Fault(21408, "{name} can be read only")
EQUALS_FOR_COMPARISON = Fault(21409, "'=' assigns; two values are compared by '=='")
HEXADECIMAL = Fault(21410, "'{word}' is no hexadecimal number")

# While it is executed
DIVISION_BY_ZERO = Fault(20396, "division by 0")
OVERFLOW = Fault(21421, "the result of {operation} is beyond the range of numbers")
DOMAIN = Fault(21422, "{function} of {value} is not defined")
NOT_INTEGER = Fault(21423, "{what} needs an integer, not {value}")
POWER_UNDEFINED = Fault(21424, "{base} to the power of {exponent} is not a real number")
PARAMETER_NUMBER = Fault(21425, "P{number} does not exist: parameters are P0 to P{limit}")
PARAMETER_UNSET = Fault(20925, "parameter {name} has no value yet")
ARRAY_UNDECLARED = Fault(20921, "{name} is used as an array but was not declared with #VAR")
DELETED_UNKNOWN = Fault(20932, "#DELETE of {name}, which is not there{nearest}")
VARIABLE_UNKNOWN = Fault(21427, "variable {name} was not declared and has no value{nearest}")
NOT_AN_ARRAY = Fault(21428, "{name} is not an array")
INDEX_COUNT = Fault(21429, "{name} has {wanted}, not {given}")
INDEX_RANGE = Fault(21430, "index {index} of {name} is not within 0 ... {limit}")
INDEX_MISSING = Fault(21431, "{name} is an array and needs {wanted}")
TYPE_CHANGE = Fault(21432, "{name} holds a {kind} and takes no {other}")
TEXT_TOO_LONG = Fault(21433, "the text for {name} has {length} characters, the limit is {limit}")
TOO_MANY_VARIABLES = Fault(21434, "{name} would be value {count} of the channel, the limit is {limit}")
SIZE = Fault(21436, "{name} cannot have {size} elements")
TOO_MANY_INITIAL = Fault(21437, "{name} has {count} elements, but {given} first values")
DECLARED_TWICE = Fault(20909, "{name} is there already; #DELETE removes it")
UNIT_UNKNOWN = Fault(21435, "{name}: the channel has no {kind} {unit}; it has {known}")
