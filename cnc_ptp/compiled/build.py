"""Compiles the kernel: `python -m cnc_ptp.compiled.build [FOLDER]`. Only what has changed is compiled again.

mypyc translates the sources to C. Without a C compiler, or when anything else fails, the reason is kept in place of the
library, and the kernel runs interpreted.
"""

from __future__ import annotations

import fcntl
import io
import os
import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING

from cnc_ptp.compiled.sources import (
    FAILURE,
    LIBRARY,
    NAME,
    PACKAGE,
    hashes,
    library_file,
    read_state,
    recipe,
    sources,
    write_state,
)

if TYPE_CHECKING:
    from setuptools import Extension

OPTIMISATION = "1"
"""Level of the C compiler. Others were not measured."""


def build(folder: Path) -> str:
    """Makes the library in `folder`. Returns why it could not be made, empty when it was."""
    work = PACKAGE.parent / "build" / f"kernel-{sys.implementation.cache_tag}"
    with alone(work):
        return build_alone(folder, work)


@contextmanager
def alone(work: Path) -> Iterator[None]:
    """Another build with the same C sources ends first."""
    work.mkdir(parents=True, exist_ok=True)
    with (work / "lock").open("w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print("Another compilation of the kernel is under way; waiting for its end ...", file=sys.stderr)
            fcntl.flock(file, fcntl.LOCK_EX)
        yield


def build_alone(folder: Path, work: Path) -> str:
    files = sources()
    state = hashes(files | recipe())
    if read_state(folder) == state and library_file(folder).is_file():
        return ""
    print(f"Compiling the kernel, {len(files)} sources (three to six minutes on two cores) ...", file=sys.stderr)
    write_state(folder, {FAILURE: "it is being compiled, or its compilation was interrupted", **state})
    failure = ""
    try:
        make_library([file.relative_to(PACKAGE.parent) for file in files.values()], work, folder)
    except ImportError as error:
        failure = f"it cannot be compiled without {error.name}"
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        failure = f"it could not be compiled: {reason}; build/kernel.log has more"
    write_state(folder, {FAILURE: failure, **state} if failure else state)
    return failure


def make_library(files: list[Path], work: Path, folder: Path) -> None:
    """`work` keeps C sources and objects for the next time."""
    os.chdir(PACKAGE.parent)  # tracebacks name files as they are given here
    library = compile_library(translate(files, work), work)
    folder.mkdir(parents=True, exist_ok=True)
    beside = folder / f"{os.getpid()}.new"
    shutil.copy2(library, beside)
    os.replace(beside, library_file(folder))  # a node that runs keeps the library that it has


def translate(files: list[Path], work: Path) -> Extension:
    """The extension of mypyc's C sources; its shims, one for each module, are not needed.

    Raises SyntaxError with the first message about a source that mypyc refuses; all are printed.
    """
    from mypyc.build import mypycify

    said = io.StringIO()
    try:
        with redirect_stdout(said):
            (extension, *_shims) = mypycify(
                ["--config-file=pyproject.toml", *map(str, files)],
                opt_level=OPTIMISATION,
                debug_level="0",
                multi_file=True,
                target_dir=str(work),
                group_name=NAME.removesuffix("__mypyc"),
            )
    except SystemExit as error:
        errors = [line for line in said.getvalue().splitlines() if ": error:" in line]
        raise SyntaxError(errors[0] if errors else f"mypyc ended with {error}") from None
    finally:
        print(said.getvalue(), end="")
    extension.extra_compile_args = [flag for flag in extension.extra_compile_args if flag != "-Werror"]
    extension.extra_compile_args.append("-ffp-contract=off")  # the same bits as Python on every processor
    return extension


def compile_library(extension: Extension, work: Path) -> Path:
    from setuptools import Distribution
    from setuptools.command.build_ext import build_ext

    newest_header = max(file.stat().st_mtime for file in work.rglob("*.h"))

    def outdated(target: str, source: str) -> bool:
        return os.stat(target).st_mtime < max(os.stat(source).st_mtime, newest_header)

    command = build_ext(Distribution({"name": NAME, "ext_modules": [extension]}))
    command.build_lib, command.build_temp = str(work / "lib"), str(work / "objects")
    command.ensure_finalized()
    with in_parallel(outdated):
        command.run()
    return Path(command.get_ext_fullpath(extension.name))


def in_parallel(outdated: Callable[[str, str], bool]) -> AbstractContextManager[object]:
    """Compiles several files at a time, of those that have changed; without pybind11 all of them one by one."""
    try:
        from pybind11.setup_helpers import ParallelCompile
    except ModuleNotFoundError:
        return nullcontext()
    parallel: AbstractContextManager[object] = ParallelCompile(needs_recompile=outdated)
    return parallel


if __name__ == "__main__":
    because = build(Path(sys.argv[1]).absolute() if len(sys.argv) > 1 else LIBRARY)
    if because:
        print(f"The kernel runs interpreted, which takes several times as long: {because}", file=sys.stderr)
    sys.exit(1 if because else 0)
