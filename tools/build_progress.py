"""Runs a command that compiles: `build_progress.py FOLDER COMMAND …`; a terminal shows how many files are finished."""

import os
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from threading import Thread

from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

PERIOD = 0.5
"""Seconds between two looks."""
COLUMNS = (SpinnerColumn(), TextColumn("{task.completed} files compiled"), TimeElapsedColumn())


def main(folder: str, *command: str) -> int:
    """The status of the command, as a shell has it."""
    console = Console(stderr=True)
    if not console.is_terminal:
        os.execvp(command[0], command)
    with (
        subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as build,
        Progress(*COLUMNS, console=console, transient=True) as progress,
    ):
        Thread(target=pass_on, args=(build, console), daemon=True).start()
        watch(build, Path(folder), progress)
    return build.returncode if build.returncode >= 0 else 128 - build.returncode


def watch(build: subprocess.Popen[str], folder: Path, progress: Progress) -> None:
    """Until its end; Ctrl-C has reached it too."""
    begun = time.time()
    task = progress.add_task("", total=None)
    while build.poll() is None:
        progress.update(task, completed=compiled(folder, begun))
        with suppress(subprocess.TimeoutExpired, KeyboardInterrupt):
            build.wait(PERIOD)
    progress.update(task, completed=compiled(folder, begun))


def pass_on(build: subprocess.Popen[str], console: Console) -> None:
    """What it says, above the line of progress."""
    assert build.stderr is not None
    for line in build.stderr:
        console.print(line, end="", markup=False, highlight=False, soft_wrap=True)


def compiled(folder: Path, begun: float) -> int:
    """Object files written since then; files that go meanwhile do not count."""
    count = 0
    for file in folder.rglob("*.o"):
        with suppress(FileNotFoundError):
            count += file.stat().st_mtime >= begun
    return count


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
