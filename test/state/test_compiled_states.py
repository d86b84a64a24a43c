"""States and the compiled kernel: what mypyc makes of a class must not stop its instances from being restored."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from machine_support import ROOT

from cnc_ptp import KERNEL
from cnc_ptp.compiled.instances import bare_instance, is_compiled
from cnc_ptp.compiled.sources import sources
from cnc_ptp.state.roots import attribute_names

EDITED = "changed since it was compiled" in KERNEL.interpreted_because
compiled_only = pytest.mark.skipif(EDITED, reason="the sources have changed since they were compiled")
"""Without a library these tests fail, as those of the kernel."""
NO_INSTANCES = "has no instances"
"""Traits and protocols: only instances of what is derived of them are in a state."""


def is_final(annotation: ast.expr | None) -> bool:
    base = annotation.value if isinstance(annotation, ast.Subscript) else annotation
    return isinstance(base, ast.Name) and base.id == "Final"


def final_attributes(source: str) -> list[str]:
    """Attributes of instances that are `Final`: declared with a value in a method, or without one in the class."""
    declared = [part for part in ast.walk(ast.parse(source)) if isinstance(part, ast.AnnAssign)]
    finals = [part for part in declared if is_final(part.annotation)]
    return [ast.unparse(part) for part in finals if isinstance(part.target, ast.Attribute) or part.value is None]


def test_final_attributes_are_found() -> None:
    text = "A: Final = 1\nclass B:\n    c: Final[int]\n    d: Final = 1\n    def __init__(self):\n        self.e: Final = 1"
    assert sorted(final_attributes(text)) == ["c: Final[int]", "self.e: Final = 1"]


def test_no_attribute_of_the_kernel_is_final() -> None:
    """mypyc gives it no setter, and a restored instance has its attributes set."""
    found = {name: final for name, file in sources().items() if (final := final_attributes(file.read_text()))}
    assert not found


@compiled_only
def test_every_attribute_of_a_compiled_class_can_be_set() -> None:
    assert KERNEL.kind == "kernel compiled", KERNEL.interpreted_because
    refused, count = [], 0
    for module in sources():
        for cls in vars(import_module(module)).values():
            if isinstance(cls, type) and cls.__module__ == module and is_compiled(cls):
                count += 1
                refused += unsettable(cls)
    assert count > 200 and not refused


def unsettable(cls: type) -> list[str]:
    try:
        found = bare_instance(cls)
    except TypeError as error:
        assert NO_INSTANCES in str(error)
        return []
    refused = []
    for name in attribute_names(cls):
        try:
            object.__setattr__(found, name, object())
        except AttributeError as error:
            refused.append(f"{cls.__module__}.{cls.__qualname__}.{name}: {error}")
        except TypeError:
            pass  # it has a type, and can be set to a value of that
    return refused


RECORD = """
import sys
from pathlib import Path
from cnc_ptp import KERNEL
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import machine_text, read_machine
from cnc_ptp.recording.offline_run import OfflineRun

machine = read_machine("config/mill.yaml")
entries = read_entries(machine, program="examples/tapping.nc", scenario=None, dialect=None)
units = build_units(machine, scenario=entries)
text = machine_text(Path("config/mill.yaml"))
with OfflineRun(machine, units, record=sys.argv[1], machine_text=text, checkpoint_seconds=1.0) as run:
    for _ in run.run():
        pass
print(KERNEL.kind)
"""
CONTINUE = """
import sys
from cnc_ptp import KERNEL
from cnc_ptp.commands.run.what_if import compute
from cnc_ptp.recording.run_difference import difference
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.what_if import Change, WhatIf

recorded = RunInputs(sys.argv[1])
run = WhatIf(recorded, Change(5.0))
compute(run, recorded, sys.argv[2])
print(KERNEL.kind, run.note, difference(sys.argv[1], sys.argv[2]).parts_at, sep="; ")
"""


def call(text: str, *arguments: Path, pure: bool) -> str:
    environment = os.environ | {"PYTHONPATH": str(ROOT), "CNC_PTP_PURE": "1" if pure else "0"}
    command = [sys.executable, "-c", text, *map(str, arguments)]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert not done.returncode, done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("written_pure", [True, False], ids=["written interpreted", "written compiled"])
@compiled_only
def test_each_kernel_continues_from_what_the_other_one_has_stored(written_pure: bool, tmp_path: Path) -> None:
    path, again = tmp_path / "run.mcap", tmp_path / "again.mcap"
    written = call(RECORD, path, pure=written_pure)
    read = call(CONTINUE, path, again, pure=not written_pure)
    kinds = ["kernel interpreted", "kernel compiled"]
    assert [written.startswith(kinds[0]), read.startswith(kinds[1])] == [written_pure] * 2
    assert read.endswith("; computed from the checkpoint at 5 s; None")
