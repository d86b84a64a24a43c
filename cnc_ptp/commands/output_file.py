"""Output files of commands: they must not overwrite an input, and errors of writing are reported."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from cnc_ptp.commissioning.faults import BAD_OUTPUT
from cnc_ptp.errors import CncError
from cnc_ptp.recording.overwriting import no_folder, overwritten, replacing


def beside(file: str, suffix: str) -> str:
    """The name of an output beside `file`; of a folder without a name, as `.`, in it."""
    path = Path(file)
    return str(path.with_suffix(suffix) if path.name not in ("", "..") else path / f"output{suffix}")


def check_output(output: str | None, **inputs: str | None) -> None:
    """Raises CncError 27030 when `output` is one of the inputs, each by its kind: machine_file="…"."""
    if output is None:
        return
    if not Path(output).absolute().parent.is_dir():
        raise CncError(BAD_OUTPUT, f"{output} cannot be written: {no_folder(output)}", "nothing was started")
    if what := overwritten(output, inputs):
        raise CncError(BAD_OUTPUT, f"{output} would overwrite the {what}", "nothing was started")


def check_page(output: str, **inputs: str | None) -> None:
    """Raises CncError 27030 for a report that is no .html file or would overwrite an input: recording="…"."""
    check_output(output, **inputs)
    if Path(output).suffix.lower() != ".html":
        raise CncError(BAD_OUTPUT, f"{output}: the file name of a report must end in .html", "nothing was started")


def write_output(output: str, content: str | bytes, *, remains: str = "the result above is all") -> None:
    """Writes a file. Raises CncError 27030 with what `remains` without it."""
    data = content.encode() if isinstance(content, str) else content
    try:
        with replacing(output) as file:
            file.write_bytes(data)
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
