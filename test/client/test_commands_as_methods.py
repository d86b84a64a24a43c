"""Each command of the tables is a method of its unit, with the same arguments."""

from __future__ import annotations

import inspect
from importlib import import_module
from typing import Literal, get_args, get_origin

import pytest

from cnc_ptp.client import Answer, Axis, Channel, Job, Plc, ProgramJob, Spindle
from cnc_ptp.client.make_commands import FOLDER, WITHOUT_METHOD, files
from cnc_ptp.protocol.commands import COMMANDS, Argument
from cnc_ptp.protocol.jobs import JOBS

CLASSES = {"axis": Axis, "spindle": Spindle, "channel": Channel, "plc": Plc}
GIVEN_BY_OTHERS = {"above", "master_stands", "master_start", "master_lost", "own", "homes", "owner", "by_path"}
"""Arguments that only the PLC and channels give."""
DEFAULTS = {
    ("spindle", "start", "direction"): "cw",
    ("spindle", "select_gear", "resume"): True,
    ("axis", "couple_cam", "cyclic"): True,
}
FROM_FILES = ("table", "setpoints")
TYPES = {
    "number": "float",
    "integer": "int",
    "switch": "bool",
    "text": "str",
    "rows": "Rows",
    "files": "Mapping[str, str]",
    "source": "str",
}
ROWS = [(kind, command) for kind in COMMANDS for command in COMMANDS[kind] if command not in WITHOUT_METHOD]


def expected(argument: Argument, default: object) -> str:
    """Annotation of an argument."""
    chosen = ", ".join(map(repr, argument.choices))
    kind = f"Literal[{chosen}]" if chosen else TYPES[argument.kind]
    return f"{kind} | None" if default is None else kind


def written(annotation: str, module: str) -> str:
    """An annotation with the choices that its alias stands for."""
    name = annotation.partition(" ")[0]
    alias = getattr(import_module(module), name, None)
    choices = get_args(alias) if get_origin(alias) is Literal else ()
    return annotation.replace(name, f"Literal[{', '.join(map(repr, choices))}]") if choices else annotation


def test_there_are_methods_for_all_of_them() -> None:
    assert len(ROWS) > 65


@pytest.mark.parametrize(("kind", "command"), ROWS)
def test_arguments_and_result_are_those_of_the_table(kind: str, command: str) -> None:
    method = getattr(CLASSES[kind], command)
    signature = inspect.signature(method)
    known = {name: each for name, each in COMMANDS[kind][command].items() if name not in GIVEN_BY_OTHERS}
    assert signature.parameters.keys() == {"self", *known}
    for name, argument in known.items():
        must = argument.required and name not in FROM_FILES
        default = DEFAULTS.get((kind, command, name), inspect.Parameter.empty if must else None)
        parameter = signature.parameters[name]
        annotation = written(parameter.annotation, method.__module__)
        assert (parameter.default, annotation) == (default, expected(argument, default)), name
        assert f"\n        {name} " in method.__doc__
    result = {"Answer": Answer, "Job": Job, "ProgramJob": ProgramJob}[signature.return_annotation]
    assert issubclass(result, Job) == (command in JOBS[kind])


@pytest.mark.parametrize("name", files())
def test_the_files_are_as_they_are_made(name: str) -> None:
    """python -m cnc_ptp.client.make_commands"""
    assert (FOLDER / name).read_text(encoding="utf-8") == files()[name]
