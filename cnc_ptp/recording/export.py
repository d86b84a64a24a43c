"""A topic of a recording as a file of columns: CSV, Parquet or NumPy's .npz, piece by piece where the format permits.

The first column is `time` in s of the recording. Sequences and messages in a field are one cell of CSV, as JSON.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cnc_ptp.recording.message_fields import Column
from cnc_ptp.recording.opened import TIME, Columns, OpenRecording, joined, package

Parts = Iterator[Columns]


def export_topic(
    recording: OpenRecording,
    topic: str,
    output: Path,
    *fields: str,
    start: float | None = None,
    end: float | None = None,
) -> int:
    """Writes a topic, or some `fields` of it, to a file whose ending is one of WRITERS; returns the number of rows.

    Raises CncError 26011 and 26013 (see OpenRecording), and OSError where the file cannot be written.
    """
    names = [TIME, *(name for name in fields if name != TIME)] if fields else ()
    parts = recording.parts(topic, *names, start=start, end=end)
    return WRITERS[output.suffix.lower()](output, parts, topic)


def write_csv(output: Path, parts: Parts, _topic: str) -> int:
    count = 0
    with output.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        for columns in parts:
            if not count:
                rows.writerow(columns)
            rows.writerows(zip(*map(_cells, columns.values()), strict=True))
            count += len(columns[TIME])
    return count


def write_parquet(output: Path, parts: Parts, topic: str) -> int:
    arrow, parquet = package("pyarrow"), package("pyarrow.parquet")
    count, writer = 0, None
    try:
        for columns in parts:
            table = arrow.table({name: _arrow(arrow, column) for name, column in columns.items()})
            if writer is None:
                schema = table.schema.with_metadata({"topic": topic})
                writer = parquet.ParquetWriter(output, schema, compression="zstd")
            writer.write_table(table.cast(writer.schema))
            count += table.num_rows
    finally:
        if writer is not None:
            writer.close()
    return count


def write_npz(output: Path, parts: Parts, _topic: str) -> int:
    everything = [*parts]
    columns = {name: joined([part[name] for part in everything]) for name in everything[0]} if everything else {}
    contents: dict[str, Any] = {name: _without_objects(column) for name, column in columns.items()}
    with output.open("wb") as stream:
        np.savez_compressed(stream, allow_pickle=False, **contents)
    return len(columns.get(TIME, ()))


WRITERS: dict[str, Callable[[Path, Parts, str], int]] = {
    ".csv": write_csv,
    ".parquet": write_parquet,
    ".npz": write_npz,
}
"""By the ending of the file."""


def _cells(column: Column) -> Sequence[Any]:
    """Numbers with all their digits, texts, JSON."""
    values: list[Any] = column.tolist()
    if column.dtype == object or column.ndim > 1:
        return [value if isinstance(value, str) else json.dumps(_lists(value)) for value in values]
    return values


def _lists(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value


def _arrow(arrow: Any, column: Column) -> Any:
    """Messages in a field as JSON: their form need not be the same in every piece."""
    if column.ndim > 1 or (len(column) and isinstance(column[0], np.ndarray)):
        return arrow.array([*column], type=arrow.list_(_element(arrow, column)))
    return arrow.array(_cells(column) if column.dtype == object else column)


def _element(arrow: Any, column: Column) -> Any:
    return arrow.from_numpy_dtype(column[0].dtype)


def _without_objects(column: Column) -> Column:
    return np.array(_cells(column), dtype=np.str_) if column.dtype == object else column
