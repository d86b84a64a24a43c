"""Two runs that cannot be compared, or not as a whole; parts of a run that cannot be computed again."""

from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from machine_support import ROOT
from mcap.writer import MCAP0_MAGIC

from cnc_ptp.cli import main
from cnc_ptp.errors import CncError
from cnc_ptp.recording.mcap_index import NOT_CLOSED, McapIndex
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.recovery import recover
from cnc_ptp.recording.run_difference import difference

PTP, MILL = ROOT / "config" / "ptp.yaml", ROOT / "config" / "mill.yaml"
EQUAL = "both runs are equal to the bit in the columns that are compared"


def call(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def words(result: Result) -> str:
    assert result.exit_code == 2, result.output
    return " ".join(result.stderr.split())


def simulated(path: Path, *options: object, machine: Path = PTP, duration: float = 3.0) -> Path:
    result = call("simulate", machine, "--duration", duration, "--record", path, *options)
    assert result.exit_code == 0, result.output
    return path


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return simulated(tmp_path_factory.mktemp("split") / "run", "--split", "1s")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return simulated(tmp_path_factory.mktemp("whole") / "run.mcap")


def test_a_folder_is_compared_with_a_file(parts: Path, whole: Path, tmp_path: Path) -> None:
    assert call("diff", parts, whole).output.splitlines() == ["compared from 0 s to 2.999 s", EQUAL]
    result = call("report", whole, "--compare", parts, "-o", tmp_path / "a.html")
    assert result.exit_code == 0, result.output


def test_nothing_in_common_is_not_equal(parts: Path, whole: Path) -> None:
    first, last = parts / "run_0.mcap", parts / "run_2.mcap"
    assert words(call("diff", first, last)) == (
        f"P-ERR-26022 the recordings have no cycle in common: {first} covers 0 s to 0.999 s and {last} covers 2 s to "
        "2.999 s; nothing was compared"
    )
    assert words(call("diff", whole, whole, "--from", 100, "--to", 200)) == (
        f"P-ERR-26022 the recordings have no cycle in common from 100 s to 200 s: {whole} covers 0 s to 2.999 s and "
        f"{whole} covers 0 s to 2.999 s; nothing was compared"
    )


def test_a_cut_or_shorter_file_is_named(whole: Path, tmp_path: Path) -> None:
    cut, table = tmp_path / "cut.mcap", tmp_path / "x.csv"
    cut.write_bytes(whole.read_bytes()[:-4000])
    lines = call("diff", whole, cut).output.splitlines()
    assert lines[1] == f"note: {cut}: {NOT_CLOSED}" and lines[-1] == EQUAL
    result = call("export", cut, "--topic", "x/state", "-o", table)
    assert result.output.splitlines()[1] == f"note: {NOT_CLOSED}"
    assert f"note: {NOT_CLOSED}" in call("replay", cut, "--from", 1).output.splitlines()
    short = simulated(tmp_path / "short.mcap", duration=2.0)
    assert call("diff", whole, short).output.splitlines() == [
        "compared from 0 s to 1.999 s",
        f"note: {whole} ends at 2.999 s, {short} ends at 1.999 s: what only one has was not compared",
        EQUAL,
    ]


def test_a_file_that_was_cut_before_its_first_state(whole: Path, tmp_path: Path) -> None:
    index = McapIndex(whole)
    first = next(chunk for chunk in index.chunks if index.ids_of("/x/state") <= set(chunk.channels))
    index.close()
    cut, page = tmp_path / "cut.mcap", tmp_path / "a.html"
    cut.write_bytes(whole.read_bytes()[: first.offset])
    nothing = f"P-ERR-26011 recording {cut}: holds no states; nothing was"
    assert words(call("report", cut, "-o", page)) == f"{nothing} drawn"
    assert words(call("report", whole, "--compare", cut, "-o", page)) == f"{nothing} drawn"
    assert words(call("plot", cut)) == f"{nothing} drawn"
    again = tmp_path / "again.mcap"
    assert words(call("replay", cut, "--override", 50, "-o", again)) == (
        f"P-ERR-26011 recording {cut}: holds no states; nothing was computed; --to says until when"
    )
    assert words(call("replay", cut, "--override", 50, "--to", 1)) == (
        f"P-ERR-26011 recording {cut}: holds no states to compare with; nothing was computed; give --to and --output alone"
    )
    assert words(call("replay", cut, "--from", 1, "--to", 2, "-o", again)) == (
        "P-ERR-26154 --from 1 is not possible: the recording holds no states, the run begins at 0; nothing was computed"
    )
    assert not again.exists()
    assert words(call("diff", whole, cut)) == (
        f"P-ERR-26022 the recordings have no cycle in common: {whole} covers 0 s to 2.999 s and {cut} holds no states; "
        "nothing was compared"
    )
    assert not page.exists()


def test_units_that_only_one_has_are_named(whole: Path, tmp_path: Path) -> None:
    index = McapIndex(whole)
    first, second = [chunk for chunk in index.chunks if index.ids_of("/x/state") <= set(chunk.channels)][:2]
    index.close()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: first.offset + first.length])
    assert list(difference(whole, cut).notes)[2:] == ["y, z, c: no states that both have, so not compared"]
    cut.write_bytes(whole.read_bytes()[: second.offset + second.length])
    assert list(difference(whole, cut).notes)[2:] == [
        f"{unit}: compared from 0 s to 0.999 s alone" for unit in ("y", "z", "c")
    ]


