"""What no single value of a spindle shows: curves, homing, drive and feedback against each other."""

from collections.abc import Callable, Iterator

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.encoder import uses_feed_constant
from cnc_ptp.parameters.view.gears import active_gear, gear_records
from cnc_ptp.parameters.view.spindle_view import (
    COEFFICIENTS,
    CURVE_TYPES,
    EXTERNALLY_CONTROLLED,
    OPEN_LOOP_FEEDBACK,
    control_limit,
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
ROUNDING = 1e-6
"""Part of the largest acceleration by which rounded coefficients of a curve may pass it."""
STEPS = 1000
"""Places between the limit speed and the largest speed at which a curve is looked at."""


def spindle_problems(parameters: ParameterSet) -> Iterator[Problem]:
    """All of them, for one spindle."""
    checks = plc_spindle, homing_without_cam, open_loop_drive, feedback_of_the_mode, open_loop_resolution, gear_at_start
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


def homing_without_cam(parameters: ParameterSet) -> Iterator[Problem]:
    if parameters.number(ids.KENNGR_REF_OHNE_NOCKEN) and not parameters.number(ids.KENNGR_REF_OHNE_REV):
        yield problem(
            parameters,
            errors.CONTRADICTION,
            ids.KENNGR_REF_OHNE_NOCKEN,
            (),
            "value 1 needs P-AXIS-00157 kenngr.ref_ohne_rev = 1",
        )


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
    """An actual speed that is computed from positions needs a resolution that somebody has thought of."""
    if not is_open_loop(parameters) or not has_position(parameters) or uses_feed_constant(parameters):
        return
    gear = active_gear(parameters)
    if not (parameters.is_given(ids.GETRIEBE_WEGAUFZ, gear) or parameters.is_given(ids.GETRIEBE_WEGAUFN, gear)):
        text = "no resolution is given, but the actual speed of the open position loop comes from positions"
        yield problem(parameters, errors.RESOLUTION, ids.GETRIEBE_WEGAUFZ, (gear,), text)


def gear_at_start(parameters: ParameterSet) -> Iterator[Problem]:
    """It needs its record; a spindle without any has gear 1 with all its defaults."""
    stage, records = int(parameters.number(ids.KENNGR_GETRIEBE_STUFE)), parameters.used_indexes("getriebe")
    if stage - 1 in records or (stage == 1 and not records):
        return
    known = ", ".join(f"getriebe[{index}]" for index in records) or "none"
    text = f"value {stage} has no record getriebe[{stage - 1}], there {'are' if len(records) > 1 else 'is'} {known}"
    yield problem(parameters, errors.CONTRADICTION, ids.KENNGR_GETRIEBE_STUFE, (), text)


def homing_speed(parameters: ParameterSet, gear: int) -> Iterator[Problem]:
    """The zero pulse can be seen below the control limit only."""
    speed, limit = parameters.kernel(ids.GETRIEBE_VB_REFLOW, gear), control_limit(parameters, gear)
    if speed > limit and has_position(parameters) and not is_open_loop(parameters):
        text = (
            f"value {parameters.number(ids.GETRIEBE_VB_REFLOW, gear)} is above the control limit "
            f"{parameters.number(ids.GETRIEBE_VB_REGELGRENZE, gear)} (0.001°/s) of P-AXIS-00220 "
            f"getriebe[{gear}].vb_regelgrenze"
        )
        yield problem(parameters, errors.CONTRADICTION, ids.GETRIEBE_VB_REFLOW, (gear,), text)


# ---------------------------------------------------------------- acceleration curves


def curve(parameters: ParameterSet, gear: int) -> Iterator[Problem]:
    """A curve must be whole and bring the spindle to its largest speed."""
    kind = CURVE_TYPES.get(int(parameters.number(ids.BESCHL_KENNLINIE_TYP, gear)), "")
    if not kind:
        return
    own = (
        (ids.BESCHL_KENNLINIE_A_MAX, ids.BESCHL_KENNLINIE_N1)
        if kind == "asynchronous"
        else (ids.BESCHL_KENNLINIE_A_KONST, ids.BESCHL_KENNLINIE_N_GRENZ)
    )
    missing = [number for number in own if parameters.number(number, gear) == 0]
    for number in missing:
        yield problem(
            parameters, errors.CONTRADICTION, number, (gear,), f"value 0 makes no {kind} curve (P-AXIS-00202)"
        )
    least = parameters.number(ids.BESCHL_KENNLINIE_A_MIN, gear)
    if not missing and least > parameters.number(own[0], gear):
        text = f"value {least} is above {parameters.number(own[0], gear):g} °/s² of {own[0]}"
        yield problem(parameters, errors.CONTRADICTION, ids.BESCHL_KENNLINIE_A_MIN, (gear,), text)
    elif not missing and kind != "asynchronous":
        yield from curve_to_the_top(parameters, gear, kind)


def curve_to_the_top(parameters: ParameterSet, gear: int, kind: str) -> Iterator[Problem]:
    """No acceleration up to the largest speed may be zero, negative, infinite or above the largest one.

    The constant acceleration has that bound as its range.
    """
    value: Callable[[ParameterSet, int, float], float] = hyperbola if kind == "hyperbola" else polynomial
    limit, top = parameters.kernel(ids.BESCHL_KENNLINIE_N_GRENZ, gear), parameters.kernel(ids.DYNAMIK_VB_MAX, gear)
    least, constant, most = (
        parameters.kernel(number, gear)
        for number in (ids.BESCHL_KENNLINIE_A_MIN, ids.BESCHL_KENNLINIE_A_KONST, ids.DYNAMIK_A_MAX)
    )
    for step in range(STEPS + 1):
        speed = limit + (top - limit) * step / STEPS
        acceleration = value(parameters, gear, speed) if speed >= limit else 1.0
        if not 0.0 < max(acceleration, least) < float("inf"):
            bound = f"within P-AXIS-00212 ({top:g} °/s)"
        elif acceleration > max(constant, most) * (1.0 + ROUNDING):
            bound = f"above P-AXIS-00008 getriebe[{gear}].dynamik.a_max ({most:g} °/s²)"
        else:
            continue
        text = f"the {kind} gives {acceleration:g} °/s² at {speed:g} °/s, {bound}"
        yield problem(parameters, errors.CONTRADICTION, ids.BESCHL_KENNLINIE_B1, (gear,), text)
        return


def polynomial(parameters: ParameterSet, gear: int, speed: float) -> float:
    """a(n) above the limit speed (2.8.4.1)."""
    d = speed - parameters.kernel(ids.BESCHL_KENNLINIE_N_GRENZ, gear)
    b1, b2, b3 = (parameters.kernel(number, gear) for number in COEFFICIENTS)
    return parameters.kernel(ids.BESCHL_KENNLINIE_A_KONST, gear) + d * (b1 + d * (b2 + d * b3))


def hyperbola(parameters: ParameterSet, gear: int, speed: float) -> float:
    """a(n) above the limit speed; infinite where the denominator is not positive."""
    x = speed / parameters.kernel(ids.BESCHL_KENNLINIE_N_GRENZ, gear)
    b1, b2, b3 = (parameters.kernel(number, gear) for number in COEFFICIENTS)
    denominator = 1.0 + b2 * x * x * (1.0 + b3 * x * x)
    return b1 / denominator if denominator > 0.0 else float("inf")
