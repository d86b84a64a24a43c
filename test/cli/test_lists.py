"""`cnc_ptp lists`: what is written, where, and that nothing is when something is wrong."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from commands_support import MILL, ROOT, call
from lists_support import SMALL

from cnc_ptp.commands import lists as lists_command
from cnc_ptp.parameters import read_machine

END = "; nothing was written\n"


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """A folder with the lists of a small machine."""
    folder = tmp_path / "small"
    folder.mkdir()
    for name, text in SMALL.items():
        (folder / name).write_text(text)
    return folder


def entries(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_there_and_back(tmp_path: Path) -> None:
    folder, machine = tmp_path / "lists", tmp_path / "mill.yaml"
    done = call("lists", "export", MILL, "-o", folder)
    assert done.exit_code == 0
    assert done.output.splitlines()[-1] == "9 lists are written"
    assert done.output.splitlines()[:-1] == [
        str(folder / name) for name in sorted(entries(folder), key=done.output.find)
    ]
    done = call("lists", "import", folder, "-o", machine)
    assert done.exit_code == 0
    *_, summary, last = done.output.splitlines()
    assert re.fullmatch(r"9 lists: 188 lines read, 0 corrected, 0 unknown, \d+ defaults, 0 notices", summary)
    assert last == f"{machine} is written"
    assert list(read_machine(machine).axes) == ["x", "y", "z"]
    assert entries(tmp_path) == ["lists", "mill.yaml"]


def test_the_report_file_has_every_line(small: Path, tmp_path: Path) -> None:
    report = tmp_path / "report.txt"
    done = call("lists", "import", small, "-o", tmp_path / "m.yaml", "--report", report)
    assert done.exit_code == 0
    lines = report.read_text().splitlines()
    assert f"{small}/achs_mds_x.lis:3:1: read: getriebe[0].kv 5000 # 50 1/s" in lines
    assert f"{small}/achs_mds_x.lis:1:1: default: P-AXIS-00103 getriebe[0].lose 0" in lines
    assert lines[-1] == done.output.splitlines()[-2]
    assert not any(": read: " in line for line in done.output.splitlines())


def test_a_faulty_list_writes_nothing(small: Path, tmp_path: Path) -> None:
    (small / "achs_mds_x.lis").write_text("kopf.achs_nr 1\ngetriebe[0].kv 1o00\n")
    machine = tmp_path / "m.yaml"
    machine.write_text("as before")
    done = call("lists", "import", small, "-o", machine, "--report", tmp_path / "report.txt", "--force")
    assert done.exit_code == 2
    assert done.output.startswith(
        f"P-ERR-25007 {small}/achs_mds_x.lis:2:16: axis list, P-AXIS-00099 getriebe[0].kv of /x"
    )
    assert machine.read_text() == "as before"
    assert entries(tmp_path) == ["m.yaml", "small"]


def test_an_output_that_is_there(small: Path, tmp_path: Path) -> None:
    machine = tmp_path / "m.yaml"
    machine.write_text("as before")
    done = call("lists", "import", small, "-o", machine)
    assert (done.exit_code, done.output) == (
        2,
        f"P-ERR-25045 {machine} exists; name another file, or add --force{END}",
    )
    assert machine.read_text() == "as before"
    assert call("lists", "import", small, "-o", machine, "--force").exit_code == 0
    assert read_machine(machine).axes


def test_outputs_that_cannot_be(small: Path, tmp_path: Path) -> None:
    beside = tmp_path / "none" / "m.yaml"
    for output, text in (
        (beside, f"{beside} cannot be written: there is no folder {beside.parent}, make it or give another name"),
        (tmp_path, f"{tmp_path} is a folder; name a file"),
        (
            small / "achs_mds_x.lis",
            f"{small}/achs_mds_x.lis would stand among the lists; name a file of another folder, or *.yaml",
        ),
    ):
        done = call("lists", "import", small, "-o", output, "--force")
        assert (done.exit_code, done.output) == (2, f"P-ERR-25045 {text}{END}")
    done = call("lists", "import", small, "-o", tmp_path / "m", "--report", tmp_path / "m")
    assert done.output == f"P-ERR-25045 {tmp_path}/m is both machine file and report; name two{END}"


def test_a_folder_that_is_none(tmp_path: Path) -> None:
    for folder, reason in ((tmp_path / "none", "No such file or directory"), (MILL, "Not a directory")):
        done = call("lists", "import", folder, "-o", tmp_path / "m.yaml")
        text = f"{folder}:1:1: the folder of lists cannot be read, {reason}; name a folder with files *.lis"
        assert (done.exit_code, done.output) == (2, f"P-ERR-25040 {text}{END}")
    assert entries(tmp_path) == []


def test_names_of_files_that_cannot_be_written(small: Path, tmp_path: Path) -> None:
    for name in (b"achs_mds_\xff.lis", b"other\n.txt"):
        Path(os.fsdecode(os.fsencode(small) + b"/" + name)).write_bytes(b"")
    done = call("lists", "import", small, "-o", tmp_path / "m.yaml")
    text = "'achs_mds_\\udcff.lis' has characters that no list can hold in its name; rename it"
    assert done.output == f"P-ERR-25040 {small}:1:1: {text}{END}"


def test_a_file_that_is_too_large(small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lists_command, "LARGEST_FILE", 100)
    (small / "photo.png").write_bytes(bytes(101))
    done = call("lists", "import", small, "-o", tmp_path / "m.yaml")
    assert f"P-ERR-25017 {small}/photo.png:1:1: the file cannot be read, it is larger than 0 MB{END}" in done.output


def test_kinds_of_lists_by_option(small: Path, tmp_path: Path) -> None:
    (small / "table.txt").write_text("frict_comp.scaling_factor 5\nkopf.achs_nr 1\n")
    done = call("lists", "import", small, "-o", tmp_path / "m.yaml", "--as", "table.txt=compensation")
    assert f"{small}/table.txt: compensation list of /x: 2 lines read" in done.output.splitlines()
    done = call("lists", "import", small, "-o", tmp_path / "n.yaml", "--as", "table.txt=table")
    assert done.exit_code == 2
    assert "FILE=KIND is needed, KIND one of axis, channel, tool, zero, clamp, compensation, startup" in done.output


def test_kinds_of_the_option_are_those_of_lists() -> None:
    from cnc_ptp.commands.arguments import LIST_KINDS
    from cnc_ptp.parameters.lists.kinds import WORDS

    assert sorted(LIST_KINDS) == sorted(WORDS)


def test_unknown_lines_and_incomplete_machines(small: Path, tmp_path: Path) -> None:
    (small / "sda_mds_channel.lis").write_text("spdl_anzahl 3\nwhat 5\n")
    machine = tmp_path / "m.yaml"
    assert "P-ERR-25005" in call("lists", "import", small, "-o", machine, "--strict", "--incomplete").output
    assert "P-ERR-25012" in call("lists", "import", small, "-o", machine).output
    assert not machine.exists()
    done = call("lists", "import", small, "-o", machine, "--incomplete")
    assert done.exit_code == 0
    assert "notice: P-ERR-25012 " in done.output
    assert "    #? what 5\n" in machine.read_text()


def test_an_export_does_not_mix_with_other_lists(tmp_path: Path) -> None:
    folder = tmp_path / "lists"
    folder.mkdir()
    assert call("lists", "export", MILL, "-o", folder).exit_code == 0
    text = f"{folder} is not empty; name another folder, or add --force, which overwrites lists"
    assert call("lists", "export", MILL, "-o", folder).output == f"P-ERR-25045 {text}{END}"
    assert call("lists", "export", MILL, "-o", folder, "--force").exit_code == 0
    before = entries(folder)
    done = call("lists", "export", ROOT / "config" / "ptp.yaml", "-o", folder, "--force")
    others = "achs_kw_x.lis, achs_kw_y.lis, achs_mds_s.lis, sda_mds_channel.lis, werkz_data_channel.lis"
    text = f"{folder} has other lists: {others}; delete them, or name another folder"
    assert done.output == f"P-ERR-25045 {text}{END}"
    assert entries(folder) == before
    for output, reason in (
        (
            tmp_path / "a" / "b",
            f"{tmp_path}/a/b cannot be written: there is no folder {tmp_path}/a, make it or give another name",
        ),
        (folder / "hochlauf.lis", f"{folder}/hochlauf.lis is a file; name a folder"),
    ):
        assert call("lists", "export", MILL, "-o", output).output == f"P-ERR-25045 {reason}{END}"


def test_a_machine_that_no_node_accepts_is_not_exported(tmp_path: Path) -> None:
    machine = tmp_path / "m.yaml"
    machine.write_text("/machine: {ros__parameters: {axes: [x]}}\n/x: {ros__parameters: {kvv: 1}}\n")
    done = call("lists", "export", machine, "-o", tmp_path / "lists")
    assert done.exit_code == 2
    assert done.output.startswith(f"P-ERR-25005 {machine}:2:")
    assert entries(tmp_path) == ["m.yaml"]


def test_a_disk_that_does_not_take_it(small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    done = call("lists", "import", small, "-o", tmp_path / "m.yaml")
    assert done.output == f"P-ERR-25045 {tmp_path}/m.yaml cannot be written: No space left on device{END}"
    done = call("lists", "export", MILL, "-o", tmp_path / "lists")
    assert done.output == f"P-ERR-25045 {tmp_path}/lists cannot be written: No space left on device{END}"
    assert entries(tmp_path) == ["small"]
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "notes.txt").touch()
    done = call("lists", "export", MILL, "-o", tmp_path / "other", "--force")
    text = f"{tmp_path}/other cannot be written: No space left on device; the folder may hold a part of the lists"
    assert done.output == f"P-ERR-25045 {text}\n"
    assert entries(tmp_path) == ["other", "small"]
