"""NumPy without threads: nodes and commands have no use for them, and they wait actively."""

from __future__ import annotations

import os

ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""Environment in which NumPy is to be imported."""


def use_one_thread() -> None:
    """For this process, before it imports NumPy, and for those that it starts; what the user has set counts."""
    for name, value in ONE_THREAD.items():
        os.environ.setdefault(name, value)
