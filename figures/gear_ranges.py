"""Speed ranges of the gears, and a run through them over time: speed and gear in use.

Source: TF5200 spindle, figure 13.
"""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from cnc_ptp.nc.gears import m_of
from cnc_ptp.plots.colours import BAND, BLUE, PURPLE
from cnc_ptp.plots.over_time import LABEL_LINE, draw_commands
from cnc_ptp.plots.sheet import GAP, HEADER, SMALL, Sheet, draw_header, note, style_plot
from figures.picture import draw_panel, label_rows, shown_cycles
from figures.run import FigureRun
from figures.scenario_head import FigureError, FigureScenario
from figures.spindle_states import stretches

ROW, SPEED = 22.0, 150.0
BETWEEN = 30.0
"""Points: of each gear, of the speed, below the scale of the ranges."""
TICKS = (50, 100, 200, 500, 1000, 2000, 5000)

Range = tuple[float, float]


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with the main spindle of the first channel. Raises FigureError."""
    name = figure.axes[0]
    ranges = ranges_of(figure, run, name)
    end = shown_cycles(run)
    labels = label_rows(run, end)
    above = LABEL_LINE * (1 + max((label.row for label in labels), default=0))
    rows = ROW * len(ranges)
    sheet = Sheet(figure, 3.0 * (HEADER + GAP) + 2.0 * rows + BETWEEN + above + SPEED)
    upper = sheet.upper + HEADER
    draw_ranges(sheet.plot(upper, rows), ranges)
    upper += rows + BETWEEN + HEADER + above
    speed = sheet.plot(upper, SPEED)
    draw_panel(speed, "speed", run, end, room_above=above)
    upper += SPEED + GAP + HEADER
    gear = sheet.plot(upper, rows)
    draw_gears(gear, run, name, end, len(ranges))
    for number, plot in enumerate((speed, gear)):
        draw_commands(plot, labels, with_texts=number == 0)
    gear.tick_params(labelbottom=True)
    sheet.write_below("time in s")
    return sheet.drawing


def ranges_of(figure: FigureScenario, run: FigureRun, name: str) -> tuple[Range, ...]:
    """(lowest, highest) speed of each gear, rpm."""
    channel = next(iter(run.machine.channels.values()))
    ranges = next((spindle.ranges for spindle in channel.spindles if spindle.node == name), ())
    if not ranges:
        raise FigureError(figure.path, f"spindle '{name}' has no speed ranges (P-CHAN-00058, P-CHAN-00055)")
    return ranges


def draw_ranges(plot: Axes, ranges: tuple[Range, ...]) -> None:
    """A bar for each gear over the speed, on a logarithmic scale."""
    style_plot(plot)
    plot.set_xscale("log")
    for row, (low, high) in enumerate(ranges):
        plot.hlines(row, low, high, color=BLUE.set, linewidth=8.0)
        note(plot, f"{low:g} … {high:g}", (high, row), (7.0, -3.0))
    name_rows(plot, len(ranges))
    plot.set_xticks(TICKS, [f"{speed}" for speed in TICKS])
    plot.xaxis.set_minor_locator(NullLocator())
    plot.set_xlim(40.0, 13_000.0)
    plot.tick_params(labelbottom=True)
    draw_header(plot, "speed ranges in rpm", [])


def draw_gears(plot: Axes, run: FigureRun, name: str, end: int, count: int) -> None:
    """The gear in use over time; tinted while it is changed."""
    time, gear = run.time[:end], run.column(name, "gear")[:end]
    style_plot(plot)
    plot.step(time, gear - 1.0, where="post", color=PURPLE.set, linewidth=2.0)
    for begin, last in stretches(run.column(name, "gear_change_active")[:end] > 0.0):
        plot.axvspan(time[begin], time[last], color=BAND, zorder=0.2, linewidth=0.0)
        note(plot, "change", (time[begin], count - 1.0), (3.0, 0.0))
    name_rows(plot, count)
    plot.set_xlim(time[0], time[-1])
    draw_header(plot, "gear", [])


def name_rows(plot: Axes, count: int) -> None:
    """M40 at the bottom."""
    plot.set_yticks(range(count), [f"M{m_of(row + 1)}" for row in range(count)], fontsize=SMALL)
    plot.set_ylim(-0.6, count - 0.4)
