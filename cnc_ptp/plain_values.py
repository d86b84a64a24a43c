"""Arguments as commands, recordings and messages carry them."""

from __future__ import annotations

from typing import Any

import numpy as np

DEEPEST = 20
"""Levels of lists. No argument has more than three: what is deeper is None, and refused."""


def plain(value: Any, level: int = 0) -> Any:
    """Arrays and numbers of NumPy as those of Python."""
    if level > DEEPEST:
        return None
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return [plain(each, level + 1) for each in value] if isinstance(value, list | tuple) else value
