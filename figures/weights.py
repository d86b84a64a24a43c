"""Friction compensation around a reversal over time: velocity, current with and without weights, and the weight.

Source: TF5200 friction, figure 5. The first reversal of the axis with compensation is shown.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.control.friction_compensation import FrictionTable
from cnc_ptp.parameters.view.control_view import FrictionParameters
from cnc_ptp.plots.colours import BAND, GREEN, PURPLE, RED
from cnc_ptp.plots.sheet import GAP, HEADER, Name, Sheet, draw_header, note, style_plot, write_value
from figures.run import Column, FigureRun
from figures.scenario_head import FigureError, FigureScenario

HEIGHT = 110.0
BEFORE, AFTER = 2.0, 1.5
"""Lengths of the weighting that are shown before and after the reversal, each at least SHORTEST cycles."""
SHORTEST = 12


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with one axis. Raises FigureError where nothing is compensated at a reversal."""
    axis = figure.axes[0]
    friction = run.machine.axes[axis].control.friction
    velocity = counted_velocity(friction, run.column(axis, "set_velocity"))
    current = run.column(axis, "friction_current")
    full = full_current(friction, velocity)
    weight = np.divide(current, full, out=np.zeros_like(full), where=full != 0.0)
    turn = first_reversal(velocity, current)
    if turn is None:
        raise FigureError(figure.path, f"axis '{axis}' never turns back with friction compensation")
    shown = window(weight, turn, friction.reversal_lookahead)
    sheet = Sheet(figure, 3 * (HEADER + HEIGHT + GAP))
    unit = run.units[axis]
    drawn = (
        (f"velocity in {unit.length}/s", [(Name("set", GREEN.set), velocity)]),
        (
            "friction current in digits",
            [(Name("of the table", RED.actual), full), (Name("weighted", RED.set), current)],
        ),
        ("weight", [(Name("", PURPLE.set), weight)]),
    )
    milliseconds = 1000.0 * (run.time - run.time[turn])
    for number, (title, lines) in enumerate(drawn):
        plot = sheet.plot(sheet.upper + HEADER + number * (HEADER + HEIGHT + GAP), HEIGHT)
        draw_panel(plot, title, milliseconds[shown], [(name, values[shown]) for name, values in lines])
        tint(plot, friction, milliseconds, turn, weight, with_texts=number == 0)
    plot.tick_params(labelbottom=True)
    sheet.write_below("time from the reversal in ms")
    return sheet.drawing


def counted_velocity(friction: FrictionParameters, velocity: Column) -> Column:
    """The velocity that the compensation works with: it looks ahead, so the position controller is behind."""
    behind = friction.reversal_lookahead + friction.delay_cycles
    return np.concatenate([np.zeros(behind), velocity[: len(velocity) - behind]])


def full_current(friction: FrictionParameters, velocity: Column) -> Column:
    """The current of the table, with the sign of the velocity."""
    table = FrictionTable(friction.velocities, friction.currents)
    return np.array([np.sign(v) * table.current(v) for v in velocity])


def first_reversal(velocity: Column, current: Column) -> int | None:
    """The first cycle with the other direction, in which something is compensated around."""
    moving = np.flatnonzero(velocity)
    turns = moving[1:][np.diff(np.sign(velocity[moving])) != 0.0]
    compensated = [int(turn) for turn in turns if current[max(0, turn - SHORTEST) : turn + SHORTEST].any()]
    return compensated[0] if compensated else None


def window(weight: Column, turn: int, lookahead: int) -> slice:
    """The cycles that are shown: where the weight is below 1, and something around it."""
    rise = built_up(weight, turn) - turn
    return slice(max(0, turn - max(SHORTEST, round(BEFORE * lookahead))), turn + max(SHORTEST, round(AFTER * rise)) + 1)


def built_up(weight: Column, turn: int) -> int:
    """The first cycle after the reversal with the full weight."""
    return turn + int(np.argmax(weight[turn:] >= 1.0 - 1e-9))


def draw_panel(plot: Axes, title: str, time: Column, lines: list[tuple[Name, Column]]) -> None:
    for number, (name, values) in enumerate(lines):
        width = 1.6 if number == len(lines) - 1 else 3.2
        plot.plot(time, values, color=name.colour, linewidth=width, drawstyle="steps-post")
    style_plot(plot)
    plot.set_xlim(time[0], time[-1])
    draw_header(plot, title, [name for name, _ in lines if name.text])
    last, name = lines[-1][1], lines[-1][0]
    for value in (float(last.max()), float(last.min())):
        write_value(plot, value, name.colour)


def tint(
    plot: Axes, friction: FrictionParameters, time: Column, turn: int, weight: Column, *, with_texts: bool
) -> None:
    """The two stretches with a weight below 1."""
    before, after = time[turn - friction.reversal_lookahead], time[built_up(weight, turn)]
    plot.axvspan(before, after, color=BAND, linewidth=0.0, zorder=0.1)
    plot.axvline(time[turn], color=PURPLE.actual, linewidth=0.9, dashes=(3, 2), zorder=0.6)
    if with_texts:
        lookahead = f"{friction.reversal_lookahead} cycles (P-COMP-00044)"
        note(plot, lookahead, (before, 1.0), (-4.0, -12.0), of=("data", "axes fraction"), ha="right")
        delay = f"{1000.0 * friction.position_delay:g} µm (P-COMP-00043)"
        note(plot, delay, (after, 1.0), (4.0, -12.0), of=("data", "axes fraction"))
