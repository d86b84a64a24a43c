"""Compiled and interpreted kernel: which one runs, the same bits from both, and what happens where one cannot be built."""

import os
import shutil
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest
from long_support import long_but
from loop_support import PLANT, T, control, make_loop

from cnc_ptp import KERNEL
from cnc_ptp.compiled import build as build_module
from cnc_ptp.compiled import finder as finder_module
from cnc_ptp.compiled.build import build, translate
from cnc_ptp.compiled.finder import changed
from cnc_ptp.compiled.sources import FAILURE, hashes, library_file, read_state, recipe, sources, state_file, write_state
from cnc_ptp.control.drives import (
    CascadedDrive,
    DelayedDrive,
    Drive,
    FirstOrderDrive,
    LagCommandedDrive,
    PositionCommandedDrive,
    TelegramDrive,
    VirtualDrive,
)
from cnc_ptp.recording.reader import iter_messages

ROOT = Path(__file__).parents[2]
EDITED = "changed since it was compiled" in KERNEL.interpreted_because
compiled_only = pytest.mark.skipif(EDITED, reason="the sources have changed since they were compiled")
"""Without a library these tests fail: a set-up that no longer compiles must not go unnoticed."""
RUNS = {
    "bracket": (
        "config/mill.yaml",
        "--program",
        "examples/bracket.nc",
        "--scenario",
        "examples/bracket_overrides.yaml",
    ),
    "spindles": ("examples/spindles/three_spindles.yaml", "--program", "examples/spindles/three_spindles.nc"),
    "gantry": ("config/gantry.yaml", "--scenario", "examples/figures/slave_gantry.yaml"),
    "cam": ("config/ptp.yaml", "--scenario", "examples/figures/slave_cam.yaml"),
    "external setpoints": ("config/ptp.yaml", "--scenario", "examples/figures/ptp_external_setpoints.yaml"),
}


