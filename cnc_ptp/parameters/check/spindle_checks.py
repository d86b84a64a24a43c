"""Parameters of a spindle against each other: curves, homing, drive and feedback."""

from collections.abc import Iterator

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.encoder import uses_feed_constant
from cnc_ptp.parameters.view.gears import active_gear, gear_records
from cnc_ptp.parameters.view.spindle_view import (
    EXTERNALLY_CONTROLLED,
    OPEN_LOOP_FEEDBACK,
    CurveParameters,
    control_limit,
    curve_view,
    has_position,
)
from cnc_ptp.parameters.view.telegram import WITHOUT_FORMAT, DriveType, is_open_loop

OPEN_LOOP_DRIVES = (
    DriveType.SIMULATION,
    DriveType.LIGHTBUS,
    DriveType.TERMINAL,
    DriveType.ETHERNET,
    DriveType.CANOPEN,
)
NEEDED = (ids.BESCHL_KENNLINIE_A_KONST, ids.BESCHL_KENNLINIE_N_GRENZ)
"""Parameters without which there is no hyperbola or polynomial."""
NEEDED_OF_ASYNCHRONOUS = (ids.BESCHL_KENNLINIE_A_MAX, ids.BESCHL_KENNLINIE_N1)
ROUNDING = 1e-6
"""Fraction of the largest acceleration by which a curve with rounded coefficients may exceed it."""
STEPS = 1000
"""Number of intervals between the limit speed and the largest speed at whose ends a curve is checked."""


def spindle_problems(parameters: ParameterSet) -> Iterator[Problem]:
    """All problems of one spindle."""
    checks = plc_spindle, open_loop_drive, feedback_of_the_mode, open_loop_resolution, gear_at_start
    for check in checks:
        yield from check(parameters)
    for gear in gear_records(parameters):
        yield from homing_speed(parameters, gear)
        yield from curve(parameters, gear)


def plc_spindle(parameters: ParameterSet) -> Iterator[Problem]:
    """A spindle that the PLC controls has no drive of the NC."""
    drive = parameters.number(ids.KENNGR_ANTR_TYP)
    if int(parameters.number(ids.KENNGR_ACHS_MODE)) & EXTERNALLY_CONTROLLED and drive not in WITHOUT_FORMAT:
        text = f"value {drive} must be 4 (simulation) or 16 (virtual axis), the PLC controls the spindle (P-AXIS-00015)"
        yield problem(parameters, errors.CONTRADICTION, ids.KENNGR_ANTR_TYP, (), text)


def open_loop_drive(parameters: ParameterSet) -> Iterator[Problem]:
    drive = int(parameters.number(ids.KENNGR_ANTR_TYP))
    if is_open_loop(parameters) and drive not in OPEN_LOOP_DRIVES:
        mode, names = parameters.text(ids.ANTR_OPERATION_MODE), parameters.catalogue.by_id[ids.KENNGR_ANTR_TYP].choices
        allowed = ", ".join(f"{number} {names[number]}" for number in OPEN_LOOP_DRIVES)
        text = f"{mode} does not exist for drive type {drive} {names[drive]} (P-AXIS-00020), only for {allowed}"
        yield problem(parameters, errors.CONTRADICTION, ids.ANTR_OPERATION_MODE, (), text)


def feedback_of_the_mode(parameters: ParameterSet) -> Iterator[Problem]:
    """The telegram must have what the mode of operation needs."""
    mode, telegram = parameters.text(ids.ANTR_OPERATION_MODE), parameters.text(ids.SIMULATION_TELEGRAM)
    needed = OPEN_LOOP_FEEDBACK.get(mode, "" if is_open_loop(parameters) else "POSITION")
    enough = {"POSITION": ("POSITION",), "SPEED": ("POSITION", "SPEED")}.get(needed, (telegram,))
    if telegram not in enough:
        text = f"value {telegram} is not enough for P-AXIS-00320 {mode}, which needs {needed}"
        yield problem(parameters, errors.CONTRADICTION, ids.SIMULATION_TELEGRAM, (), text)


def open_loop_resolution(parameters: ParameterSet) -> Iterator[Problem]:
    """An actual speed that is computed from positions needs a resolution that the file gives."""
    if not is_open_loop(parameters) or not has_position(parameters) or uses_feed_constant(parameters):
        return
    gear = active_gear(parameters)
    if not (parameters.is_given(ids.GETRIEBE_WEGAUFZ, gear) or parameters.is_given(ids.GETRIEBE_WEGAUFN, gear)):
        text = "no resolution is given, but the actual speed of the open position loop comes from positions"
        yield problem(parameters, errors.RESOLUTION, ids.GETRIEBE_WEGAUFZ, (gear,), text)


