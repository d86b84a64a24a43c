"""Output files of commands: they must not overwrite an input, and errors of writing are reported."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from rich.console import Console

from cnc_ptp.commissioning.faults import BAD_OUTPUT
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import machine_files

OVERWRITES = 26117
MACHINE_FILE = "machine_file"
"""The input whose own files must not be overwritten either."""


def check_output(output: str | None, **inputs: str | None) -> None:
    """Raises CncError 27030 when `output` is one of the inputs, each by its kind: machine_file="…"."""
    if output is None:
        return
    if not Path(output).absolute().parent.is_dir():
        raise CncError(BAD_OUTPUT, f"{output} cannot be written: its folder does not exist", "nothing was started")
    if what := _overwritten(output, inputs):
        raise CncError(BAD_OUTPUT, f"{output} would overwrite the {what}", "nothing was started")


def check_recording(record: str | None, **inputs: str | None) -> None:
    """Raises CncError 26117 when the recording of a run is one of its inputs, as check_output."""
    if record is not None and Path(record).exists() and (what := _overwritten(record, inputs)):
        raise CncError(OVERWRITES, f"recording {record} would overwrite the {what}", "nothing was started")


def _overwritten(output: str, inputs: Mapping[str, str | None]) -> str:
    """The input that is the same file as `output`, `machine file mill.yaml`; empty if none is."""
    for what, path in inputs.items():
        if path is None:
            continue
        if _same(Path(output), Path(path)):
            return f"{what.replace('_', ' ')} {path}"
        for named in machine_files(path) if what == MACHINE_FILE else ():
            if _same(Path(output), named):
                return f"file {named} of the machine file {path}"
    return ""


def _same(one: Path, other: Path) -> bool:
    """Whether both are one file, or would be: links of either kind count, and files that do not exist yet."""
    return one.resolve() == other.resolve() or (one.exists() and other.exists() and one.samefile(other))


def check_page(output: str, **inputs: str | None) -> None:
    """Raises CncError 27030 for a report that is no .html file or would overwrite an input: recording="…"."""
    check_output(output, **inputs)
    if Path(output).suffix.lower() != ".html":
        raise CncError(BAD_OUTPUT, f"{output}: the file name of a report must end in .html", "nothing was started")


def write_output(output: str, content: str | bytes, *, remains: str = "the result above is all") -> None:
    """Writes a file. Raises CncError 27030 with what `remains` without it."""
    data = content.encode() if isinstance(content, str) else content
    try:
        Path(output).write_bytes(data)
    except OSError as error:
        raise CncError(BAD_OUTPUT, f"{output} cannot be written: {error.strerror}", remains) from None


def deliver(console: Console, output: str | None, text: str) -> None:
    """Writes the lines for the machine file, or prints them."""
    if output is None:
        print()
        print(text, end="")
        return
    write_output(output, text)
    console.print(f"{output}: to be pasted into the machine file", markup=False)
