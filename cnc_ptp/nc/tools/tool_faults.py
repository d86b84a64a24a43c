"""Faults of tools."""

from cnc_ptp.nc.faults import Fault

DATA_UNKNOWN = Fault(20296, "{word}: the tool table has no compensation data D{number}; known are: {known}")
NO_TABLE = Fault(
    21656, "{word}: there are no compensation data {number}, the machine has no tool table (werkz_data, wz[{number}])"
)
TOOL_UNKNOWN = Fault(21650, "tool T{number} is not in the tool table; known are: {known}")
DATA_INVALID = Fault(21651, "{word}: compensation data D{number} are not valid (P-TOOL-00005 wz[{number}].gueltig)")
LENGTH_AXIS = Fault(
    21652, "the tool of D{number} is {length} mm long in axis {axis} (G{plane}), which this channel does not have"
)
WRITTEN_WITH_D = Fault(20738, "{name} is written in a block with {word}, which selects other data")
TOOL_NUMBER = Fault(20863, "{command}: tool number {value} must be an integer from 0 to {limit}")
NO_SISTER = Fault(
    21915, "{command} [{tool}]: the tool table has no sister tools and variants, their numbers must be 0 or missing"
)
VALUE_INDEX = Fault(21653, "value {index} of a tool must be an integer from 0 to {limit}")
