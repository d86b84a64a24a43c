"""States of a spindle over time: its speed, and its state in the state graph.

Source: TF5200 spindle, figures 9 and 10.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.plots.colours import BAND, FAINT, GREEN, PURPLE
from cnc_ptp.plots.over_time import LABEL_LINE, draw_commands
from cnc_ptp.plots.sheet import GAP, HEADER, SMALL, Sheet, draw_header, note, style_plot
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name
from figures.picture import draw_panel, label_rows, shown_cycles
from figures.run import Column, FigureRun
from figures.scenario_head import FigureScenario

SPEED, STATE = 150.0, 18.0
"""Heights in points: of the speed, of each state."""
ROWS = (S.HOMING, S.DISCRETE_MOTION, S.CONTINUOUS_MOTION, S.STOPPING, S.STANDSTILL, S.ERROR_STOP)
"""From top to bottom."""


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with one spindle."""
    name = figure.axes[0]
    end = shown_cycles(run)
    labels = label_rows(run, end)
    above = LABEL_LINE * (1 + max((label.row for label in labels), default=0))
    rows = [state for state in ROWS if (run.column(name, "state")[:end] == state).any()]
    sheet = Sheet(figure, above + 2.0 * (HEADER + GAP) + SPEED + STATE * len(rows))
    speed = sheet.plot(sheet.upper + HEADER + above, SPEED)
    draw_panel(speed, "speed", run, end, room_above=above)
    draw_limit(speed, run.machine.spindles[name].gears[1].control_limit / 6.0)
    state = sheet.plot(sheet.upper + 2.0 * HEADER + above + SPEED + GAP, STATE * len(rows))
    draw_states(state, run, name, end, [int(row) for row in rows])
    for number, plot in enumerate((speed, state)):
        draw_commands(plot, labels, with_texts=number == 0)
    state.tick_params(labelbottom=True)
    sheet.write_below("time in s")
    return sheet.drawing


def draw_limit(plot: Axes, limit: float) -> None:
    """The control limit, in both directions, where there is one (rpm)."""
    low, high = plot.get_ylim()
    for level in (-limit, limit):
        if low < level < high:
            plot.axhline(level, color=PURPLE.actual, linewidth=1.0, dashes=(5, 3))
            note(plot, "control limit", (0.0, level), (4.0, 3.0), of=("axes fraction", "data"), color=PURPLE.set)


def draw_states(plot: Axes, run: FigureRun, name: str, end: int, rows: list[int]) -> None:
    """A row for each state with a bar where the spindle is in it; tinted without reference point."""
    time, state = run.time[:end], run.column(name, "state")[:end]
    style_plot(plot)
    for row, code in enumerate(reversed(rows)):
        for begin, last in stretches(state == code):
            plot.hlines(row, time[begin], time[last], color=GREEN.set, linewidth=6.0)
    for before, after, cycle in changes(state):
        places = [len(rows) - 1 - rows.index(code) for code in (before, after)]
        plot.vlines(time[cycle], min(places), max(places), color=GREEN.actual, linewidth=1.4)
    for begin, last in stretches(run.column(name, "referenced")[:end] == 0.0):
        plot.axvspan(time[begin], time[last], color=BAND, zorder=0.2, linewidth=0.0)
        note(plot, "no reference", (time[begin], len(rows) - 0.5), (3.0, 1.0), color=FAINT)
    plot.set_yticks(range(len(rows)), [state_name(S(code)) for code in reversed(rows)], fontsize=SMALL * 0.8)
    plot.tick_params(axis="y", pad=2)
    plot.set_ylim(-0.5, len(rows) + 0.2)
    plot.set_xlim(time[0], time[-1])
    draw_header(plot, "state", [])


def stretches(holds: Column) -> list[tuple[int, int]]:
    """First and last index of each stretch in which something holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(holds, dtype=int), [0]])))
    return [(int(begin), int(end) - 1) for begin, end in edges.reshape(-1, 2)]


def changes(state: Column) -> list[tuple[int, int, int]]:
    """State before, state after, cycle of each change."""
    cycles = np.flatnonzero(np.diff(state)) + 1
    return [(int(state[cycle - 1]), int(state[cycle]), int(cycle)) for cycle in cycles]
