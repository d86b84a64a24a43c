"""Torque over velocity: phases of constant velocity against the friction curve of the simulated plant.

Source: TF5200 friction, figures 1 and 2. Left near standstill, right as far as the phases go.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.commissioning.friction import FrictionPoint, friction_curve
from cnc_ptp.commissioning.timing import always
from cnc_ptp.commissioning.trace import AxisTrace
from cnc_ptp.errors import CncError
from cnc_ptp.parameters.view.control_view import PlantParameters
from cnc_ptp.plots.colours import BLUE, FAINT, INK, RED
from cnc_ptp.plots.sheet import HEADER, LEFT, PLOT, Name, Sheet, draw_header, note, style_plot
from figures.run import Column, FigureRun
from figures.scenario_head import FigureError, FigureScenario

HEIGHT, BETWEEN = 260.0, 56.0
WIDE = 0.5 * (PLOT - BETWEEN)
SETTLING = 0.4
"""Seconds after which a phase counts: eight time constants 1/Kv of 50 1/s and more."""
NEAR = 6.0
"""Stribeck velocities that the left plot shows."""


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with one axis on a cascaded plant. Raises FigureError."""
    axis = figure.axes[0]
    plant = run.machine.axes[axis].control.plant
    if not plant.cascaded:
        raise FigureError(figure.path, f"axis '{axis}' has no friction (simulation.model CASCADED, P-SIM-00006)")
    points = measured(figure, run, axis)
    far = 1.1 * max(point.speed for point in points)
    near = min(NEAR * plant.stribeck_velocity, far)
    highest = 1.15 * max(plant.static, float(friction(plant, np.array([far]))[0]))
    sheet = Sheet(figure, HEADER + HEIGHT)
    for number, reach in enumerate((near, far)):
        left = LEFT + number * (WIDE + BETWEEN)
        plot = sheet.plot(sheet.upper + HEADER, HEIGHT, left=left, width=WIDE)
        draw_curve(plot, plant, reach, points)
        unit = run.units[axis]
        names = [Name("plant", BLUE.set), Name("recording", RED.set)] if number else []
        draw_header(plot, f"torque in {unit.torque}" if not number else "", names)
        sheet.write(left + 0.5 * WIDE, sheet.height - 17.0, f"velocity in {unit.length}/s", ha="center")
        plot.set_ylim(-highest, highest)
        if number:
            label_viscous(plot, plant, reach, f"{unit.length}/s")
        else:
            label_parts(plot, plant)
    return sheet.drawing


def measured(figure: FigureScenario, run: FigureRun, axis: str) -> tuple[FrictionPoint, ...]:
    """The result of the commissioning analysis for the run."""
    rows = {**run.columns[axis], "cycle": np.arange(run.cycles)}
    try:
        return friction_curve(AxisTrace.of_rows(axis, run.cycle_time, rows), settling=always(SETTLING)).points
    except CncError as error:
        raise FigureError(figure.path, error) from None


def friction(plant: PlantParameters, speed: Column) -> Column:
    """Torque against a motion at `speed` > 0: C + (S - C) · exp(-(v/vs)²) + viscous · v."""
    stribeck = (plant.static - plant.coulomb) * np.exp(-((speed / plant.stribeck_velocity) ** 2))
    total: Column = plant.coulomb + stribeck + plant.viscous * speed
    return total


def draw_curve(plot: Axes, plant: PlantParameters, reach: float, points: tuple[FrictionPoint, ...]) -> None:
    """The plant's curve with its parts, and the phases of the recording up to `reach`."""
    speed = np.linspace(0.0, reach, 400)
    both = np.concatenate([-speed[::-1], speed])
    parts: dict[str, Any] = {"color": FAINT, "linewidth": 1.2, "dashes": (5, 3), "zorder": 1.0}
    for sign in (-1.0, 1.0):
        plot.plot(sign * speed, sign * np.full_like(speed, plant.coulomb), **parts)
    plot.plot(both, plant.viscous * both, **parts)
    plot.plot(both, np.sign(both) * friction(plant, np.abs(both)), color=BLUE.set, linewidth=1.6)
    shown = [point for point in points if point.speed <= reach]
    at = [sign * point.speed for point in shown for sign in (1.0, -1.0)]
    torques = [torque for point in shown for torque in (point.positive, point.negative)]
    plot.plot(at, torques, linestyle="none", marker="o", markersize=4.5, markeredgewidth=0.0, color=RED.set)
    style_plot(plot)
    plot.axvline(0.0, color=FAINT, linewidth=0.8, zorder=0.5)
    plot.set_xlim(-reach, reach)
    plot.tick_params(labelbottom=True)


def label_parts(plot: Axes, plant: PlantParameters) -> None:
    """The parts of the curve where they can be seen: near standstill."""
    note(plot, f"static {plant.static:g}", (0.0, plant.static), (-5.0, -3.0), ha="right")
    note(plot, f"Coulomb {plant.coulomb:g}", (0.0, plant.coulomb), (-5.0, -3.0), ha="right")
    stribeck = plant.stribeck_velocity
    at = (stribeck, float(friction(plant, np.array([stribeck]))[0]))
    note(plot, "Stribeck", at, (10.0, 4.0), color=INK)


def label_viscous(plot: Axes, plant: PlantParameters, reach: float, unit: str) -> None:
    """The viscous part is seen at high velocity only."""
    words = f"viscous {1000.0 * plant.viscous:g} at 1000 {unit}"
    note(plot, words, (reach, plant.viscous * reach), (-4.0, 7.0), ha="right")
