"""The canonical stream as text: one line for each block, for golden streams and `cnc_ptp check --canonical`."""

from cnc_ptp.nc.canonical import (
    AuxiliaryFunction,
    AxisFeedforward,
    CanonicalBlock,
    CompensationSwitch,
    ControlFunction,
    CuttingSpeed,
    Dwell,
    ExplicitSynchronisation,
    Function,
    GearChange,
    HomeAxes,
    KinematicsChange,
    LanguageWarning,
    LinearMove,
    MachineData,
    Message,
    Motion,
    OrderedError,
    SpindleAxis,
    SpindleCommand,
    SpindleFeedforward,
    SpindleFunction,
    SpindleLink,
    Thread,
    Timer,
    WaitForPath,
    number,
)
from cnc_ptp.nc.contour import DEV, POS, Transition


def format_block(block: CanonicalBlock) -> str:
    """One line for golden streams: line, block number, functions, motion, stop; 6 decimals."""
    parts = [f"{block.source.line}:N{block.source.block_number}"]
    parts += [format_function(function) for function in block.functions]
    if block.motion is not None:
        parts.append(_motion(block.motion))
    if block.stop:
        parts.append(block.stop)
    if block.offsets is not None and len(parts) == 1:
        parts.append(f"offsets {_numbers(block.offsets.shift)}")
    return " | ".join(parts)


def format_function(function: Function) -> str:
    """A function as in `format_block`."""
    match function:
        case AuxiliaryFunction(letter, code, ""):
            return f"{letter}{code}" + (f"={number(function.value)}" if function.value else "")
        case AuxiliaryFunction(letter, code, spindle):
            return f"{spindle}[{letter}{code}]"
        case SpindleCommand(spindle, command):
            return f"{spindle}[{command}]"
        case GearChange(spindle, stage):
            return f"{spindle}[gear {stage}]"
        case CuttingSpeed(spindle, speed, most, axis):
            limit = f" to {number(most)} rpm" if most else ""
            return f"{spindle}[G96 {number(speed)} mm/s by axis {axis}{limit}]" if speed else f"{spindle}[G97]"
        case SpindleLink(slave, master, on, num, den):
            ratio = "" if num == den else f" {number(num)}/{number(den)}"
            return f"{'link' if on else 'unlink'} {slave}={master}{ratio}"
        case SpindleAxis(spindle, on):
            return f"{spindle}[{'axis of the path' if on else 'spindle'}]"
        case KinematicsChange(kinematics):
            return "positions of the axes" if kinematics is None else f"positions of {kinematics.name}"
        case ExplicitSynchronisation():
            return "wait for MVS_SLP"
        case WaitForPath():
            return "wait for the path"
        case Timer(action, timer):
            return f"timer {timer} {action}"
        case Message(text):
            return f"message {text!r}"
        case OrderedError(code, severe, text):
            return f"{'error' if severe else 'warning'} {code} {text!r}"
        case LanguageWarning(code, text):
            return f"warning {code} {text!r}"
        case AxisFeedforward() | SpindleFeedforward() | CompensationSwitch() | MachineData():
            return _control(function)
        case SpindleFunction():
            return f"{function.spindle}[{' '.join(_spindle_words(function))}]"


def _spindle_words(function: SpindleFunction) -> list[str]:
    words = ["G167"] if function.full_override else []
    if function.m is not None:
        words.append(f"M{function.m}")
    if function.speed_rpm is not None:
        words.append(f"REV{number(function.speed_rpm)}")
    if function.position_deg is not None:
        words.append(f"POS{number(function.position_deg)}")
    return words + ([function.direction] if function.direction else [])


def _control(function: ControlFunction) -> str:
    if isinstance(function, CompensationSwitch):
        return f"{function.axis}[COMP {'ON' if function.on else 'OFF'} {' '.join(function.kinds)}]"
    if isinstance(function, MachineData):
        return f"{function.axis}[{function.parameter}={number(function.value)}]"
    selection = [] if function.on is None else ["G135" if function.on else "G137"]
    if isinstance(function, SpindleFeedforward):
        weight = [] if function.weight is None else [f"G136={number(function.weight)}"]
        return f"{function.spindle}[{' '.join(selection + weight)}]"
    weights = [f"{axis}{'=' if len(axis) > 1 else ''}{number(value)}" for axis, value in function.weights]
    return " ".join(selection + (["G136", *weights] if weights else []))


def _motion(motion: Motion) -> str:
    if isinstance(motion, Dwell):
        return f"dwell {number(motion.seconds)} s"
    if isinstance(motion, HomeAxes):
        return "home " + ", then ".join(" ".join(group) for group in motion.groups)
    target, slope = _numbers(motion.target), f" slope {motion.slope}" if motion.slope else ""
    slope += " G166" if motion.full_override else ""
    if motion.per_turn is not None:
        slope = f", {number(motion.per_turn.feed)} mm per turn of {motion.per_turn.spindle}{slope}"
    slope += _transition(motion.transition)
    if isinstance(motion, LinearMove) and motion.thread is not None:
        return f"thread {target} {_thread(motion.thread)}"
    slope += "" if motion.kinematics is None else f" {motion.kinematics.name}"
    if isinstance(motion, LinearMove):
        kind = "measure" if motion.measures else "line"
        if motion.tap is not None:
            slope = f" {motion.tap.spindle} {number(motion.tap.degrees_per_mm)} deg/mm{slope}"
        return (f"rapid {target}" if motion.rapid else f"{kind} {target} feed {number(motion.feed)}") + slope
    plane = f"{motion.plane[0]}{motion.plane[1]}"
    if motion.directions is not None:
        plane += f" along {_numbers(motion.directions[0])} {_numbers(motion.directions[1])}"
    return (
        f"arc {target} plane {plane} center {_numbers(motion.center)} radius {number(motion.radius)}"
        f" sweep {number(motion.sweep)} feed {number(motion.feed)}{slope}"
    )


def _thread(thread: Thread) -> str:
    turns, offset = number(thread.angle / 360.0), f" offset {number(thread.offset)}" if thread.offset else ""
    change = f" change {number(thread.change)}" if thread.change else ""
    retract = "" if thread.retract is None else f" retract {number(thread.retract[1])} by axis {thread.retract[0]}"
    return f"spindle {thread.spindle} turns {turns} lead {number(thread.lead)}{change}{offset}{retract}"


def _numbers(values: tuple[float, ...]) -> str:
    return "(" + ", ".join(number(value) for value in values) + ")"


def _transition(transition: Transition) -> str:
    """Empty where the path continues."""
    text = " exact stop" if transition.exact else ""
    if transition.contour is not None:
        contour = transition.contour
        values = [contour.path_dev] if contour.mode == DEV else [contour.pre_dist, contour.post_dist]
        text = f" {contour.mode} {_numbers(tuple(values))}"
        text += f" by {_numbers(contour.point)}" if contour.mode == POS else ""
        text += "".join([f" {name} {number(value)}" for name, value in (("track", contour.track_dev),) if value])
    if transition.smoothing is not None:
        text += f" HSC {number(transition.smoothing.path_dev)}"
    return text