def call(*arguments: object, pure: bool = False, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": str(folder), "CNC_PTP_PURE": "1" if pure else "0"}
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.parametrize("run", long_but(RUNS, ("spindles", "gantry")))
@compiled_only
def test_both_kernels_give_the_same_bits(run: str, tmp_path: Path) -> None:
    files = tmp_path / "compiled" / "run.mcap", tmp_path / "interpreted" / "run.mcap"
    for file, pure in zip(files, (False, True), strict=True):
        file.parent.mkdir()
        done = call("-m", "cnc_ptp", "simulate", *RUNS[run], "--record", file, pure=pure)
        assert done.returncode == (1 if run == "gantry" else 0), done.stderr  # the gantry ends in its difference
        kind = "interpreted" if pure else "compiled"
        assert done.stdout.splitlines()[0].endswith(f"times real time, kernel {kind}")
    assert [*iter_messages(files[0])] == [*iter_messages(files[1])]  # but for the metadata and the checkpoints


@compiled_only
def test_the_version_says_which_kernel_runs() -> None:
    assert call("-m", "cnc_ptp", "--version").stdout.endswith(", kernel compiled\n")
    assert call("-m", "cnc_ptp", "--version", pure=True).stdout.endswith(", kernel interpreted (CNC_PTP_PURE is set)\n")


@compiled_only
def test_a_fault_in_the_compiled_kernel_has_file_and_line() -> None:
    done = call("-c", "from cnc_ptp.axis.cam import CamTable\nCamTable(None, cyclic=True)")
    assert 'File "cnc_ptp/axis/cam.py", line ' in done.stderr and "in __init__" in done.stderr


@compiled_only
def test_an_edited_source_never_runs_as_its_old_compiled_self(tmp_path: Path) -> None:
    ignored = shutil.ignore_patterns("msg", "srv", "action", "__pycache__")
    shutil.copytree(ROOT / "cnc_ptp", tmp_path / "cnc_ptp", ignore=ignored)
    shutil.copytree(ROOT / "config", tmp_path / "config")
    assert call("-m", "cnc_ptp", "--version", folder=tmp_path).stdout.endswith(", kernel compiled\n")
    edited = tmp_path / "cnc_ptp" / "axis" / "axis_unit.py"
    edited.write_text(edited.read_text() + "\nprint('the edited one')\n")
    done = call("-m", "cnc_ptp", "simulate", "config/ptp.yaml", "--duration", "0.01", folder=tmp_path)
    assert done.stdout.startswith("the edited one\n")
    assert done.stderr == (
        "kernel interpreted (cnc_ptp/axis/axis_unit.py has changed since it was compiled); make setup compiles it again\n"
    )


@pytest.mark.parametrize(
    ("current", "text"),
    [
        ({"cnc_ptp.a": "1", "cnc_ptp.b.c": "2"}, ""),
        ({"cnc_ptp.a": "1", "cnc_ptp.b.c": "3"}, "cnc_ptp/b/c.py has changed"),
        ({"cnc_ptp.a": "1"}, "cnc_ptp/b/c.py has changed"),
        ({"cnc_ptp.a": "1", "cnc_ptp.b.c": "2", "cnc_ptp.d": "4"}, "cnc_ptp/d.py has changed"),
        ({"cnc_ptp.a": "0", "cnc_ptp.d": "4"}, "cnc_ptp/a.py and 2 more have changed"),
    ],
)
def test_what_has_changed(current: dict[str, str], text: str) -> None:
    assert changed({"cnc_ptp.a": "1", "cnc_ptp.b.c": "2"}, current) == text


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (ImportError("no", name="mypyc"), "it cannot be compiled without mypyc"),
        (RuntimeError("command 'gcc' failed: No such file\nmore"), "it could not be compiled: command 'gcc' failed: No such file; build/kernel.log has more"),
        (AssertionError(), "it could not be compiled: AssertionError; build/kernel.log has more"),
    ],
)  # fmt: skip
def test_a_kernel_that_cannot_be_compiled_runs_interpreted(
    error: BaseException, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr(build_module, "make_library", fail)
    assert build(tmp_path / "library") == reason
    assert read_state(tmp_path / "library") == {FAILURE: reason, **hashes(sources() | recipe())}


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("x: int = 'a'\n", 'wrong.py:1: error: Incompatible types in assignment (expression has type "str"'),
        ("def f(:\n", "wrong.py:1: error: "),
    ],
)
def test_a_source_that_the_compiler_refuses_is_named(
    source: str, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "wrong.py").write_text(source)
    (tmp_path / "pyproject.toml").write_text("[tool.mypy]\n")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SyntaxError) as refused:
        translate([Path("wrong.py")], tmp_path / "work")
    assert reason in str(refused.value)
    assert str(refused.value) in capsys.readouterr().out


def test_a_failure_counts_until_a_source_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CNC_PTP_PURE", raising=False)
    monkeypatch.setattr(finder_module, "LIBRARY", tmp_path)
    state = hashes(sources() | recipe())
    told = []
    for kept in (
        {},
        {FAILURE: "it failed", **state},
        {FAILURE: "it failed", **state, "cnc_ptp.axis.axis_unit": "0"},
    ):
        write_state(tmp_path, kept)
        kernel = finder_module.Kernel()
        kernel.choose()
        told.append((kernel.interpreted_because, kernel.remedy))
    assert told == [
        ("it was not compiled", "make setup compiles it again"),
        ("it failed", "make setup compiles it again"),
        ("cnc_ptp/axis/axis_unit.py has changed since its last compilation began", "make setup compiles it again"),
    ]


def test_while_it_is_being_compiled_the_kernel_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CNC_PTP_PURE", raising=False)
    monkeypatch.setattr(finder_module, "LIBRARY", tmp_path)
    told = []

    def look(*_: object) -> None:
        kernel = finder_module.Kernel()
        kernel.choose()
        told.append(kernel.interpreted_because)

    monkeypatch.setattr(build_module, "make_library", look)
    build(tmp_path)
    assert told == ["it is being compiled, or its compilation was interrupted"]


