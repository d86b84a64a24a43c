"""`cnc_ptp replay --from … --set …`, `cnc_ptp diff`, `simulate --checkpoints` as they are called."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from long_support import long_sets
from machine_support import ROOT

from cnc_ptp import cli
from cnc_ptp.recording.mcap_file import METADATA, McapFile
from cnc_ptp.recording.mcap_index import McapIndex
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.state import machine_state
from cnc_ptp.state.faults import not_storable

MILL = ROOT / "config" / "mill.yaml"
PROGRAM = "G01 X50 Y20 F2400\nX0\nX50 Y0\nX0\nM30\n"
WITHOUT = "the recording has no checkpoints; cnc_ptp replay --checkpoints makes them, once"


def call(*arguments: object) -> Result:
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


def simulated(folder: Path, *options: object, program: str = PROGRAM) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "lines.nc").write_text(program)
    path = folder / "run.mcap"
    result = call("simulate", MILL, "--program", folder / "lines.nc", "--record", path, *options)
    assert result.exit_code == 0, result.output
    return path


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return simulated(tmp_path_factory.mktemp("run"), "--checkpoints", 1)


def last_line(result: Result) -> str:
    assert result.exit_code == 2, result.output
    return " ".join(result.output.split())


@pytest.mark.parametrize(("seconds", "checkpoints"), [(2, [2000, 4000]), (0, []), *long_sets([(10, [])])])
def test_the_interval_of_the_checkpoints(seconds: int, checkpoints: list[int], tmp_path: Path) -> None:
    path = simulated(tmp_path, "--checkpoints", seconds)
    with RunInputs(path) as found:
        assert found.checkpoints == checkpoints
    assert not read_recording(path).attachments  # they are no texts for a report


def test_an_interval_below_0_is_refused(tmp_path: Path) -> None:
    result = call("simulate", MILL, "--checkpoints", -1)
    assert result.exit_code == 2 and "Invalid value for '--checkpoints'" in result.output


def test_without_checkpoints_all_is_computed_from_0_and_a_note_says_so(tmp_path: Path) -> None:
    path = simulated(tmp_path, "--checkpoints", 0)
    result = call("replay", path, "--from", 2, "--diff")
    assert f"note: computed from 0 s: {WITHOUT}" in result.output
    assert "both runs are equal to the bit" in result.output


def test_before_the_first_checkpoint_all_is_computed_from_0(recorded: Path) -> None:
    result = call("replay", recorded, "--from", 0.5)
    assert "note: computed from 0 s: the recording has no checkpoint before it" in result.output
    assert "both runs are equal to the bit" in result.output


def test_a_changed_run_is_recorded_compared_and_laid_over_the_recorded_one(recorded: Path, tmp_path: Path) -> None:
    new, page = tmp_path / "new.mcap", tmp_path / "diff.html"
    result = call("replay", recorded, "--from", 2, "--override", 50, "--to", 12, "-o", new, "--diff-page", page)
    assert result.exit_code == 0, result.output
    assert "note: computed from the checkpoint at 2 s" in result.output and "has not ended" not in result.output
    assert "the runs part at 2 s" in result.output
    first, second = program_times(result.output)
    assert second == pytest.approx(2 * first, rel=0.05)  # but for ramps, at half the feed twice as long
    assert read_recording(new).metadata["what_if_of"] == "run.mcap"
    text = page.read_text()
    assert "A set" in text and "B actual" in text and "B: new.mcap" in text
    assert text.index(">Differences<") < text.index(">Path<") < text.index(">Over time<")


def program_times(output: str) -> tuple[float, float]:
    found = re.search(r"program time channel: ([\d.]+) s -> ([\d.]+) s", output)
    assert found
    return float(found[1]), float(found[2])


def test_a_program_that_has_not_ended_is_named(recorded: Path) -> None:
    result = call("replay", recorded, "--from", 2, "--override", 50)
    assert "note: the program of channel has not ended; --to a later time computes more of it" in result.output


def test_another_program_and_further_commands(recorded: Path, tmp_path: Path) -> None:
    (tmp_path / "other.nc").write_text("G01 X7 F1200\nM30\n")
    (tmp_path / "more.yaml").write_text("- {at: 1.0, to: z, do: move_absolute, target: 5.0, velocity: 20.0}\n")
    new = tmp_path / "new.mcap"
    options = ("--program", tmp_path / "other.nc", "--commands", tmp_path / "more.yaml", "-o", new)
    result = call("replay", recorded, *options)
    assert result.exit_code == 0, result.output
    states = read_recording(new).states
    assert states["/x/state"]["set_position"].max() == 7.0
    z = states["/z/state"]
    assert z["set_position"][-1] == 5.0 and not z["set_position"][z["cycle"] < 1000].any()


def test_diff_of_recordings(recorded: Path, tmp_path: Path) -> None:
    same = call("diff", recorded, recorded, "-o", tmp_path / "same.html")
    assert same.exit_code == 0 and "both runs are equal to the bit" in same.output
    assert "<b>never</b><span>set values part at</span>" in (tmp_path / "same.html").read_text()
    part = call("diff", recorded, recorded, "--from", 1, "--to", 2, "-o", tmp_path / "part.html")
    assert "compared from 1 s to 2 s" in part.output
    other = tmp_path / "ptp.mcap"
    ptp = ROOT / "config" / "ptp.yaml"
    assert call("simulate", ptp, "--duration", 0.1, "--record", other).exit_code == 0
    assert last_line(call("diff", recorded, other)) == (
        f"P-ERR-26158 the recordings are of different machines: {recorded} has channel, s, x, y, z, 1 ms; "
        f"{other} has {units_of(other)}, 1 ms; nothing was compared"
    )


def units_of(path: Path) -> str:
    from cnc_ptp.parameters import load_machine

    machine = load_machine(read_recording(path).machine_yaml, "ptp.yaml")
    return ", ".join([*machine.channels, *machine.spindles, *machine.axes])


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--from", 60], "P-ERR-26154 --from 60 is not within the recorded time 0 ... {end} s; nothing was computed"),
        (["--from", 2, "--to", 1], "P-ERR-26154 --to 1 is before --from 2; nothing was computed"),
        (
            ["--set", "x.getriebe.0.kw=1"],
            "P-ERR-26153 --set 'x.getriebe.0.kw=1': axis x has no parameter 'getriebe.0.kw'; did you mean "
            "getriebe[i].kv (P-AXIS-00099)?; nothing was computed",
        ),
        (
            ["--set", "kv"],
            "P-ERR-26153 --set 'kv' is not of the form unit.parameter=value, as x.getriebe.0.kv=8000; "
            "nothing was computed",
        ),
        (
            ["--set", "x.getriebe.0.kv=1", "--set", "x.P-AXIS-00099=2"],
            "P-ERR-26153 --set 'x.P-AXIS-00099=2': axis list, P-AXIS-00099 getriebe[0].kv of /x is given twice; "
            "nothing was computed",
        ),
        (["--diff-page", "page.txt"], "P-ERR-27030 page.txt: the file name of a report must end in .html; nothing was started"),
        (["--output", "{path}"], "P-ERR-26117 recording {path} would overwrite the recording {path}; nothing was started"),
    ],
)  # fmt: skip
def test_refusals(options: list[object], text: str, recorded: Path) -> None:
    given = [str(option).replace("{path}", str(recorded)) for option in options]
    with RunInputs(recorded) as found:
        values = {"end": f"{found.end / 1000:g}", "path": recorded}
    assert last_line(call("replay", recorded, *given)) == text.format(**values)


def test_an_override_outside_is_refused(recorded: Path) -> None:
    result = call("replay", recorded, "--override", 1001)
    assert result.exit_code == 2
    assert "Invalid value for '--override': 1001.0 is not in the range 0.0<=x<=1000.0." in result.output


def test_verify_does_not_go_with_a_change(recorded: Path) -> None:
    result = call("replay", recorded, "--verify", "--from", 1)
    assert result.exit_code == 2
    assert "--verify, --publish and --checkpoints do not go with a changed run; nothing was replayed" in result.output


def test_a_state_of_other_sources_is_passed_over(recorded: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine_state, "kernel_digest", lambda: bytes(16))
    result = call("replay", recorded, "--from", 2)
    assert (
        "note: computed from 0 s: P-ERR-26152 checkpoint: the state is that of a kernel with other sources; "
        "nothing was restored"
    ) in result.output
    assert "both runs are equal to the bit" in result.output


def test_a_damaged_checkpoint_is_passed_over(recorded: Path, tmp_path: Path) -> None:
    index = McapIndex(recorded)
    place = index.attachments["checkpoint/2000"]
    state = index.attached("checkpoint/2000")
    index.close()
    content = bytearray(recorded.read_bytes())
    content[content.index(state, place) + 100] ^= 1
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(content)
    result = call("replay", damaged, "--from", 2.5, "-o", tmp_path / "new.mcap")
    assert "note: computed from the checkpoint at 1 s" in result.output


def test_missing_checkpoints_are_said_at_the_end_of_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def encode(_store: object, _machine: object) -> bytes:
        raise not_storable("[][channel].unit", "an interpreter that cannot be made again")

    monkeypatch.setattr(machine_state.StateStore, "encode", encode)
    (tmp_path / "lines.nc").write_text(PROGRAM)
    for seconds, when in ((2, "from 2 s to 4 s"), (4, "at 4 s")):
        options = ("--record", tmp_path / "run.mcap", "--checkpoints", seconds)
        result = call("simulate", MILL, "--program", tmp_path / "lines.nc", *options)
        assert (
            "note: P-ERR-26150 checkpoint: the state holds an interpreter that cannot be made again at "
            f"[][channel].unit; no state was stored {when}: a replay from then on begins at an older checkpoint, or at "
            "0 s\n"
        ) in result.output
        assert result.exit_code == 0


def test_a_plc_in_a_file_is_kept_and_a_note_says_that_it_is_not_executed(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    machine, plc = ROOT / "examples" / "homing.yaml", ROOT / "examples" / "plc_homing.py"
    assert call("simulate", machine, "--plc", plc, "--record", path, "--checkpoints", 1).exit_code == 0
    assert read_recording(path).attachments["plc/plc_homing.py"] == plc.read_text()
    result = call("replay", path, "--from", 2.2)
    assert "note: the PLC plc_homing.py is not executed again; its commands are those of the recording" in result.output
    assert "note: computed from the checkpoint at 2 s" in result.output
    assert "both runs are equal to the bit" in result.output


def foreign(path: Path, metadata: dict[str, str] | None = None) -> Path:
    """An MCAP file without machine and blocks."""
    with McapFile(path, describe=lambda _path, _information: None) as file:
        if metadata is not None:
            file.metadata(METADATA, metadata)
    return path


WHAT_IF, STORE, DIFF = ["replay", "{path}", "--from", 1], ["replay", "{path}", "--checkpoints", 1], ["diff", "{path}"]


@pytest.mark.parametrize("words", [WHAT_IF, STORE, DIFF], ids=lambda words: " ".join(map(str, words)))
def test_files_that_are_no_recordings_of_this_version(words: list[object], recorded: Path, tmp_path: Path) -> None:
    def told(path: Path) -> str:
        given = [str(word).replace("{path}", str(path)) for word in words]
        return last_line(call(*given, *([recorded] if words is DIFF else [])))

    future = foreign(tmp_path / "future.mcap", {"format": "99", "version": "9.0"})
    assert told(future) == (
        f"P-ERR-26016 recording {future}: has format 99 of cnc_ptp 9.0, this version reads up to format 1; nothing was "
        "read, use a newer version of cnc_ptp"
    )
    other = foreign(tmp_path / "other.mcap")
    without = (
        "P-ERR-26017 recording {}: is not of cnc_ptp; nothing was compared; `cnc_ptp export` reads its topics"
        if words is DIFF
        else "P-ERR-26155 recording {}: holds no attachment machine.yaml; nothing was computed, record it with cnc_ptp"
    )
    assert told(other) == without.format(other)
    text = tmp_path / "text.mcap"
    text.write_text("no recording, but long enough for one")
    assert told(text).startswith(f"P-ERR-26002 recording {text}: not an MCAP file: ")
    missing = tmp_path / "missing.mcap"
    assert told(missing).startswith(f"P-ERR-26001 recording {missing}")


@pytest.mark.parametrize("option", ["--program", "--commands"])
def test_inputs_that_cannot_be_read(option: str, recorded: Path, tmp_path: Path) -> None:
    new = tmp_path / "new.mcap"
    assert last_line(call("replay", recorded, option, tmp_path / "none", "-o", new)).startswith("P-ERR-26110 ")
    assert not new.exists()
