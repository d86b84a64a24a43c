"""Columns of numbers as short texts: every cycle of a run in one page.

A column is kept in whole steps of a resolution. Differences of the best order (0 to 3) are small where a motion is
smooth, so that their bytes, plane by plane, deflate to little. report.js reads it back.
"""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

STEPS = 2**22
"""Steps from the smallest to the largest value of a column: 0.1 µm of 400 mm."""
SAMPLE = 20_000
HIGHEST_ORDER = 3


def packed(values: npt.NDArray[Any]) -> dict[str, Any]:
    """`n` values as offset, step, order of differences and text; a value is offset + step · number.

    NaN and infinity are kept as the smallest number of 32 bits. Whole numbers that span less than 2³¹ stay exact.
    """
    column = values.astype(np.float64)
    finite = np.isfinite(column)
    low, high = (float(column[finite].min()), float(column[finite].max())) if finite.any() else (0.0, 0.0)
    step = _step(column[finite], high - low)
    numbers = np.zeros(len(column), dtype=np.int32)
    numbers[finite] = np.rint((column[finite] - low) / step).astype(np.int32)
    numbers[~finite] = np.iinfo(np.int32).min
    order = min(range(HIGHEST_ORDER + 1), key=lambda order: len(_deflated(numbers[:SAMPLE], order)))
    text = base64.b64encode(_deflated(numbers, order)).decode()
    return {"n": len(column), "offset": low, "step": step, "order": order, "text": text}


def _step(values: npt.NDArray[np.float64], span: float) -> float:
    if span == 0.0:
        return 1.0
    whole = span < 2**31 and bool(np.all(values == np.rint(values)))
    return 1.0 if whole else span / STEPS


def _deflated(numbers: npt.NDArray[np.int32], order: int) -> bytes:
    """Differences modulo 2³², zigzag, the lowest bytes of all of them first."""
    wrapped = numbers.view(np.uint32)
    for _ in range(order):
        wrapped = np.diff(wrapped, prepend=np.uint32(0))
    signed = wrapped.view(np.int32)
    zigzag = ((signed << 1) ^ (signed >> 31)).astype("<u4")
    planes = zigzag.view(np.uint8).reshape(-1, 4).T
    compressor = zlib.compressobj(6, zlib.DEFLATED, -15)
    return compressor.compress(np.ascontiguousarray(planes).tobytes()) + compressor.flush()
