"""Modulo axes (P-AXIS-00015): what makes one, and what a linear one needs."""

from collections.abc import Iterator

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.lines import Notice, line
from cnc_ptp.parameters.parameter_set import ParameterSet
from cnc_ptp.parameters.problems import problem

MODULO, MODULO_LINEAR = 0x4, 0x400
"""Bits of P-AXIS-00015; the second one is for linear axes."""
SOFT_LIMITS = ("P-AXIS-00177", "P-AXIS-00178")
UPPER_END = "P-AXIS-00126"


def is_modulo(parameters: ParameterSet) -> bool:
    bits = MODULO | MODULO_LINEAR if parameters.axis_type == "T" else MODULO
    return bool(int(parameters.number("P-AXIS-00015")) & bits)


def soft_limits_of_a_conveyor(parameters: ParameterSet) -> Iterator[Problem]:
    """A linear modulo axis has no soft limits: whoever gives some counts on them."""
    if parameters.axis_type != "T" or not is_modulo(parameters):
        return
    mode = int(parameters.number("P-AXIS-00015"))
    for number in SOFT_LIMITS:
        if parameters.is_given(number):
            text = (
                f"value {parameters.number(number)} would not limit the axis, P-AXIS-00015 kenngr.achs_mode "
                f"0x{mode:x} makes it an endless modulo axis; leave out one of the two"
            )
            yield problem(parameters, errors.CONTRADICTION, number, (), text)


def range_of_a_conveyor(parameters: ParameterSet) -> Iterator[Notice]:
    """The default suits a turntable, hardly a conveyor."""
    if parameters.axis_type != "T" or not is_modulo(parameters):
        return
    gear = int(parameters.number("P-AXIS-00079")) - 1
    if not parameters.is_given(UPPER_END, gear):
        end = parameters.kernel(UPPER_END, gear)
        yield line(parameters, UPPER_END, (gear,), f"not given, the modulo range of the axis ends at {end:g} mm")
