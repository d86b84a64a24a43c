"""Stability limit of a position loop, from the parameters of its drive.

A sampled loop is z[k+1] = A z[k] + B u[k] with the actual position as z[0] and u[k] = -Kv z[0], held for a cycle.
It is stable while all poles, the eigenvalues of A - Kv B (1 0 … 0), lie inside the unit circle. For a first-order drive
A and B are its exact solution over a cycle, for a cascaded one that of plant_model.py without friction; each cycle on
the bus is one more state. With T the cycle time and n cycles on the bus, a drive without lag has the limit
Kv T = 2 sin(π / (4 n + 2)); the others are found by bisection.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cnc_ptp.parameters.view.control_view import ControlParameters, PlantParameters
from cnc_ptp.parameters.view.matrix_exponential import exponential
from cnc_ptp.parameters.view.plant_model import I, M, Matrix, U, V, W, X, velocity_controlled

BISECTIONS = 40


class Loop(NamedTuple):
    """A and B."""

    step: Matrix
    held: Matrix

    def is_stable(self, kv: float) -> bool:
        """All poles inside the unit circle with the gain `kv`, 1/s."""
        closed = self.step.copy()
        closed[:, 0] -= kv * self.held
        return float(np.max(np.abs(np.linalg.eigvals(closed)))) < 1.0

    def limit(self, cycle_time: float) -> float:
        """The Kv in 1/s at which a pole reaches the unit circle."""
        low, high = 0.0, 4.0 / cycle_time
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.is_stable(middle) else (low, middle)
        return low


def stability_limit(plant: PlantParameters, cycle_time: float) -> float:
    """The limit of Kv in 1/s where the NC commands the velocity of `plant`; `cycle_time` in s."""
    return delayed(velocity_loop(plant, cycle_time), plant.bus_delay_cycles).limit(cycle_time)


def position_loop(control: ControlParameters, cycle_time: float) -> Loop:
    """The loop that the gain of the position controller closes, in the NC or in the drive."""
    plant = control.plant
    if control.drive.interface == "position":
        return velocity_loop(plant, cycle_time)
    if control.drive.interface == "torque":
        return torque_loop(control, cycle_time)
    return delayed(velocity_loop(plant, cycle_time), plant.bus_delay_cycles)


def velocity_loop(plant: PlantParameters, cycle_time: float) -> Loop:
    """The drive that takes velocities."""
    if plant.cascaded:
        return part(velocity_controlled(plant, gain=plant.velocity_gain) * cycle_time, (X, W, I, M, V), U)
    decay = math.exp(-cycle_time / plant.time_constant) if plant.time_constant > 0.0 else 0.0
    lag = plant.time_constant * (1.0 - decay)
    return Loop(np.array([[1.0, lag], [0.0, decay]]), np.array([cycle_time - lag, 1.0 - decay]))


def torque_loop(control: ControlParameters, cycle_time: float) -> Loop:
    """Mechanics that take torques, with the velocity controller of the NC around them.

    In accelerations: a = Kp (e + z'), z' = z + e T/Tn once per cycle, e = u - v. Without an integral part (Tn = 0)
    there is no z; if the telegram has no actual velocity, v is the distance of the last cycle divided by T, and the
    previous position is a state.
    """
    plant, drive = control.plant, control.drive
    mechanics = part(velocity_controlled(plant, gain=0.0) * cycle_time, (X, V, M), I)
    gain = drive.velocity_gain * control.scaling.torque_per_acceleration / plant.torque_per_acceleration
    share = cycle_time / drive.velocity_integral_time if drive.velocity_integral_time else 0.0
    inner = delayed(mechanics, plant.bus_delay_cycles)
    velocity = np.eye(len(inner.held))[1]
    if not (drive.ideal or "velocity" in drive.feedback):
        inner = with_previous_position(inner)
        velocity = np.zeros(len(inner.held))
        velocity[[0, -1]] = 1.0 / cycle_time, -1.0 / cycle_time
    held = gain * (1.0 + share) * inner.held
    step = inner.step - np.outer(held, velocity)
    if share == 0.0:
        return Loop(step, held)
    integral = np.append(-share * velocity, 1.0)
    return Loop(np.vstack((np.column_stack((step, gain * inner.held)), integral)), np.append(held, share))


def with_previous_position(loop: Loop) -> Loop:
    """The same with the position of the previous cycle as the last state."""
    states = len(loop.held)
    step = np.zeros((states + 1, states + 1))
    step[:states, :states] = loop.step
    step[states, 0] = 1.0
    return Loop(step, np.append(loop.held, 0.0))


def part(matrix: Matrix, states: tuple[int, ...], command: int) -> Loop:
    """The rows and columns of some states of a model over a cycle, without states that never change."""
    step = exponential(matrix)
    changing = [state for state in states if matrix[state].any()]
    return Loop(step[np.ix_(changing, changing)], step[changing, command])


def delayed(loop: Loop, cycles: int) -> Loop:
    """The same behind a bus that takes `cycles` cycles."""
    if cycles == 0:
        return loop
    states = len(loop.held)
    step, held = np.zeros((states + cycles, states + cycles)), np.zeros(states + cycles)
    step[:states, :states] = loop.step
    step[:states, states] = loop.held
    for index in range(states, states + cycles - 1):
        step[index, index + 1] = 1.0
    held[-1] = 1.0
    return Loop(step, held)
