"""The results of a sweep as a Parquet file: a row for each variant, what the sweep was in its metadata."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cnc_ptp.commissioning.faults import BAD_OUTPUT
from cnc_ptp.errors import CncError
from cnc_ptp.recording.overwriting import replacing, why_not_written
from cnc_ptp.sweep.faults import NO_SWEEP_TABLE, NOTHING, sweep_package
from cnc_ptp.sweep.journal import SWEEP, Description, description_of, require_same
from cnc_ptp.sweep.results import Results, Row

VARIANT, ERROR, MESSAGE = "variant", "error", "message"
KEPT = "what is finished is kept, the same command continues"


def write_table(file: Path, results: Results, description: Description) -> None:
    """Columns: variant, each parameter, each goal (null where it failed), error (0 none), message.

    The same results give the same bytes. Raises CncError 26013, 27030.
    """
    arrow, parquet = sweep_package("pyarrow"), sweep_package("pyarrow.parquet")
    rows = results.rows
    columns: dict[str, Any] = {VARIANT: arrow.array([row.number for row in rows], arrow.int64())}
    for place, name in enumerate(results.names):
        columns[name] = arrow.array(_alike([row.values[place] for row in rows]))
    for place, goal in enumerate(results.goals):
        values = [None if math.isnan(row.goals[place]) else row.goals[place] for row in rows]
        columns[goal.label] = arrow.array(values, arrow.float64())
    columns[ERROR] = arrow.array([row.error for row in rows], arrow.int64())
    columns[MESSAGE] = arrow.array([row.message for row in rows], arrow.string())
    table = arrow.table(columns).replace_schema_metadata({SWEEP: json.dumps({SWEEP: description})})
    try:
        with replacing(file) as part:
            parquet.write_table(table, part, compression="zstd")
    except OSError as error:
        raise CncError(BAD_OUTPUT, f"{file} cannot be written: {why_not_written(error)}", KEPT) from None


def _alike(values: Sequence[Any]) -> list[Any]:
    """Values of one type, which a column has: numbers, or texts."""
    if all(isinstance(value, (int, float)) for value in values):
        return [float(value) for value in values] if any(isinstance(value, float) for value in values) else [*values]
    return [*map(str, values)]


def read_table(file: Path, description: Description, goals: int) -> dict[int, Row]:
    """The rows by number of the table that this very sweep has written before.

    Raises CncError 26013, 26183 for a file that is no table of a sweep, 26182 for that of another sweep.
    """
    arrow, parquet = sweep_package("pyarrow"), sweep_package("pyarrow.parquet")
    try:
        table = parquet.read_table(file)
    except (OSError, arrow.ArrowException) as error:
        reason = f"{file} exists and cannot be read as Parquet: {str(error).splitlines()[0]}"
        raise CncError(NO_SWEEP_TABLE, reason, f"{NOTHING}, give another name") from None
    found = description_of((table.schema.metadata or {}).get(SWEEP.encode(), b"").decode(errors="replace"))
    if found is None:
        raise CncError(NO_SWEEP_TABLE, f"{file} exists and is no table of a sweep", f"{NOTHING}, give another name")
    require_same(str(file), found, description)
    try:
        rows = zip(*(column.to_pylist() for column in table.columns), strict=True)
        return {row[0]: _row(row, goals) for row in rows}
    except (ValueError, TypeError) as error:
        reason = f"{file} exists and its rows cannot be read: {error}"
        raise CncError(NO_SWEEP_TABLE, reason, f"{NOTHING}, give another name") from None


def _row(cells: Sequence[Any], goals: int) -> Row:
    number, *rest, error, message = cells
    split = len(rest) - goals
    numbers = [math.nan if cell is None else cell for cell in rest[split:]]
    return Row(number, tuple(rest[:split]), tuple(numbers), error, message)
