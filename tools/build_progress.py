"""Runs a command that compiles: `build_progress.py FOLDER COMMAND …`; a terminal shows how many files are finished."""

import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

PERIOD = 0.5
"""Seconds between two looks."""


def main(folder: str, *command: str) -> int:
    """The status of the command."""
    begun = time.time()
    console = Console(stderr=True)
    columns = (SpinnerColumn(), TextColumn("{task.completed} files compiled"), TimeElapsedColumn())
    with (
        subprocess.Popen(command) as build,
        Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress,
    ):
        task = progress.add_task("", total=None)
        while build.poll() is None:
            progress.update(task, completed=compiled(Path(folder), begun))
            with suppress(subprocess.TimeoutExpired):
                build.wait(PERIOD)
    return build.returncode


def compiled(folder: Path, begun: float) -> int:
    """Object files written since then; files that go meanwhile do not count."""
    count = 0
    for file in folder.rglob("*.o"):
        with suppress(FileNotFoundError):
            count += file.stat().st_mtime >= begun
    return count


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
