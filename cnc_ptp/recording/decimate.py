"""Fewer points for a plot: the drawn line looks the same, peaks stay exact."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from tsdownsample import NaNMinMaxDownsampler

Indices = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]

POINTS = 4000
MOST_GAPS = 200


def line_points(
    cycles: npt.NDArray[np.uint64], values: npt.NDArray[Any], points: int = POINTS, *, stride: int = 1
) -> tuple[Floats, Floats]:
    """Cycle numbers and values of a line, at most about `points` of them: min-max decimation, exact where it is flat.

    Where cycles are missing the line is interrupted by a NaN; `stride`: cycles from one point to the next.
    """
    steps = np.diff(cycles.astype(np.int64))
    breaks = np.flatnonzero((steps > stride) | (steps < 1)) + 1
    if len(breaks) > MOST_GAPS:
        breaks = breaks[:0]
    parts = []
    for part in np.split(np.arange(len(cycles)), breaks):
        share = max(4, points * len(part) // max(1, len(cycles)))
        parts.append(part[_kept(values[part], share)])
    xs = [cycles[part].astype(np.float64) for part in parts]
    ys = [values[part].astype(np.float64) for part in parts]
    return _joined(xs), _joined(ys)


def _kept(values: npt.NDArray[Any], points: int) -> Indices:
    """Indices to keep: the ends of flat stretches, then the extremes of each bin."""
    if len(values) <= 2:
        return np.arange(len(values))
    changed = values[1:] != values[:-1]
    kept = np.flatnonzero(np.concatenate([[True], changed[:-1] | changed[1:], [True]]))
    if len(kept) <= points:
        return kept
    column = np.ascontiguousarray(values[kept], dtype=np.float64)
    downsampler = NaNMinMaxDownsampler()  # type: ignore[no-untyped-call]
    chosen = downsampler.downsample(column, n_out=points // 2 * 2).astype(np.int64)
    return np.unique(np.concatenate([kept[chosen], kept[[0, -1]], _long_flats(values, 2 * len(values) // points)]))


def _long_flats(values: npt.NDArray[Any], length: int) -> Indices:
    """First and last index of each stretch of more than `length` equal values: without them a flat line would slope."""
    borders = np.concatenate([[0], np.flatnonzero(values[1:] != values[:-1]) + 1, [len(values)]])
    long = np.diff(borders) > length
    return np.concatenate([borders[:-1][long], borders[1:][long] - 1])


def _joined(parts: list[Floats]) -> Floats:
    joined = [piece for part in parts for piece in (part, np.array([np.nan]))]
    return np.concatenate(joined[:-1]) if joined else np.empty(0)


def path_points(coordinates: list[npt.NDArray[Any]], points: int = 6000) -> Indices:
    """Indices along a path, evenly in distance and in change of direction: long lines take few points, corners many."""
    steps = np.diff(np.stack([np.asarray(column, dtype=np.float64) for column in coordinates]), axis=1)
    lengths = np.sqrt((steps**2).sum(axis=0))
    moving = np.flatnonzero(lengths > 0.0)
    if len(moving) == 0:
        return np.array([0], dtype=np.int64) if len(coordinates[0]) else np.empty(0, dtype=np.int64)
    directions = steps[:, moving] / lengths[moving]
    turn = np.zeros(len(lengths))
    cosine = np.clip((directions[:, 1:] * directions[:, :-1]).sum(axis=0), -1.0, 1.0)
    turn[moving[1:]] = np.arccos(cosine)
    progress = np.concatenate([[0.0], np.cumsum(lengths / lengths.sum() + turn / max(float(turn.sum()), 1e-9))])
    targets = np.linspace(0.0, progress[-1], points)
    chosen = np.searchsorted(progress, targets, side="left")
    corners = moving[1:][turn[moving[1:]] > np.radians(10.0)]
    corners = corners[: points // 2]
    return np.unique(np.concatenate([[0], np.minimum(chosen, len(lengths)), corners, [len(lengths)]])).astype(np.int64)