def test_a_library_of_these_sources_is_not_built_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[object] = []

    def make(*arguments: object) -> None:
        calls.append(arguments)
        library_file(tmp_path).touch()

    monkeypatch.setattr(build_module, "make_library", make)
    assert [build(tmp_path), build(tmp_path)] == ["", ""]
    assert len(calls) == 1 and read_state(tmp_path) == hashes(sources() | recipe())
    library_file(tmp_path).unlink()
    assert build(tmp_path) == "" and len(calls) == 2


def test_a_second_build_waits_for_the_first_one_and_finds_its_library(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls, begun, go_on = [], threading.Event(), threading.Event()

    def make(*_: object) -> None:
        calls.append(1)
        begun.set()
        assert go_on.wait(30.0)
        library_file(tmp_path).touch()

    monkeypatch.setattr(build_module, "make_library", make)
    with ThreadPoolExecutor() as pool:
        first = pool.submit(build, tmp_path)
        assert begun.wait(30.0)
        second = pool.submit(build, tmp_path)
        time.sleep(0.2)
        assert not second.done()
        go_on.set()
        assert (first.result(), second.result(), len(calls)) == ("", "", 1)


@compiled_only
def test_a_library_that_cannot_be_loaded(tmp_path: Path) -> None:
    ignored = shutil.ignore_patterns("msg", "srv", "action", "__pycache__")
    shutil.copytree(ROOT / "cnc_ptp", tmp_path / "cnc_ptp", ignore=ignored)
    library = library_file(tmp_path / "cnc_ptp" / "compiled" / "library")
    library.write_bytes(b"of another computer")
    done = call("-m", "cnc_ptp", "--version", folder=tmp_path)
    assert f", kernel interpreted (it cannot be loaded: {library}: " in done.stdout and done.stderr.endswith(
        "; make setup compiles it again\n"
    )
    library.unlink()
    done = call("-m", "cnc_ptp", "--version", folder=tmp_path)
    assert f", kernel interpreted (it cannot be loaded: {library}: " in done.stdout and done.returncode == 0


def test_without_a_library_the_kernel_runs_interpreted(tmp_path: Path) -> None:
    ignored = shutil.ignore_patterns("msg", "srv", "action", "__pycache__", "library")
    shutil.copytree(ROOT / "cnc_ptp", tmp_path / "cnc_ptp", ignore=ignored)
    done = call("-m", "cnc_ptp", "--version", folder=tmp_path)
    assert done.stdout.endswith(", kernel interpreted (it was not compiled)\n")
    assert done.stderr == "kernel interpreted (it was not compiled); make setup compiles it again\n"
    (tmp_path / "cnc_ptp" / "compiled" / "library").mkdir()
    state = state_file(tmp_path / "cnc_ptp" / "compiled" / "library")
    state.write_text('{"failure": "it cannot be compiled without mypyc"}')
    done = call("-m", "cnc_ptp", "--version", folder=tmp_path)
    assert done.stdout.endswith(", kernel interpreted (it cannot be compiled without mypyc)\n")


class Shown(Drive):
    """A drive that is where it is told to be."""

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        self.position = self.velocity = self.torque = command


@pytest.mark.parametrize("kind", ["plain", "first order", "cascaded", "virtual", "position", "lag", "bus", "telegram"])
def test_a_value_that_is_the_compilers_mark_for_undefined_is_a_value(kind: str) -> None:
    """mypyc marks a float that was not set by -113: an axis can be there all the same."""
    mark = -113.0
    shown = Shown(position=mark)
    shown.step(mark)
    drives = {
        "plain": lambda: shown,
        "first order": lambda: FirstOrderDrive(
            cycle_time=T, time_constant=0.0, encoder_increment=0.0, start_position=mark
        ),
        "cascaded": lambda: CascadedDrive(replace(PLANT, start_position=mark), cycle_time=T),
        "virtual": lambda: VirtualDrive(start_position=mark),
        "position": lambda: PositionCommandedDrive(shown, kv=1.0),
        "lag": lambda: LagCommandedDrive(shown, kv=1.0),
        "bus": lambda: DelayedDrive(shown, cycles=1, rest=0.0),
        "telegram": lambda: TelegramDrive(control(), shown, cycle_time=T),
    }
    assert make_loop(control(), drives[kind]()).position == mark
