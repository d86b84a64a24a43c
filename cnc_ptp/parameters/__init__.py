"""Parameter lists: declarations, machine files, typed views in kernel units.

`load_machine(text, file)` is pure, `read_machine(path)` reads a file. Both give MachineParameters or raise
ParameterError with everything that is wrong.
"""

from cnc_ptp.parameters.channel_view import ChannelAxis, ChannelParameters, ChannelSpindle, ToolLimits
from cnc_ptp.parameters.declarations import Declaration, catalogue
from cnc_ptp.parameters.descriptors import RosDescriptor, ros_descriptors
from cnc_ptp.parameters.errors import ParameterError, Place, Problem
from cnc_ptp.parameters.loader import load_machine, read_machine
from cnc_ptp.parameters.parameter_set import ParameterSet
from cnc_ptp.parameters.spindle_view import CurveParameters, GearParameters, SpindleParameters
from cnc_ptp.parameters.synchronisation import Synchronisation
from cnc_ptp.parameters.views import AxisParameters, MachineParameters

__all__ = [
    "AxisParameters",
    "ChannelAxis",
    "ChannelParameters",
    "ChannelSpindle",
    "CurveParameters",
    "Declaration",
    "GearParameters",
    "MachineParameters",
    "ParameterError",
    "ParameterSet",
    "Place",
    "Problem",
    "RosDescriptor",
    "SpindleParameters",
    "Synchronisation",
    "ToolLimits",
    "catalogue",
    "load_machine",
    "read_machine",
    "ros_descriptors",
]
