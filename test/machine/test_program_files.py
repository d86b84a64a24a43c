"""Programs that call others: where these are looked for, and that a run, its recording and its replay have them."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest
from machine_support import ROOT

from cnc_ptp.cli import main
from cnc_ptp.commands.look.check import check
from cnc_ptp.commands.look.program_plot import plot_program
from cnc_ptp.commands.run.simulate import simulate
from cnc_ptp.errors import CncError
from cnc_ptp.machine import program_files
from cnc_ptp.machine.program_files import SHIPPED, Search, called_names, called_programs, read_file, read_program
from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.flow.flow_faults import FILE_UNKNOWN
from cnc_ptp.recording.reader import read_recording

MILL = (ROOT / "config" / "mill.yaml").read_text()
CHANNEL = "/channel:\n  ros__parameters:\n"


def test_names_of_called_programs() -> None:
    text = "N10 L a.nc ; L b.nc\nLL local\nX5 L c\nl cycle [@P1=3 NAME=d.cyc @P2=4]\nLL CYCLE [NAME=e]\n(L f.nc)\nBALL 5\nL ../g.nc"
    assert called_names(text, {}) == ["a.nc", "b.nc", "c", "d.cyc", "f.nc"]


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
    _, files = read_program(str(main_program), Search((str(tmp_path / "cycles"), str(tmp_path / "shared"))))
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


def test_cycles_that_the_machine_file_names(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """G81 calls spot.nc (P-CHAN-00161); the run, `check`, manual blocks and the replay know it."""
    machine, recording = tmp_path / "mill.yaml", tmp_path / "run.mcap"
    text = (ROOT / "config" / "mill.yaml").read_text()
    settings = "/channel:\n  ros__parameters:\n    g81_prog_file: spot.nc\n    g84_prog_file: thread.nc\n"
    machine.write_text(text.replace("/channel:\n  ros__parameters:\n", settings))
    (tmp_path / "spot.nc").write_text("G00 X[@P1]\nM29")
    (tmp_path / "main.nc").write_text("G81[7]\nM30")
    (tmp_path / "scenario.yaml").write_text("- {at: 2, to: channel, do: mdi, text: 'G81[-7]'}\n")
    program = str(tmp_path / "main.nc")
    assert called(["check", program, "--machine", str(machine), "--canonical"]) == 0
    assert "1:N0 | rapid (7, 0, 0)" in capsys.readouterr().out
    run = ["simulate", str(machine), "--program", program, "--scenario", str(tmp_path / "scenario.yaml")]
    assert called([*run, "--record", str(recording)]) == 0
    (tmp_path / "spot.nc").write_text("M29")
    assert called(["replay", "--verify", str(recording)]) == 0
    moved = read_recording(recording).states["/x/state"]["set_position"]
    assert (max(moved), moved[-1]) == (7.0, -7.0)
    (tmp_path / "main.nc").write_text("G84[7]\nM30")
    capsys.readouterr()
    assert called(["check", program, "--machine", str(machine)]) == 2
    assert capsys.readouterr().err.splitlines()[0] == (
        f"P-ERR-21598 {program} line 1 column 1 'G84[7]': G84 calls thread.nc (P-CHAN-00164), which is in no search "
        "folder; put a program of this name beside the main one"
    )


def test_a_file_that_is_a_subroutine(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`check --as-subroutine` executes it if it needs no @ parameters, else it is only read."""
    file = tmp_path / "hole.nc"
    for text, output in (
        (
            "G00 X[@P1] Y[@DEPTH]\nM29\n",
            "hole.nc: no syntax errors in 2 lines; not executed without values of @DEPTH, @P1\n",
        ),
        ("G00 X1\nM17\n", "hole.nc: no errors in 2 lines\n"),
    ):
        file.write_text(text)
        assert called(["check", str(file), "--as-subroutine"]) == 0
        assert capsys.readouterr().out == output
        assert called(["check", str(file)]) == 2
        word = text.split()[-1]
        error = f"P-ERR-21018 {file} line 2 column 1 '{word}': {word} ends a subroutine, but this is the main program"
        printed = capsys.readouterr().err.splitlines()
        assert printed[-4:] == [error, word, "^", "note: --as-subroutine checks a file that other programs call"]
        assert called(["format", str(file)]) == 0
        assert capsys.readouterr().out == text
    file.write_text("G01 X1\nM29\n")
    assert called(["check", str(file), "--as-subroutine"]) == 2
    assert "P-ERR-20008 hole.nc line 1 column 1 'G01 X1'" in capsys.readouterr().err
    file.write_text("G00 X1\nG77\n")
    assert called(["check", str(file), "--as-subroutine"]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("P-ERR")]
    assert [line.split()[0] for line in lines] == ["P-ERR-20131"]
    assert called(["format", str(file)]) == 2


