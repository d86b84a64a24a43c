"""Resolution of the measuring system, given by increments per distance or by encoder, gear and feed constant."""

from fractions import Fraction

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet

CORRECTED = {ids.GETRIEBE_WEGAUFZ: 110386, ids.GETRIEBE_WEGAUFN: 110086}
"""Parameters whose 0 counts as 1, with the number of the warning."""


def uses_feed_constant(parameters: ParameterSet) -> bool:
    """Whether the resolution comes from incr_per_rev, gear ratio and feed constant."""
    return parameters.number(ids.ANTR_FEED_CONST_NUM) != 1 or parameters.number(ids.ANTR_FEED_CONST_DENOM) != 1


def resolution(parameters: ParameterSet, gear: int) -> Fraction:
    """R in increments per 0.1 µm (0.0001°): incr_per_rev · (gear ratio) / (feed constant), else wegaufz / wegaufn."""

    def whole(number: str) -> int:
        return int(parameters.number(number, gear)) or int(number in CORRECTED)

    if uses_feed_constant(parameters):
        ratio = Fraction(whole(ids.GETRIEBE_GEAR_FACT_NUM), whole(ids.GETRIEBE_GEAR_FACT_DENOM))
        feed_constant = Fraction(whole(ids.ANTR_FEED_CONST_NUM), whole(ids.ANTR_FEED_CONST_DENOM))
        return whole(ids.GETRIEBE_INCR_PER_REV) * ratio / feed_constant
    return Fraction(whole(ids.GETRIEBE_WEGAUFZ), whole(ids.GETRIEBE_WEGAUFN))


def increment(parameters: ParameterSet, gear: int) -> float:
    """mm or ° per increment, 1e-4 / R."""
    return float(1 / (10_000 * resolution(parameters, gear)))


def encoder_increment(parameters: ParameterSet, gear: int) -> float:
    """mm or ° per increment of the simulated encoder; 0.0 if it is off."""
    return increment(parameters, gear) if parameters.number(ids.SIMULATION_ENCODER) else 0.0
