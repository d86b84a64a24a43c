"""The table of kinds: one row for each."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from bench.fuzzing import programs, texts
from bench.fuzzing.engine import Kind, Target


def programs_of(dialect: str, _folder: Path) -> Target:
    return programs.target(dialect)


KINDS = {
    kind.name: kind
    for kind in (
        Kind("program", partial(programs_of, ""), 400),
        Kind("program-iso", partial(programs_of, "iso"), 200),
        Kind("machine", texts.machines, 100),
        Kind("offsets-tools", texts.named_files, 300),
        Kind("scenario", texts.scenarios, 300),
        Kind("lists", texts.lists, 100),
        Kind("csv", texts.csv_tables, 500),
        Kind("sweep", texts.sweeps, 300),
        Kind("sweep-journal", texts.journals, 300),
        Kind("sweep-table", texts.tables, 200),
        Kind("users", texts.users, 300),
    )
}