def test_a_cut_file_has_one_end(whole: Path, tmp_path: Path) -> None:
    """Of its last second only the ticks are whole: no state of it is there."""
    index = McapIndex(whole)
    [ticks] = [chunk for chunk in index.chunks if index.ids_of("/clock/tick") <= set(chunk.channels)][2:]
    index.close()
    cut, page, second = tmp_path / "cut.mcap", tmp_path / "a.html", "0 s to 1.999 s"
    cut.write_bytes(whole.read_bytes()[: ticks.offset + ticks.length])
    assert list(difference(whole, cut).notes) == [
        f"{cut}: {NOT_CLOSED}",
        f"{whole} ends at 2.999 s, {cut} ends at 1.999 s: what only one has was not compared",
    ]
    assert words(call("diff", cut, cut, "--from", 2)) == (
        f"P-ERR-26022 the recordings have no cycle in common from 2 s to the end: {cut} covers {second} and "
        f"{cut} covers {second}; nothing was compared"
    )
    assert words(call("report", cut, "--from", 2, "-o", page)) == (
        f"P-ERR-26011 recording {cut}: nothing from 2 s to the end, it covers {second}; nothing was drawn"
    )
    assert words(call("export", cut, "--topic", "x/state", "--from", 2, "-o", tmp_path / "x.csv")) == (
        f"P-ERR-26011 recording {cut}: holds nothing of /x/state from 2 s to the end, it covers {second}; nothing was read"
    )
    assert words(call("replay", cut, "--from", 2.5)) == (
        "P-ERR-26154 --from 2.5 is not within the recorded time 0 ... 2 s; nothing was computed"
    )
    assert words(call("replay", cut, "--from", 2)) == (
        f"P-ERR-26022 the recordings have no cycle in common: {cut} covers {second} and changed holds no states; "
        "nothing was compared"
    )
    lines = call("replay", cut, "--from", 1, "--to", 3).output.splitlines()
    assert "compared from 1 s to 1.999 s" in lines and f"note: {cut}: {NOT_CLOSED}" in lines


def test_programs_that_have_not_ended_are_named(tmp_path: Path) -> None:
    program = tmp_path / "part.nc"
    program.write_text("N10 G01 X10 F600\nM30\n")
    ended, cut = (
        simulated(tmp_path / f"{name}.mcap", "--program", program, machine=MILL, duration=duration)
        for name, duration in (("ended", 5.0), ("cut", 0.7))
    )
    so_far = "the program of channel has not ended there in {}: its time is that so far"
    assert difference(ended, cut).notes[1:] == [so_far.format(cut)]
    both = difference(ended, cut, end=0.5, names=("A", "B"))
    assert both.notes == [so_far.format("A and B")]
    assert both.program_times["channel"][0] == both.program_times["channel"][1] > 0.4
    assert difference(ended, ended).notes == []


