"""Resolution of the measuring system, given by increments per way or by encoder, gear and feed constant."""

from fractions import Fraction

from cnc_ptp.parameters.read.parameter_set import ParameterSet

CORRECTED = {"P-AXIS-00234": 110386, "P-AXIS-00233": 110086}
"""Parameters of which a 0 counts as 1, with the number of the warning."""


def uses_feed_constant(parameters: ParameterSet) -> bool:
    """Whether the resolution comes from incr_per_rev, gear ratio and feed constant."""
    return parameters.number("P-AXIS-00362") != 1 or parameters.number("P-AXIS-00363") != 1


def resolution(parameters: ParameterSet, gear: int) -> Fraction:
    """R in increments per 0.1 µm (0.0001°): incr_per_rev · (gear ratio) / (feed constant), else wegaufz / wegaufn."""

    def whole(number: str) -> int:
        return int(parameters.number(number, gear)) or int(number in CORRECTED)

    if uses_feed_constant(parameters):
        ratio = Fraction(whole("P-AXIS-00511"), whole("P-AXIS-00512"))
        return whole("P-AXIS-00092") * ratio / Fraction(whole("P-AXIS-00362"), whole("P-AXIS-00363"))
    return Fraction(whole("P-AXIS-00234"), whole("P-AXIS-00233"))


def encoder_increment(parameters: ParameterSet, gear: int) -> float:
    """mm or ° an increment, 1e-4 / R; 0.0 when the simulated encoder is off."""
    return float(1 / (10_000 * resolution(parameters, gear))) if parameters.number("P-SIM-00002") else 0.0
