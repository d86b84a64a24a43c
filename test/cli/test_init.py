"""`cnc_ptp init`: machine files to begin with, which run and say what they hold."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from commands_support import call

from cnc_ptp.commands.init.init import machine_file, machines
from cnc_ptp.parameters import catalogue, load_machine, read_machine
from cnc_ptp.parameters.declare.declarations import dotted

PROGRAMS = {
    "mill": "N10 G90 G0 X50 Y20 Z10\nN20 M3 S3000\nN30 G1 X80 F1200\nN40 G2 X90 Y30 I0 J10\nN50 M5\nN60 M30\n",
    "lathe": "N10 G90 G51\nN20 G0 X60 Z20\nN30 M3 S500\nN40 G1 Z5 F300\nN50 M5\nN60 M30\n",
}
MODES = {
    "ACHSMODE_LINEAR | ACHSMODE_PLANDREHEN": 0x41,
    "ACHSMODE_LINEAR | ACHSMODE_LAENGSDREHEN": 0x81,
    "ACHSMODE_MODULO": 4,
}
SCENARIO = """\
- {at: 0.0, to: x, do: move_absolute, target: 500, velocity: 1000}
- {at: 0.0, to: c, do: move_modulo, position: 90, velocity: 180}
"""


def test_there_is_a_file_for_each_kind() -> None:
    assert set(machines()) == {"mill", "lathe", "ptp"}


@pytest.mark.parametrize("kind", ["mill", "lathe", "ptp"])
def test_the_file_loads_without_a_warning(kind: str) -> None:
    machine = load_machine(machine_file(kind, "m.yaml"), "m.yaml")
    assert [str(line) for line in machine.warnings] == []


@pytest.mark.parametrize("kind", ["mill", "lathe", "ptp"])
def test_it_holds_what_the_table_says(kind: str) -> None:
    """Read back: the values of machines.yaml and no others."""
    machine = load_machine(machine_file(kind, "m.yaml"), "m.yaml")
    for node, parameters in machines()[kind]["nodes"].items():
        given = {name: value.value for name, value in machine.raw(node).given.items()}
        wanted = {
            dotted(name): tuple(value) if isinstance(value, list) else value for name, value in parameters.items()
        }
        wanted |= {name: MODES[value] for name, value in wanted.items() if name == "kenngr.achs_mode"}
        assert given == wanted


@pytest.mark.parametrize("kind", ["mill", "lathe", "ptp"])
def test_every_line_says_what_it_is(kind: str) -> None:
    names = {entry.key.rpartition(".")[2]: entry.id for entry in catalogue().by_id.values()}
    lines = [line for line in machine_file(kind, "m.yaml").splitlines() if re.search(r": \S", line) and line[0] == " "]
    assert len(lines) > 20
    for line in lines:
        key, number = line.strip().partition(":")[0], re.search(r"# (P-[A-Z]+-[0-9]{5})", line)
        assert number is not None, line
        entry = catalogue().by_id[number[1]]
        assert key.strip('"').isdecimal() or (entry.key.endswith(key) and key in names)
    text = machine_file(kind, "m.yaml")
    assert (
        "kv: 5000                            # P-AXIS-00099, 50 1/s: Gain of the proportional position controller\n"
        in text
    )


def test_speeds_of_spindles_are_rpm() -> None:
    assert re.search(r"vb_max: 72000000 +# P-AXIS-00212, 12000 rpm: ", machine_file("mill", "m.yaml"))


@pytest.mark.parametrize("kind", ["mill", "lathe"])
def test_a_program_runs_on_it(kind: str, tmp_path: Path) -> None:
    file, program = tmp_path / "m.yaml", tmp_path / "p.nc"
    program.write_text(PROGRAMS[kind], encoding="utf-8")
    assert call("init", kind, "-o", str(file)).exit_code == 0
    done = call("simulate", str(file), "--program", str(program), "--strict")
    assert done.exit_code == 0, done.output + done.stderr


def test_axes_move_on_it(tmp_path: Path) -> None:
    file, scenario = tmp_path / "m.yaml", tmp_path / "s.yaml"
    scenario.write_text(SCENARIO, encoding="utf-8")
    assert call("init", "ptp", "-o", str(file)).exit_code == 0
    assert call("simulate", str(file), "--scenario", str(scenario), "--strict").exit_code == 0


def test_a_lathe_has_a_c_axis(tmp_path: Path) -> None:
    file, program = tmp_path / "m.yaml", tmp_path / "p.nc"
    program.write_text("N10 G90 G0 X60 Z20\nN20 #CAX[S, C]\nN30 G1 C90 F300\nN40 #CAX OFF\nN50 M30\n", encoding="utf-8")
    call("init", "lathe", "-o", str(file))
    done = call("simulate", str(file), "--program", str(program), "--strict")
    assert done.exit_code == 0, done.output + done.stderr


def test_the_name_comes_from_the_kind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = call("init", "mill")
    assert done.output == (
        "mill.yaml: A milling machine, axes X, Y and Z and a spindle. Try: cnc_ptp params check mill.yaml\n"
    )
    assert list(read_machine("mill.yaml").axes) == ["x", "y", "z"]
    assert call("params", "check", "mill.yaml").output == "0 errors, 0 warnings: the machine starts\n"


def test_it_overwrites_nothing(tmp_path: Path) -> None:
    file = tmp_path / "m.yaml"
    file.write_text("mine", encoding="utf-8")
    done = call("init", "ptp", "-o", str(file))
    assert done.exit_code == 2
    assert done.stderr == (
        f"P-ERR-27030 {file} exists already and is not overwritten; nothing was written, -o FILE names another one\n"
    )
    assert file.read_text(encoding="utf-8") == "mine"


def test_a_folder_that_is_not_there(tmp_path: Path) -> None:
    file = tmp_path / "none" / "m.yaml"
    done = call("init", "ptp", "-o", str(file))
    assert (done.exit_code, done.stderr) == (
        2,
        f"P-ERR-27030 {file} cannot be written: there is no folder {file.parent}, make it or give another name; "
        "nothing was started\n",
    )


@pytest.mark.skipif(os.geteuid() == 0 and not Path("/proc/version").exists(), reason="there is no such file")
def test_a_file_that_cannot_be_written() -> None:
    done = call("init", "ptp", "-o", "/proc/none.yaml")
    assert done.exit_code == 2
    assert done.stderr.startswith("P-ERR-27030 /proc/none.yaml cannot be written: ")
    assert done.stderr.endswith("; there is no machine file\n")


def test_an_unknown_kind() -> None:
    assert call("init", "robot").exit_code == 2


def test_editors_find_the_schema(tmp_path: Path) -> None:
    first = machine_file("mill", "m.yaml").splitlines()[0]
    found = re.fullmatch(r"# yaml-language-server: \$schema=file://(.+/tools/machine\.schema\.json)", first)
    assert found is not None and Path(found[1]).is_file()
