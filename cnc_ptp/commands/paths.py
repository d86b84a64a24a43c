"""The files of a run: a recording must not overwrite what the run is made of."""

from __future__ import annotations

from pathlib import Path

from cnc_ptp.errors import CncError

OVERWRITES = 26117


def keep_inputs(record: str | None, **inputs: str | None) -> None:
    """Raises CncError 26117 when `record` is one of the inputs, each given by what it is: machine_file="…"."""
    if record is None or not Path(record).exists():
        return
    for what, path in inputs.items():
        if path is not None and Path(path).exists() and Path(record).samefile(path):
            name = what.replace("_", " ")
            raise CncError(OVERWRITES, f"recording {record} would overwrite the {name} {path}", "nothing was started")
