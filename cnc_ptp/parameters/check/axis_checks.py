"""What axes and spindles have in common: emergency ramp, encoder resolution, axis type, soft limits."""

from collections.abc import Iterator

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.check.limit_checks import other_name
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.axis_view import SOFT_LIMITS, is_modulo
from cnc_ptp.parameters.view.encoder import uses_feed_constant


def emergency_ramp(parameters: ParameterSet) -> Iterator[Problem]:
    """P-AXIS-00003 is at most twice P-AXIS-00008."""
    for gear in parameters.used_indexes("getriebe"):
        value, limit = parameters.number("P-AXIS-00003", gear), 2 * parameters.number("P-AXIS-00008", gear)
        if value > limit:
            name = other_name(parameters, parameters.catalogue.by_id["P-AXIS-00008"], (gear,))
            text = f"value {value} is above the maximum {limit} {parameters.unit('P-AXIS-00003')}, twice {name}"
            yield problem(parameters, errors.CONTRADICTION, "P-AXIS-00003", (gear,), text)


def encoder_resolution(parameters: ParameterSet) -> Iterator[Problem]:
    """The resolution must not be zero, nor given by both methods."""
    if not uses_feed_constant(parameters):
        return
    for gear in sorted({0, *parameters.used_indexes("getriebe")}):
        if parameters.number("P-AXIS-00092", gear) == 0:
            text = "value 0 makes the encoder resolution zero, P-AXIS-00362 and P-AXIS-00363 (feed constant) are in use"
            yield problem(parameters, errors.RESOLUTION, "P-AXIS-00092", (gear,), text)
        for number in ("P-AXIS-00234", "P-AXIS-00233"):
            value = parameters.number(number, gear)
            if value != 1:
                text = f"value {value} must be 1, P-AXIS-00362 and P-AXIS-00363 (feed constant) give the resolution"
                yield problem(parameters, errors.RESOLUTION, number, (gear,), text)


def axis_type_fits(parameters: ParameterSet) -> Iterator[Problem]:
    """Path axes under `axes`, spindles under `spindles`."""
    spindle = parameters.axis_type == "S"
    if spindle != (parameters.kind == "spindle"):
        value = parameters.text("P-AXIS-00018")
        listed, belongs = ("axes", "spindles") if spindle else ("spindles", "axes")
        text = f"value {value} does not fit, /machine has /{parameters.node} under {listed}, it belongs under {belongs}"
        yield problem(parameters, errors.AXIS_TYPE, "P-AXIS-00018", (), text)


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
