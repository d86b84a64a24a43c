"""Exponential of a matrix. SciPy has one too, but every process of a drive would load SciPy for it."""

from __future__ import annotations

import math

import numpy as np

from cnc_ptp.parameters.view.plant_model import Matrix

DEGREE = 8
LARGEST_NORM = 0.5
"""Up to here the approximant of that degree is exact to double precision."""
_COEFFICIENTS = [
    math.comb(DEGREE, k) * math.factorial(2 * DEGREE - k) / math.factorial(2 * DEGREE) for k in range(DEGREE + 1)
]


def exponential(matrix: Matrix) -> Matrix:
    """exp of a square matrix (n, n), by scaling, a diagonal Padé approximant and squaring.

    Source: N. J. Higham, The Scaling and Squaring Method for the Matrix Exponential Revisited, 2005.
    """
    norm = float(np.abs(matrix).sum(axis=0).max(initial=0.0))
    squarings = max(0, math.ceil(math.log2(norm / LARGEST_NORM))) if norm > 0.0 else 0
    scaled: Matrix = math.ldexp(1.0, -squarings) * matrix
    power: Matrix = np.eye(len(matrix))
    numerator: Matrix = 0.0 * power
    denominator: Matrix = 0.0 * power
    for k, coefficient in enumerate(_COEFFICIENTS):
        numerator = numerator + coefficient * power
        denominator = denominator + (-1.0) ** k * coefficient * power
        power = power @ scaled
    result: Matrix = np.asarray(np.linalg.solve(denominator, numerator), dtype=np.float64)
    for _ in range(squarings):
        result = result @ result
    return result