def gear_at_start(parameters: ParameterSet) -> Iterator[Problem]:
    """The gear at start needs its record; a spindle without any record has gear 1 with all defaults."""
    stage, records = int(parameters.number(ids.KENNGR_GETRIEBE_STUFE)), parameters.used_indexes("getriebe")
    if stage - 1 in records or (stage == 1 and not records):
        return
    known = ", ".join(f"getriebe[{index}]" for index in records) or "none"
    text = f"value {stage} has no record getriebe[{stage - 1}], there {'are' if len(records) > 1 else 'is'} {known}"
    yield problem(parameters, errors.CONTRADICTION, ids.KENNGR_GETRIEBE_STUFE, (), text)


def homing_speed(parameters: ParameterSet, gear: int) -> Iterator[Problem]:
    """The zero pulse can only be seen below the control limit."""
    text = above_control_limit(parameters, ids.GETRIEBE_VB_REFLOW, gear)
    if text and has_position(parameters):
        yield problem(parameters, errors.CONTRADICTION, ids.GETRIEBE_VB_REFLOW, (gear,), text)


def above_control_limit(parameters: ParameterSet, number: str, gear: int) -> str:
    """Text if a speed is above the control limit of a closed position loop, else empty."""
    if is_open_loop(parameters) or parameters.kernel(number, gear) <= control_limit(parameters, gear):
        return ""
    limit = f"{parameters.number(ids.GETRIEBE_VB_REGELGRENZE, gear)} (0.001°/s)"
    name = f"P-AXIS-00220 getriebe[{gear}].vb_regelgrenze"
    return f"value {parameters.number(number, gear)} is above the control limit {limit} of {name}"


# ---------------------------------------------------------------- acceleration curves


def curve(parameters: ParameterSet, gear: int) -> Iterator[Problem]:
    """A curve must be complete and bring the spindle to its largest speed."""
    curve = curve_view(parameters, gear)
    if curve is None:
        return
    own = NEEDED_OF_ASYNCHRONOUS if curve.kind == "asynchronous" else NEEDED
    missing = [number for number in own if parameters.number(number, gear) == 0]
    for number in missing:
        text = f"value 0 gives no {curve.kind} curve (P-AXIS-00202)"
        yield problem(parameters, errors.CONTRADICTION, number, (gear,), text)
    least, most = parameters.number(ids.BESCHL_KENNLINIE_A_MIN, gear), parameters.number(own[0], gear)
    if not missing and least > most:
        text = f"value {least} is above {most:g} °/s² of {own[0]}"
        yield problem(parameters, errors.CONTRADICTION, ids.BESCHL_KENNLINIE_A_MIN, (gear,), text)
    elif not missing and curve.kind != "asynchronous":
        yield from curve_to_the_top(parameters, gear, curve)


def curve_to_the_top(parameters: ParameterSet, gear: int, curve: CurveParameters) -> Iterator[Problem]:
    """No acceleration up to the largest speed may be zero, negative, infinite or above the largest one.

    The constant acceleration has that bound as its range.
    """
    value = hyperbola if curve.kind == "hyperbola" else polynomial
    top, most = parameters.kernel(ids.DYNAMIK_VB_MAX, gear), parameters.kernel(ids.DYNAMIK_A_MAX, gear)
    for step in range(STEPS + 1):
        speed = curve.limit_speed + (top - curve.limit_speed) * step / STEPS
        acceleration = value(curve, speed) if speed >= curve.limit_speed else 1.0
        if not 0.0 < max(acceleration, curve.minimum) < float("inf"):
            bound = f"within P-AXIS-00212 ({top:g} °/s)"
        elif acceleration > max(curve.constant, most) * (1.0 + ROUNDING):
            bound = f"above P-AXIS-00008 getriebe[{gear}].dynamik.a_max ({most:g} °/s²)"
        else:
            continue
        text = f"the {curve.kind} gives {acceleration:g} °/s² at {speed:g} °/s, {bound}"
        yield problem(parameters, errors.CONTRADICTION, ids.BESCHL_KENNLINIE_B1, (gear,), text)
        return


def polynomial(curve: CurveParameters, speed: float) -> float:
    """a(n) above the limit speed (2.8.4.1)."""
    d = speed - curve.limit_speed
    return curve.constant + d * (curve.b1 + d * (curve.b2 + d * curve.b3))


def hyperbola(curve: CurveParameters, speed: float) -> float:
    """a(n) above the limit speed; infinite if the denominator is not positive."""
    x = speed / curve.limit_speed
    denominator = 1.0 + curve.b2 * x * x * (1.0 + curve.b3 * x * x)
    return curve.b1 / denominator if denominator > 0.0 else float("inf")