def called(command: list[str]) -> int:
    with pytest.raises(SystemExit) as ended:
        main.main(command)
    return int(str(ended.value.code))


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        ("G00 X1\nM30\n".encode("utf-16"), "it is UTF-16 text; save it as UTF-8"),
        ("G00 X1\nM30\n".encode("utf-16-le"), "it is UTF-16 text; save it as UTF-8"),
        ("G00 X1\nM30\n".encode("utf-16-be"), "it is UTF-16 text; save it as UTF-8"),
        ("G00 X1\nM30\n".encode("utf-32"), "it is UTF-32 text; save it as UTF-8"),
        ("G00 X1\nM30\n".encode("utf-32-le"), "it is UTF-32 text; save it as UTF-8"),
        ("G00 X1\nM30\n".encode("utf-32-be"), "it is UTF-32 text; save it as UTF-8"),
        (bytes(3), "it is no text, its first characters are NUL"),
        (bytes(1000), "it is no text, its first characters are NUL"),
        ("G00 X1 ; ä\nM30\n".encode("utf-16-le"), "it is UTF-16 text; save it as UTF-8"),
        (
            "G00 X1\nY2 ; ø10 Hänge\n".encode().replace("ä".encode(), b"\xe4"),
            "it is not UTF-8 text, byte 0xE4 in line 2 column 11 ('ä' in Latin-1); save it as UTF-8",
        ),
        (b"G00\x93", "it is not UTF-8 text, byte 0x93 in line 1 column 4; save it as UTF-8"),
    ],
)
def test_a_text_in_another_coding_says_which_and_where(tmp_path: Path, data: bytes, reason: str) -> None:
    file = tmp_path / "a.nc"
    file.write_bytes(data)
    with pytest.raises(CncError) as caught:
        read_program(str(file))
    assert str(caught.value) == f"P-ERR-26110 NC program {file} cannot be read: {reason}; nothing was started"


def test_an_unknown_program_shows_the_folders(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "main.nc").write_text("G00 X1\nL hole.nc\nM30\n")
    search = Search((str(tmp_path / "gone"),))
    assert search.missing == [str(tmp_path / "gone")]
    error = FILE_UNKNOWN.at(Source("main.nc", 2, 0, "L hole.nc"), 1, name="HOLE.NC", nearest="")
    search.explain(error, str(tmp_path / "main.nc"))
    shipped = f"{SHIPPED} (cycles that ship with cnc_ptp)"
    assert error.note == f"searched: {tmp_path}, {tmp_path / 'gone'} (does not exist), {shipped}"
    assert check(str(tmp_path / "main.nc"), None) == 2
    assert capsys.readouterr().err.splitlines()[2:] == [
        "^",
        f"note: searched: {tmp_path}, {shipped}",
        f"note: behind line 2 of {tmp_path / 'main.nc'} only the syntax was checked: what follows depends on it",
    ]


def test_syntax_errors_follow_the_note_that_only_the_syntax_was_checked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Line 3 would be an error of the modal check, line 4 is one of syntax."""
    (tmp_path / "main.nc").write_text("G00 X1\nP1 = 1/0\nG01 X1\nG77\nM30\n")
    assert check(str(tmp_path / "main.nc"), None) == 2
    lines = capsys.readouterr().err.splitlines()
    note = f"note: behind line 2 of {tmp_path / 'main.nc'} only the syntax was checked: what follows depends on it"
    assert [line for line in lines if line.startswith(("P-ERR", "note"))][1] == note
    assert [line.split()[3] for line in lines if line.startswith("P-ERR")] == ["2", "4"]


def test_a_search_folder_that_is_missing_is_a_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    machine = tmp_path / "m.yaml"
    machine.write_text(MILL.replace(CHANNEL, f"{CHANNEL}    interpreter: {{folders: [gone]}}\n"))
    (tmp_path / "main.nc").write_text("G00 X1\nM30\n")
    assert check(str(tmp_path / "main.nc"), str(machine)) == 0
    assert capsys.readouterr().err == f"warning: search folder {tmp_path / 'gone'} (P-CHAN-90004) does not exist\n"


def test_a_run_warns_of_it_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    machine = tmp_path / "m.yaml"
    machine.write_text(MILL.replace(CHANNEL, f"{CHANNEL}    interpreter: {{folders: [gone]}}\n"))
    (tmp_path / "main.nc").write_text("G00 X1 Y1\nM30\n")
    warning = f"warning: search folder {tmp_path / 'gone'} (P-CHAN-90004) does not exist"
    assert simulate(str(machine), str(tmp_path / "main.nc"), None, None, None) == 0
    assert warning in capsys.readouterr().err.splitlines()
    assert plot_program(str(tmp_path / "main.nc"), str(machine)) == 0
    assert warning in capsys.readouterr().err.splitlines()


def test_a_long_text_is_in_memory_once(tmp_path: Path) -> None:
    file = tmp_path / "long.nc"
    file.write_text("X1.000 Y2.000\r\n" * 2_000_000, newline="")
    tracemalloc.start()
    text = read_file("NC program", str(file))
    largest = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(text) == 28_000_000 and text.endswith("Y2.000\n") and "\r" not in text
    assert largest < 1.3 * len(text)
