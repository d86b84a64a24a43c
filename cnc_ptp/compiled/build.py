"""Compiles the kernel: `python -m cnc_ptp.compiled.build`. mypyc translates it to C; only what changed is compiled."""

from __future__ import annotations

import json
import os
import shutil
import sys
from pathlib import Path

from mypyc.build import mypycify
from pybind11.setup_helpers import ParallelCompile
from setuptools import Distribution, Extension
from setuptools.command.build_ext import build_ext

from cnc_ptp.compiled.sources import LIBRARY, NAME, PACKAGE, hashes, library_state, sources

OPTIMISATION = "1"


def build(work: Path) -> None:
    """Makes the library out of the sources; `work` keeps C sources and objects for the next time."""
    files = sources()
    state = hashes(files)
    library_state().unlink(missing_ok=True)
    os.chdir(PACKAGE.parent)  # tracebacks name files as they are given here
    extension = translate([str(file.relative_to(PACKAGE.parent)) for file in files.values()], work)
    library = compile_library(extension, work)
    LIBRARY.mkdir(exist_ok=True)
    shutil.copy2(library, LIBRARY / library.name)
    library_state().write_text(json.dumps(state, indent=1))


def translate(files: list[str], work: Path) -> Extension:
    """The extension of mypyc's C sources; the shims, one for each module, are not needed."""
    options = ["--config-file=pyproject.toml"]
    (extension, *_shims) = mypycify(
        [*options, *files],
        opt_level=OPTIMISATION,
        debug_level="0",
        multi_file=True,
        target_dir=str(work),
        group_name=NAME.removesuffix("__mypyc"),
    )
    extension.extra_compile_args = [flag for flag in extension.extra_compile_args if flag != "-Werror"]
    return extension


def compile_library(extension: Extension, work: Path) -> Path:
    newest_header = max(file.stat().st_mtime for file in work.rglob("*.h"))

    def outdated(target: str, source: str) -> bool:
        return os.stat(target).st_mtime < max(os.stat(source).st_mtime, newest_header)

    command = build_ext(Distribution({"name": NAME, "ext_modules": [extension]}))
    command.build_lib, command.build_temp = str(work / "lib"), str(work / "objects")
    command.ensure_finalized()
    with ParallelCompile(needs_recompile=outdated):
        command.run()
    return Path(command.get_ext_fullpath(extension.name))


if __name__ == "__main__":
    build(PACKAGE.parent / "build" / f"kernel-{sys.implementation.cache_tag}")
