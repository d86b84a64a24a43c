"""Checks that axes and spindles share: emergency ramp, encoder resolution, axis type, soft limits."""

from collections.abc import Iterator

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.check.limit_checks import other_name
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.axis_view import SOFT_LIMITS, is_modulo
from cnc_ptp.parameters.view.encoder import uses_feed_constant
from cnc_ptp.parameters.view.homing_view import DRIVE_CONTROLLED, IGNORE_ABSOLUTE
from cnc_ptp.parameters.view.telegram import DriveType, interface


def emergency_ramp(parameters: ParameterSet) -> Iterator[Problem]:
    """P-AXIS-00003 is at most twice P-AXIS-00008."""
    for gear in parameters.used_indexes("getriebe"):
        value, limit = parameters.number(ids.DYNAMIK_A_EMERGENCY, gear), 2 * parameters.number(ids.DYNAMIK_A_MAX, gear)
        if value > limit:
            name = other_name(parameters, parameters.catalogue.by_id[ids.DYNAMIK_A_MAX], (gear,))
            unit = parameters.unit(ids.DYNAMIK_A_EMERGENCY)
            text = f"value {value} is above the maximum {limit} {unit}, twice {name}"
            yield problem(parameters, errors.CONTRADICTION, ids.DYNAMIK_A_EMERGENCY, (gear,), text)


def encoder_resolution(parameters: ParameterSet) -> Iterator[Problem]:
    """The resolution must not be zero, nor given by both methods."""
    if not uses_feed_constant(parameters):
        return
    for gear in sorted({0, *parameters.used_indexes("getriebe")}):
        if parameters.number(ids.GETRIEBE_INCR_PER_REV, gear) == 0:
            text = "value 0 makes the encoder resolution zero, P-AXIS-00362 and P-AXIS-00363 (feed constant) are in use"
            yield problem(parameters, errors.RESOLUTION, ids.GETRIEBE_INCR_PER_REV, (gear,), text)
        for number in (ids.GETRIEBE_WEGAUFZ, ids.GETRIEBE_WEGAUFN):
            value = parameters.number(number, gear)
            if value != 1:
                text = f"value {value} must be 1, P-AXIS-00362 and P-AXIS-00363 (feed constant) give the resolution"
                yield problem(parameters, errors.RESOLUTION, number, (gear,), text)


def axis_type_fits(parameters: ParameterSet) -> Iterator[Problem]:
    """Path axes under `axes`, spindles under `spindles`."""
    spindle = parameters.axis_type == "S"
    if spindle != (parameters.kind == "spindle"):
        value = parameters.text(ids.KENNGR_ACHS_TYP)
        listed, belongs = ("axes", "spindles") if spindle else ("spindles", "axes")
        text = f"value {value} does not fit, /machine has /{parameters.node} under {listed}, it belongs under {belongs}"
        yield problem(parameters, errors.AXIS_TYPE, ids.KENNGR_ACHS_TYP, (), text)


def soft_limits_of_a_conveyor(parameters: ParameterSet) -> Iterator[Problem]:
    """A linear modulo axis has no soft limits; somebody who gives some relies on them."""
    if parameters.axis_type != "T" or not is_modulo(parameters):
        return
    mode = int(parameters.number(ids.KENNGR_ACHS_MODE))
    for number in SOFT_LIMITS:
        if parameters.is_given(number):
            text = (
                f"value {parameters.number(number)} would not limit the axis, P-AXIS-00015 kenngr.achs_mode "
                f"0x{mode:x} makes it an endless modulo axis; leave out one of the two"
            )
            yield problem(parameters, errors.CONTRADICTION, number, (), text)


def homing_without_cam(parameters: ParameterSet) -> Iterator[Problem]:
    if parameters.number(ids.KENNGR_REF_OHNE_NOCKEN) and not parameters.number(ids.KENNGR_REF_OHNE_REV):
        yield problem(
            parameters,
            errors.CONTRADICTION,
            ids.KENNGR_REF_OHNE_NOCKEN,
            (),
            "value 1 needs P-AXIS-00157 kenngr.ref_ohne_rev = 1",
        )


def homing_of_an_axis(parameters: ParameterSet) -> Iterator[Problem]:
    """Homing needs a signal; an axis that G74 leaves out needs an absolute encoder."""
    if parameters.number(ids.KENNGR_HOMING_WITHOUT_ZERO_PULSE) and parameters.number(ids.KENNGR_REF_OHNE_NOCKEN):
        text = "value 1 leaves homing without a signal, P-AXIS-00156 kenngr.ref_ohne_nocken is 1"
        yield problem(parameters, errors.CONTRADICTION, ids.KENNGR_HOMING_WITHOUT_ZERO_PULSE, (), text)
    absolute = parameters.number(ids.SIMULATION_REFERENCED_AT_START)
    if parameters.text(ids.HOMING_HOMING_TYPE) == IGNORE_ABSOLUTE and not absolute:
        text = f"{IGNORE_ABSOLUTE} needs an axis that is referenced at start, P-SIM-00005 is 0"
        yield problem(parameters, errors.CONTRADICTION, ids.HOMING_HOMING_TYPE, (), text)
    if parameters.text(ids.HOMING_HOMING_TYPE) == DRIVE_CONTROLLED:
        yield from homing_by_drive(parameters)


def homing_by_drive(parameters: ParameterSet) -> Iterator[Problem]:
    """Only a SERCOS drive homes on its own, if it has a velocity controller."""
    kind = int(parameters.number(ids.KENNGR_ANTR_TYP))
    if kind != DriveType.SERCOS:
        text = f"{DRIVE_CONTROLLED} needs a SERCOS drive, P-AXIS-00020 kenngr.antr_typ is {kind}"
        yield problem(parameters, errors.CONTRADICTION, ids.HOMING_HOMING_TYPE, (), text)
    elif interface(parameters) == "torque":
        text = f"{DRIVE_CONTROLLED} needs a drive that takes velocities or positions, it takes torques"
        yield problem(parameters, errors.CONTRADICTION, ids.HOMING_HOMING_TYPE, (), text)
