"""Command lines: every command with random options, arguments and files, in this process.

What would start a process or wait for a machine (run, sweep, web, clients) is read only, and not carried out.
"""

from __future__ import annotations

import random
import shutil
from collections.abc import Iterator, Mapping
from contextlib import chdir
from pathlib import Path
from typing import Any, NamedTuple

import click
from click.testing import CliRunner

from bench.fuzzing.engine import Broken, Target
from bench.fuzzing.mutation import HUGE, VALUES
from bench.fuzzing.recordings import small_recording
from bench.fuzzing.texts import CAM, CURVE, SCENARIO
from bench.jobs import ROOT
from cnc_ptp import cli

READ_ONLY = {"run", "sweep", "web", "status", "do", "jog", "watch"}
LEFT_OUT = {"--publish", "--help", "--version"}
"""Options that start a node or end everything."""
STATUS = (0, 1, 2)
NUMBERS = ("0", "1", "2", "0.01", "-1", "1e-9", "100", "1e9", "nan", "inf", "1e999", "x", "", "99999999999999999999")
WORDS = (
    *("x", "y", "s", "channel", "plc", "x/set_velocity", "/x/state", "/events", "set_position", "following_error"),
    *("x.getriebe.0.kv=1000", "x.getriebe.0.kv=nan", "G1", "70349", "P-ERR-23004", "x=axis", "friction", "100:5000"),
    *("x.set_velocity != 0", "500MB", "1s", "XY", "=", ","),
)
OUTPUTS = (
    "out.html",
    "out.svg",
    "out.mcap",
    "out.csv",
    "out.parquet",
    "out.npz",
    "out.yaml",
    "out.json",
    "out.xml",
    "out",
    "parts",
    "m.yaml",
    "no/out.html",
)
FILES = (
    "m.yaml",
    "mill.yaml",
    "p.nc",
    "bad.nc",
    "s.yaml",
    "cam.csv",
    "curve.csv",
    "r.mcap",
    "cut.mcap",
    "lists",
    "empty",
    "binary",
    "none.yaml",
    ".",
)


class Known(NamedTuple):
    """A command with its words."""

    words: tuple[str, ...]
    command: click.Command
    is_read_only: bool


def known(group: click.Group, words: tuple[str, ...] = ()) -> Iterator[Known]:
    for name, command in sorted(group.commands.items()):
        if isinstance(command, click.Group):
            yield from known(command, (*words, name))
        else:
            yield Known((*words, name), command, bool(READ_ONLY & {*words, name}))


def files(folder: Path) -> None:
    """What command lines name."""
    for name in ("m.yaml", "mill.yaml"):
        text = (ROOT / "config" / "mill.yaml").read_text(encoding="utf-8")
        (folder / name).write_text(text, encoding="utf-8")
    shutil.copytree(ROOT / "config" / "tools", folder / "tools", dirs_exist_ok=True)
    shutil.copytree(ROOT / "examples" / "lists", folder / "lists", dirs_exist_ok=True)
    (folder / "p.nc").write_text("G0 X5\nG1 X6 Y1 F3000\nM30\n")
    (folder / "bad.nc").write_text("G1 X\n$IF\nM30\n")
    (folder / "s.yaml").write_text(SCENARIO.splitlines()[0])
    (folder / "cam.csv").write_text(CAM)
    (folder / "curve.csv").write_text(CURVE)
    (folder / "empty").write_text("")
    (folder / "binary").write_bytes(bytes(range(256)) * 8)
    small_recording(folder / "r.mcap")
    data = (folder / "r.mcap").read_bytes()
    (folder / "cut.mcap").write_bytes(data[: len(data) // 2])


def value_of(parameter: click.Parameter, draw: random.Random) -> str:
    """A value for an option or argument: mostly one of its type."""
    if draw.random() < 0.06:
        return draw.choice((*VALUES, "x" * HUGE, "--", "-x", "\udcff")).replace("\x00", "")
    if isinstance(parameter.type, click.Choice):
        return str(draw.choice([*parameter.type.choices]))
    if parameter.name in ("output", "record", "page", "report_file"):
        return draw.choice(OUTPUTS)
    if isinstance(parameter.type, click.Path):
        return draw.choice(FILES)
    if isinstance(parameter.type, (click.types.FloatParamType, click.types.IntParamType)):
        return draw.choice(NUMBERS)
    return draw.choice(WORDS)


def line(known: Known, draw: random.Random) -> list[str]:
    """The words of a command line."""
    words: list[str] = []
    for parameter in known.command.params:
        wanted = parameter.required or isinstance(parameter, click.Argument)
        if draw.random() > (0.93 if wanted else 0.25):
            continue
        for _ in range(draw.choice((1, 1, 1, 2)) if parameter.multiple or parameter.nargs == -1 else 1):
            if isinstance(parameter, click.Option):
                name = draw.choice([*parameter.opts, *parameter.secondary_opts])
                if name in LEFT_OUT:
                    continue
                words.append(name)
            if not getattr(parameter, "is_flag", False):
                words += [value_of(parameter, draw) for _ in range(max(1, parameter.nargs))]
    if draw.random() < 0.05:
        words.insert(
            draw.randint(0, len(words)),
            draw.choice((*VALUES, "--nothing", "--ros-args", "-r", "__ns:=/x")).replace("\x00", ""),
        )
    if known.words == ("simulate",) and "--duration" not in words:
        words += ["--duration", "0.05"]
    return words


def command_lines(folder: Path) -> Target:
    """Of all commands."""
    import matplotlib.font_manager  # noqa: F401 - it makes folders of its own for what it has found once

    files(folder)
    commands = [*known(cli.main)]
    before = contents(folder)
    short = [each for each in commands if not each.is_read_only]

    def make(draw: random.Random) -> list[str]:
        chosen = draw.choice(commands if draw.random() < 0.3 else short)
        return [*chosen.words, *line(chosen, draw)]

    def call(words: list[str]) -> None:
        with chdir(folder):
            result = carried_out(words)
        put_back(folder, before)
        if result is None:
            return
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        if result.exit_code not in STATUS or "Traceback" in result.output:
            raise Broken(f"status {result.exit_code}: {result.output[-2000:]}")
        if result.exit_code == 2:
            if not result.output.strip():
                raise Broken("wrong usage without a text")
            raise click.UsageError(result.output[:200])

    return Target(make, call)


def carried_out(words: list[str]) -> Any:
    """The result of a command; None for one that was only read."""
    reader = next(
        (each for each in known(cli.main) if each.is_read_only and words[: len(each.words)] == [*each.words]), None
    )
    if reader is None:
        return CliRunner().invoke(cli.main, words)
    settings = cli.main.context_settings  # a command keeps the names of its help option that it was first read with
    with reader.command.make_context(words[0], words[len(reader.words) :], obj=[], **settings):
        return None


def contents(folder: Path) -> dict[Path, bytes]:
    """All files in it."""
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def put_back(folder: Path, before: Mapping[Path, bytes]) -> None:
    """The folder is as it was before a command."""
    if contents(folder) == before:
        return
    for path in folder.iterdir():
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
    for path, data in before.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
