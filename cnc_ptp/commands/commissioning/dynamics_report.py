"""Output of `cnc_ptp identify dynamics`: the results, and the lines of the machine file with their reasons."""

from __future__ import annotations

from collections.abc import Iterator

from cnc_ptp.commands.commissioning.axis_data import AxisData
from cnc_ptp.commands.console import WarningLine
from cnc_ptp.commissioning.dynamics import DriveFit
from cnc_ptp.commissioning.excitation import highest_velocity
from cnc_ptp.commissioning.gain import GainProposal
from cnc_ptp.commissioning.inertia import InertiaFit
from cnc_ptp.commissioning.timing import DYNAMIC_STEADY
from cnc_ptp.parameters.view.control_view import ADD_ACC, torque_per_acceleration

GAIN_TOLERANCE = 0.01
ROUGH_MISFIT = 0.01
"""Misfit above which friction or limits have shaped the motion, too …"""
SLOW = 0.1
"""… and part of the velocity that the axis can reach, below which friction is likely to have."""
PER_SECOND = 100.0
"""0.01/s (P-AXIS-00099) a 1/s."""


def found_lines(data: AxisData, fit: DriveFit, gain: GainProposal, inertia: InertiaFit | None) -> Iterator[str]:
    """Results and warnings."""
    found = {
        "time constant Ta": f"{1e3 * fit.time_constant:.3f} ± {1e3 * fit.deviation:.3f} ms",
        "dead time": f"{fit.dead_cycles} cycles ({1e3 * fit.dead_time:g} ms){others(fit)}",
        "gain": f"{fit.gain:.4f} (actual velocity over command velocity)",
        "misfit": f"{100.0 * fit.misfit:.2f} % of what the velocity varies, {fit.cycles} cycles in motion",
        "inertia": "not found: no torque in the recording, too little acceleration, or friction hides it",
        "Kv limit": f"about {gain.limit:.0f} 1/s, where the loop starts to oscillate",
        "Kv proposed": f"{gain.proposed:.1f} 1/s (damping 1)",
        "Kv at most": f"{gain.fastest:.1f} 1/s (damping 0.7, 4 % overshoot)",
        "Kv now": f"{data.kv:g} 1/s (P-AXIS-00099)",
    }
    if inertia is not None:
        load, deviation = load_of(data, inertia)
        found["inertia"] = f"{load:.4g} ± {deviation:.2g} {load_unit(data)} (P-AXIS-00391)"
    yield from (f"{name:20}{value}" for name, value in found.items())
    yield from warnings(data, fit, gain)


def others(fit: DriveFit) -> str:
    """Dead times that explain the recording nearly as well: only their sum with Ta is certain."""
    dead = [cycles for _, cycles in fit.alternatives]
    if len(dead) < 2:
        return ""
    return f"; {min(dead)} to {max(dead)} fit nearly as well, certain is the sum with Ta"


def rough(data: AxisData, fit: DriveFit) -> str | None:
    """Why the results are rough; None if they are not."""
    reasons, reachable = [], highest_velocity(data.room, DYNAMIC_STEADY)
    if fit.misfit > ROUGH_MISFIT:
        reasons.append(
            f"misfit {100.0 * fit.misfit:.2f} % (above {100.0 * ROUGH_MISFIT:g} %: friction or limits shape the motion "
            "besides the drive)"
        )
    if fit.speed < SLOW * reachable:
        reasons.append(
            f"highest velocity {fit.speed:.3g} {data.unit}/s (below {100.0 * SLOW:g} % of the {reachable:.4g} "
            f"{data.unit}/s that the axis can reach)"
        )
    if not reasons:
        return None
    return f"axis {data.axis.name}: rough results: {', '.join(reasons)}; check them with a faster recording"


def warnings(data: AxisData, fit: DriveFit, gain: GainProposal) -> Iterator[str]:
    """Warnings about the present machine file."""
    head, kv, reason = f"axis {data.axis.name}:", data.kv, rough(data, fit)
    if reason is not None:
        yield WarningLine(reason)
    if abs(fit.gain - 1.0) > GAIN_TOLERANCE:
        yield WarningLine(
            f"{head} the drive moves {100.0 * (fit.gain - 1.0):+.1f} % off its command; check the scaling of the "
            "velocity (P-AXIS-00205, P-AXIS-00206, P-AXIS-00128, P-AXIS-00129)"
        )
    if kv >= gain.limit:
        yield WarningLine(
            f"{head} Kv {kv:g} 1/s is not below the limit of about {gain.limit:.0f} 1/s; the axis oscillates"
        )
    elif kv > gain.fastest:
        yield WarningLine(f"{head} Kv {kv:g} 1/s is above {gain.fastest:.1f} 1/s; the axis overshoots")


def load_of(data: AxisData, inertia: InertiaFit) -> tuple[float, float]:
    """Inertia at the motor shaft in kg·m² (mass in kg on a linear axis without feed constant) and its deviation."""
    unit = torque_per_acceleration(data.raw, data.gear, 1.0)
    return inertia.torque_per_acceleration / unit, inertia.deviation / unit


def load_unit(data: AxisData) -> str:
    return "kg·m²" if data.effort == "Nm" else "kg"


def dynamics_yaml(data: AxisData, fit: DriveFit, gain: GainProposal, inertia: InertiaFit | None, source: str) -> str:
    """The lines to paste into the machine file, each with its reason."""
    reason = rough(data, fit)
    lines = [
        f"# Drive of axis {data.axis.name}, {source}:",
        f"# Ta {1e3 * fit.time_constant:.3f} ± {1e3 * fit.deviation:.3f} ms, dead time {fit.dead_cycles} cycles, gain "
        f"{fit.gain:.4f}, misfit {100.0 * fit.misfit:.2f} %.",
        *([f"# warning: {reason}"] if reason is not None else []),
        f"/{data.axis.name}:",
        "  ros__parameters:",
        "    getriebe:",
        f'      "{data.gear}":',
        f"        kv: {round(PER_SECOND * gain.proposed)}  # 0.01/s: 1/(4 x {1e3 * gain.total:.3f} ms), damping 1; "
        f"Ta + dead time + half a cycle. Limit about {gain.limit:.0f} 1/s, before {data.kv:g} 1/s",
    ]
    if inertia is not None:
        load, deviation = load_of(data, inertia)
        lines.append(f"        load: {load:.4g}  # {load_unit(data)} ± {deviation:.2g}, from torque over acceleration")
    if data.axis.control.feedforward.mode & ADD_ACC:
        lines.append(
            "    # vorsteuer: additive torque is in use, P-AXIS-00225/00226 are a weight there and are unchanged"
        )
    else:
        lines.append(
            f"    vorsteuer: {{vs_a_faktor: {round(1e6 * fit.delay)}, vs_a_nenner: 1}}  # µs: Ta + "
            "dead time, by which the velocity lags in a ramp"
        )
    return "\n".join([*lines, ""])