def test_notes_and_errors_name_a_run_as_they_are_told(whole: Path, parts: Path) -> None:
    part, names = parts / "run_0.mcap", ("run", "changed")
    assert difference(whole, part, names=names).notes == [
        "run ends at 2.999 s, changed ends at 0.999 s: what only one has was not compared"
    ]
    with pytest.raises(CncError, match=r"run covers 0 s to 2\.999 s and changed covers 0 s to 0\.999 s; nothing was"):
        difference(whole, part, begin=1, names=names)


def test_a_shorter_what_if_is_compared_to_its_end(whole: Path) -> None:
    lines = call("replay", whole, "--from", 1, "--to", 2).output.splitlines()
    assert not [line for line in lines if "ends at" in line] and lines[-1] == EQUAL


def test_machines_with_other_kinds_of_units(whole: Path, tmp_path: Path) -> None:
    machine = tmp_path / "rotary.yaml"
    x, y, rest = PTP.read_text().split("ACHSTYP_TRANSLATOR", 2)
    machine.write_text(f"{x}ACHSTYP_TRANSLATOR{y}ACHSTYP_ROTATOR{rest}")
    changed = simulated(tmp_path / "other.mcap", machine=machine, duration=0.1)
    with pytest.raises(CncError) as refused:
        difference(whole, changed)
    assert str(refused.value).startswith("P-ERR-26158 the recordings are of different machines: ")
    assert "y (linear axis)" in str(refused.value) and "y (rotary axis)" in str(refused.value)


def test_a_later_part_alone_is_not_computed(parts: Path, tmp_path: Path) -> None:
    part = parts / "run_2.mcap"
    remedy = "the run cannot be computed again, its states can be read and drawn"
    text = f"P-ERR-26018 recording {part}: part 0 of the run is not there; {remedy}"
    assert words(call("replay", part)) == text == words(call("replay", part, "--from", 2.1))
    assert call("export", part, "--topic", "x/state", "-o", tmp_path / "x.csv").exit_code == 0
    assert call("replay", parts / "run_0.mcap").exit_code == 0
    assert call("replay", parts).exit_code == 0


def test_a_recovered_folder_says_which_parts_it_lacks(parts: Path, tmp_path: Path) -> None:
    source = tmp_path / "run"
    source.mkdir()
    for file in parts.iterdir():
        (source / file.name).write_bytes(file.read_bytes())
    (source / "run_1.mcap").unlink()
    recover(source, tmp_path / "saved")
    recorded = read_recording(tmp_path / "saved")
    assert (recorded.complete, recorded.missing) == (False, "run_1.mcap is missing")
    assert words(call("replay", tmp_path / "saved")) == (
        f"P-ERR-26018 recording {tmp_path / 'saved'}: what was before it is lost: run_1.mcap; the run cannot be computed "
        "again, its states can be read and drawn"
    )
    (source / "run_2.mcap").write_bytes(b"")
    (source / "run_1.mcap").write_bytes((parts / "run_1.mcap").read_bytes())
    recover(source, tmp_path / "begin")
    assert read_recording(tmp_path / "begin").missing == "run_2.mcap is missing"
    assert call("replay", tmp_path / "begin").exit_code == 0


def test_a_refused_change_leaves_the_former_output(whole: Path, tmp_path: Path) -> None:
    output = tmp_path / "good.mcap"
    output.write_bytes(MCAP0_MAGIC + b"good")
    result = call("replay", whole, "--from", 1, "--set", "machine.cycle_time_us=2000", "-o", output)
    assert "P-ERR-26156 " in words(result) and output.read_bytes() == MCAP0_MAGIC + b"good"
