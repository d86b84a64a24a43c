"""The fastest motion along a curve with limited acceleration and jerk, found by a solver: sequential linear programs.

Unknown is y = v² at the middles of equal cells; y(u) is a parabola in each cell. The axes' limits are linear in y but
for the factor √y of the jerk, which is linearised about the last solution.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import linprog

Array = NDArray[np.float64]


class JerkOptimum:
    """One problem; `time` after `solve`, s."""

    def __init__(self, curve: CubicSpline, cells: int, feed: float, acceleration: float, jerk: float) -> None:
        self.feed, self.acceleration, self.jerk = feed, acceleration, jerk
        self.length = float(curve.x[-1])
        self.cell = self.length / cells
        knots = np.linspace(0.0, self.length, cells + 1)[1:-1]
        self.shapes = [curve.derivative(order)(knots) for order in (1, 2, 3)]
        count = cells - 2
        eye = sparse.eye(count, format="csr")
        before = sparse.vstack([sparse.csr_matrix((1, count)), eye]).tocsr()
        after = sparse.vstack([eye, sparse.csr_matrix((1, count))]).tocsr()
        scale = np.full(count + 1, 1.0 / self.cell)
        scale[0] = scale[-1] = 1.0 / (
            1.25 * self.cell
        )  # from rest: the tangent leaves y = 0 after a quarter of the cell
        self.slopes = sparse.diags(scale) @ (after - before)
        weight = np.full(count + 1, 0.5)
        weight[0] = 0.75 / 1.25
        self.squares = sparse.diags(1.0 - weight) @ before + sparse.diags(weight) @ after
        last = self.squares.tolil()
        last[-1, -1] = 0.75 / 1.25
        self.squares = last.tocsr()
        self.bends = (self.slopes[1:] - self.slopes[:-1]) / self.cell

    def time_of(self, y: Array) -> float:
        v = np.sqrt(np.maximum(self.squares @ y, 1e-9))
        return float(3.0 * self.cell * (1.0 / v[0] + 1.0 / v[-1]) + np.sum(2.0 * self.cell / (v[1:] + v[:-1])))

    def excess(self, y: Array) -> float:
        """Largest part of a limit that is taken, at the ends of the cells."""
        worst = 0.0
        for side in (0, 1):
            rows = slice(side, self.bends.shape[0] + side)
            v2, b, c = self.squares[rows] @ y, self.slopes[rows] @ y, self.bends @ y
            v = np.sqrt(np.maximum(v2, 0.0))
            for first, second, third in zip(*(shape[rows].T for shape in self.shapes), strict=True):
                a = first * b / 2.0 + second * v2
                j = v * (first * c / 2.0 + 1.5 * second * b + third * v2)
                worst = max(worst, np.abs(a).max() / self.acceleration, np.abs(j).max() / self.jerk)
        return float(worst)

    def constraints(self, y: Array) -> tuple[sparse.csr_matrix, Array]:
        rows, limits = [], []
        for side in (0, 1):
            part = slice(side, self.bends.shape[0] + side)
            squares, slopes = self.squares[part], self.slopes[part]
            v = np.sqrt(np.maximum(squares @ y, 1e-9))
            for first, second, third in zip(*(shape[part].T for shape in self.shapes), strict=True):
                a = sparse.diags(first / 2.0) @ slopes + sparse.diags(second) @ squares
                inner = sparse.diags(first / 2.0) @ self.bends + sparse.diags(1.5 * second) @ slopes
                inner = inner + sparse.diags(third) @ squares
                j = sparse.diags(v) @ inner + sparse.diags((inner @ y) / (2.0 * v)) @ squares
                rest = v * (inner @ y) - j @ y
                rows += [a, -a, j, -j]
                limits += [np.full(len(v), self.acceleration)] * 2 + [self.jerk - rest, self.jerk + rest]
        return sparse.vstack(rows).tocsr(), np.concatenate(limits)

    def solve(self, start: Array, steps: int = 60) -> float:
        """Time of the best motion found, beginning with y = `start`, which keeps the limits."""
        y, trust = start.copy(), 0.3
        edge = min(self.jerk ** (2 / 3) * (6.0 * self.cell) ** (4 / 3) / 4.0, 1.5 * self.acceleration * self.cell)
        for _ in range(steps):
            v = np.sqrt(np.maximum(self.squares @ y, 1e-9))
            gain = np.zeros(len(v))
            gain[1:] += self.cell / v[1:] ** 3
            gain[:-1] += self.cell / v[:-1] ** 3
            matrix, limits = self.constraints(y)
            high = np.minimum(y * (1.0 + trust), self.feed**2)
            for end in (0, -1):
                high[end] = min(high[end], edge * 5.0 / 3.0)
            low = np.minimum(y * (1.0 - trust), high)
            found = linprog(
                -(self.squares.T @ gain), A_ub=matrix, b_ub=limits, bounds=np.column_stack((low, high)), method="highs"
            )
            if found.status != 0 or self.merit(found.x) >= self.merit(y):
                trust *= 0.5
            else:
                done = self.merit(y) - self.merit(found.x) < 1e-5
                y = found.x
                if done:
                    break
            if trust < 1e-3:
                break
        return self.time_of(y) * max(1.0, self.excess(y)) ** 0.5

    def merit(self, y: Array) -> float:
        return self.time_of(y) * (1.0 + 2.0 * max(0.0, self.excess(y) - 1.0))
