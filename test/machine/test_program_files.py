"""Programs that call others: where these are looked for, and that a run, its recording and its replay have them."""

from __future__ import annotations

from pathlib import Path

import pytest
from machine_support import ROOT

from cnc_ptp.cli import main
from cnc_ptp.errors import CncError
from cnc_ptp.machine import program_files
from cnc_ptp.machine.program_files import called_names, called_programs, read_program
from cnc_ptp.recording.reader import read_recording


def test_names_of_called_programs() -> None:
    text = "N10 L a.nc ; L b.nc\nLL local\nX5 L c\nl cycle [@P1=3 NAME=d.cyc @P2=4]\nLL CYCLE [NAME=e]\n(L f.nc)\nBALL 5\nL ../g.nc"
    assert called_names(text) == ["a.nc", "b.nc", "c", "d.cyc", "f.nc"]


def test_programs_are_found_through_others_in_the_folder_of_the_first(tmp_path: Path) -> None:
    (tmp_path / "main.nc").write_text("L A.NC\nM30")
    (tmp_path / "a.nc").write_text("L b.nc\nL a.nc\nL nowhere.nc\nM29")
    (tmp_path / "b.nc").write_text("M29")
    text, files = read_program(str(tmp_path / "main.nc"))
    assert text == "L A.NC\nM30"
    assert files == {"a.nc": "L b.nc\nL a.nc\nL nowhere.nc\nM29", "b.nc": "M29"}


def test_a_program_of_the_user_replaces_one_that_ships(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shipped, own = tmp_path / "shipped", tmp_path / "own"
    for folder, text in ((shipped, "X1\nM29"), (own, "X2\nM29")):
        folder.mkdir()
        (folder / "drill.nc").write_text(text)
    monkeypatch.setattr(program_files, "SHIPPED", shipped)
    assert called_programs("L DRILL.NC", []) == {"drill.nc": "X1\nM29"}
    assert called_programs("L DRILL.NC", [str(own)]) == {"drill.nc": "X2\nM29"}
    assert called_programs("L drill.nc", [str(tmp_path / "not there"), str(own)]) == {"drill.nc": "X2\nM29"}


def test_more_programs_than_the_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(program_files, "MOST_FILES", 3)
    for n in range(5):
        (tmp_path / f"{n}.nc").write_text(f"L {n + 1}.nc\nM29")
    with pytest.raises(CncError) as refused:
        called_programs("L 0.nc", [str(tmp_path)])
    assert str(refused.value) == "P-ERR-26122 the program calls more than 3 other programs; nothing was started"


def test_run_recording_and_replay_have_the_called_programs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "main.nc").write_text("P1 = V.A.ACT_POS.X\nG00 X5\nL CYCLE [NAME=up.nc @P1=7]\nM30")
    (tmp_path / "up.nc").write_text("G00 Y[@P1]\nM29")
    recording = tmp_path / "run.mcap"
    mill = str(ROOT / "config" / "mill.yaml")
    command = ["simulate", mill, "--program", str(tmp_path / "main.nc"), "--record", str(recording)]
    with pytest.raises(SystemExit) as ended:
        main.main(command)
    assert ended.value.code == 0
    (tmp_path / "up.nc").unlink()  # the replay does not need it
    with pytest.raises(SystemExit) as ended:
        main.main(["replay", "--verify", str(recording)])
    assert ended.value.code == 0


def test_a_fault_of_a_called_program_is_told_before_anything_moves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "main.nc").write_text("G00 X5\nL up.nc\nM30")
    (tmp_path / "up.nc").write_text("G00 Q5\nM29")
    for command in ("check", "simulate"):
        options = ["--program"] if command == "simulate" else []
        machine = [str(ROOT / "config" / "mill.yaml")] if command == "simulate" else []
        with pytest.raises(SystemExit) as ended:
            main.main([command, *machine, *options, str(tmp_path / "main.nc")])
        assert ended.value.code == 2
        told = capsys.readouterr().err
        assert "P-ERR-20797 up.nc line 1 column 5 'G00 Q5': axis Q is not in the machine" in told
        assert told.endswith(f"G00 Q5\n    ^\ncalled in {tmp_path / 'main.nc'} line 2\n")


