"""Parameter lists in stages; each stage imports only from those before it.

declare/    the declarations of all parameters: names, types, ranges, units, texts (declarations.yaml)
read/       a machine file -> one ParameterSet per node, each value checked against its declaration
view/       parameter sets -> the parameters of the kernel: AxisParameters and others, in kernel units
check/      parameters against each other: problems, and notices for the log

errors.py and list_units.py are below all of them, loader.py above: `load_machine(text, file)` is pure,
`machine_text(path)` reads a machine file and those that it names, `read_machine(path)` does both. They give
MachineParameters or raise ParameterError with everything that is wrong.
"""

from cnc_ptp.parameters.declare.declarations import Declaration, catalogue
from cnc_ptp.parameters.errors import ParameterError, Place, Problem
from cnc_ptp.parameters.loader import (
    complete_text,
    examine_machine,
    load_machine,
    machine_files,
    machine_text,
    read_machine,
)
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.axis_view import AxisParameters
from cnc_ptp.parameters.view.channel_view import ChannelAxis, ChannelParameters, ChannelSpindle, ToolLimits
from cnc_ptp.parameters.view.descriptors import RosDescriptor, ros_descriptors
from cnc_ptp.parameters.view.machine_view import MachineParameters
from cnc_ptp.parameters.view.offsets_view import NO_OFFSET_TABLES, OffsetTables
from cnc_ptp.parameters.view.spindle_view import CurveParameters, GearParameters, SpindleParameters
from cnc_ptp.parameters.view.synchronisation import Synchronisation
from cnc_ptp.parameters.view.tool_view import NO_TOOLS, Tool, ToolTable

__all__ = [
    "NO_OFFSET_TABLES",
    "NO_TOOLS",
    "AxisParameters",
    "ChannelAxis",
    "ChannelParameters",
    "ChannelSpindle",
    "CurveParameters",
    "Declaration",
    "GearParameters",
    "MachineParameters",
    "OffsetTables",
    "ParameterError",
    "ParameterSet",
    "Place",
    "Problem",
    "RosDescriptor",
    "SpindleParameters",
    "Synchronisation",
    "Tool",
    "ToolLimits",
    "ToolTable",
    "catalogue",
    "complete_text",
    "examine_machine",
    "load_machine",
    "machine_files",
    "machine_text",
    "read_machine",
    "ros_descriptors",
]
