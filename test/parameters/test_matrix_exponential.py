"""The matrix exponential of drives against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from long_support import long
from scipy.linalg import expm

from cnc_ptp.parameters.view.matrix_exponential import exponential


@pytest.mark.parametrize("seed", [*range(5), *long(range(5, 20))])
def test_random_matrices(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(20):
        size = int(rng.integers(1, 9))
        matrix = rng.normal(size=(size, size)) * 10.0 ** rng.uniform(-4.0, 1.3)
        matrix -= np.eye(size) * np.abs(matrix).sum(axis=0).max() * rng.uniform()
        expected = expm(matrix)
        assert exponential(matrix) == pytest.approx(expected, rel=0.0, abs=1e-11 * np.abs(expected).max())


def test_nothing_happens_in_no_time() -> None:
    assert (exponential(np.zeros((7, 7))) == np.eye(7)).all()


def test_chain_of_integrators_is_exact() -> None:
    t = 0.001
    chain = np.diag([t, t], 1)
    expected = np.eye(3) + chain + 0.5 * chain @ chain
    assert exponential(chain) == pytest.approx(expected, rel=1e-15, abs=0.0)