def test_folders_of_the_machine_file_come_after_that_of_the_program(tmp_path: Path) -> None:
    for folder in ("programs", "cycles", "shared"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / f"{folder}.nc").write_text("M29")
        (tmp_path / folder / "all.nc").write_text(f"({folder})\nM29")
    main_program = tmp_path / "programs" / "main.nc"
    main_program.write_text("L all.nc\nL cycles.nc\nL SHARED.NC\nM30")
    _, files = read_program(str(main_program), [str(tmp_path / "cycles"), str(tmp_path / "shared")])
    assert files == {"all.nc": "(programs)\nM29", "cycles.nc": "M29", "shared.nc": "M29"}


def test_nothing_outside_the_folders_is_read(tmp_path: Path) -> None:
    """Neither by a link, nor by a path, whatever its name is."""
    inside, cycles, outside = tmp_path / "inside", tmp_path / "cycles", tmp_path / "outside"
    for folder in (inside, cycles, outside):
        folder.mkdir()
    (outside / "secret.nc").write_text("X1\nM29")
    (cycles / "drill.nc").write_text("X2\nM29")
    (inside / "link.nc").symlink_to(outside / "secret.nc")
    (inside / "LINK2.NC").symlink_to(outside / "secret.nc")
    (inside / "folder.nc").symlink_to(outside)
    (inside / "gone.nc").symlink_to(outside / "nothing.nc")
    (inside / "own.nc").symlink_to(cycles / "drill.nc")
    paths = f"{outside}/secret.nc", "../outside/secret.nc", "..\\outside\\secret.nc", "folder.nc/secret.nc", "..", "."
    text = "\n".join(f"L {name}" for name in (*paths, "link.nc", "link2.nc", "folder.nc", "gone.nc", "own.nc"))
    assert called_programs(text, [str(inside), str(cycles)]) == {"own.nc": "X2\nM29"}
    assert called_programs("L own.nc", [str(inside)]) == {}
    (tmp_path / "linked").symlink_to(inside)
    (inside / "plain.nc").write_text("X3\nM29")
    assert called_programs("L plain.nc", [str(tmp_path / "linked")]) == {"plain.nc": "X3\nM29"}


def test_a_machine_with_offset_files_and_folders_is_recorded_and_replayed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The replay needs none of the files; a changed one does not change it."""
    machine, recording = tmp_path / "mill.yaml", tmp_path / "run.mcap"
    text = (ROOT / "config" / "mill.yaml").read_text()
    settings = "/channel:\n  ros__parameters:\n    nullp_data: vices.yaml\n    interpreter.folders: [cycles]\n"
    machine.write_text(text.replace("/channel:\n  ros__parameters:\n", settings))
    (tmp_path / "vices.yaml").write_text("G54: {name: vice, X: 12.5}\n")
    (tmp_path / "cycles").mkdir()
    (tmp_path / "cycles" / "up.nc").write_text("G00 X1\nM29")
    (tmp_path / "main.nc").write_text("G54\nL up.nc\nM30")
    assert (
        called([*["simulate"], str(machine), "--program", str(tmp_path / "main.nc"), "--record", str(recording)]) == 0
    )
    assert called(["check", str(tmp_path / "main.nc"), "--machine", str(machine), "--canonical"]) == 0
    assert "rapid (13.5, 0, 0)" in capsys.readouterr().out
    (tmp_path / "vices.yaml").write_text("G54: {X: 99}\n")
    (tmp_path / "cycles" / "up.nc").unlink()
    assert called(["replay", "--verify", str(recording)]) == 0
    recorded = read_recording(recording)
    assert recorded.machine_yaml.endswith("--- # file of the machine: vices.yaml\nG54: {name: vice, X: 12.5}\n\n")


def called(command: list[str]) -> int:
    with pytest.raises(SystemExit) as ended:
        main.main(command)
    return int(str(ended.value.code))
