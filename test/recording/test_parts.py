"""Recordings in parts, compression, and what files say of themselves. rosbags is the reader of another hand."""

import pkgutil
import shutil
import subprocess

import numpy as np
import pytest
import yaml
from click.testing import CliRunner
from long_support import long
from machine_support import PTP, ROOT
from mcap.reader import make_reader
from recording_support import MACHINE, Blocks, foreign_file, record
from rosbags.rosbag2 import Reader
from small_disk import small_disk

import cnc_ptp.recording
from cnc_ptp.cli import main
from cnc_ptp.commands.run.replay import replay_blocks
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import build_units, unit_kinds
from cnc_ptp.parameters import machine_text
from cnc_ptp.plc.scenario import parse_scenario
from cnc_ptp.protocol.blocks import CycleTick, PlcBlock
from cnc_ptp.recording.closing import close_cut_recording
from cnc_ptp.recording.mcap_index import McapIndex
from cnc_ptp.recording.offline_run import OfflineRun
from cnc_ptp.recording.origin import origin, revision
from cnc_ptp.recording.reader import STATE_TYPES, iter_messages, read_recording
from cnc_ptp.recording.recovery import recover
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.settings import Settings, Split, read_split
from cnc_ptp.recording.verify import verify
from cnc_ptp.recording.what_if import Change, WhatIf
from cnc_ptp.recording.writer import Recording

PTP_FILE = ROOT / "config" / "ptp.yaml"
SCENARIO = "- {at: 0.0, to: x, do: move_absolute, target: 300, velocity: 100}\n"


def run(path, settings, seconds=3.5, checkpoints=10.0):
    """The same run each time."""
    entries = parse_scenario(SCENARIO, "test.yaml", unit_kinds(PTP))
    units = build_units(PTP, scenario=entries, end_when_idle=False)
    text = machine_text(PTP_FILE)
    record = str(path)
    with OfflineRun(
        PTP, units, record=record, machine_text=text, settings=settings, checkpoint_seconds=checkpoints
    ) as offline:
        for _ in offline.run(cycles=round(seconds * 1000)):
            pass
    return path


def states_of(path):
    return {
        topic: rows[np.argsort(rows["cycle"], kind="stable")] for topic, rows in read_recording(path).states.items()
    }


def equal(one, other):
    assert one.keys() == other.keys()
    return all(
        rows[name].tobytes() == other[topic][name].tobytes()  # bytes between fields are of no meaning
        for topic, rows in one.items()
        for name in rows.dtype.names
    )


def test_plot_takes_the_file_that_describes_the_parts(parts, tmp_path):
    words = ["plot", str(parts / "metadata.yaml"), "x/set_velocity", "-o", str(tmp_path / "a.svg")]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 0 and (tmp_path / "a.svg").exists(), result.output


def refusal(call, *arguments):
    with pytest.raises(CncError) as refused:
        call(*arguments)
    return str(refused.value)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return run(tmp_path_factory.mktemp("whole") / "run.mcap", Settings())


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    return run(tmp_path_factory.mktemp("parts") / "run", Settings(split=Split(seconds=1.0)))


@pytest.fixture
def copy(parts, tmp_path):
    """Of the parts, to be damaged."""
    return shutil.copytree(parts, tmp_path / "run")


def test_parts_of_a_time_are_one_recording_for_us(whole, parts):
    assert sorted(path.name for path in parts.iterdir()) == [
        "metadata.yaml",
        *(f"run_{number}.mcap" for number in range(4)),
    ]
    assert equal(states_of(whole), states_of(parts))
    for path in (parts, parts / "metadata.yaml"):
        result = verify(read_recording(path), replay_blocks)
        assert result.equal and result.compared == 4 * 3500
    topic = ["/x/block"]
    assert [(m.log_time_ns, m.cdr) for m in iter_messages(parts, topic)] == [
        (m.log_time_ns, m.cdr) for m in iter_messages(whole, topic)
    ]
    with cnc_ptp.recording.open(parts) as of_parts, cnc_ptp.recording.open(whole) as of_whole:
        columns = of_parts.columns("/x/state", "cycle", "set_position", start=0.95, end=2.05)
        expected = of_whole.columns("/x/state", "cycle", "set_position", start=0.95, end=2.05)
        assert all((columns[name] == expected[name]).all() for name in columns)
        assert of_parts.metadata["start_ns"] == of_whole.metadata["start_ns"]


def test_parts_are_one_bag_for_others(whole, parts):
    with Reader(parts) as bag, Reader(whole.parent) as expected:
        assert bag.message_count == expected.message_count == sum(1 for _ in bag.messages())
        assert (bag.start_time, bag.end_time) == (expected.start_time, expected.end_time)
        found = {connection.topic: connection.msgcount for connection in bag.connections}
        assert found == {connection.topic: connection.msgcount for connection in expected.connections}
        assert all(connection.ext.offered_qos_profiles for connection in bag.connections)


def test_each_part_is_a_recording_and_a_bag(parts):
    for number in range(4):
        part = parts / f"run_{number}.mcap"
        recorded = read_recording(part)
        assert recorded.complete and recorded.machine_yaml
        first = int(recorded.states["/x/state"]["cycle"].min())
        assert first == 1000 * number
        with Reader(part) as bag:
            assert bag.message_count == sum(1 for _ in bag.messages())


def test_metadata_of_parts_is_that_of_rosbag2(parts):
    metadata = yaml.safe_load((parts / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    files = [f"run_{number}.mcap" for number in range(4)]
    assert metadata["version"] == 9 and metadata["storage_identifier"] == "mcap"
    assert metadata["relative_file_paths"] == files == [entry["path"] for entry in metadata["files"]]
    assert metadata["message_count"] == sum(entry["message_count"] for entry in metadata["files"])
    for entry in metadata["files"]:
        with (parts / entry["path"]).open("rb") as stream:
            statistics = make_reader(stream).get_summary().statistics
        assert entry["message_count"] == statistics.message_count
        assert entry["starting_time"]["nanoseconds_since_epoch"] == statistics.message_start_time
        span = statistics.message_end_time - statistics.message_start_time
        assert entry["duration"]["nanoseconds"] == span


def test_a_run_begins_again_at_a_checkpoint_in_any_part(tmp_path):
    split = run(tmp_path / "split", Settings(split=Split(seconds=1.0)), checkpoints=0.8)
    one = run(tmp_path / "one.mcap", Settings(), checkpoints=0.8)
    with RunInputs(split) as parts, RunInputs(one) as whole:
        assert parts.checkpoints == whole.checkpoints == [800, 1600, 2400, 3200]
        assert [read() for read in parts.states_before(parts.end)] == [
            read() for read in whole.states_before(whole.end)
        ]
        assert (parts.commands, parts.end, parts.machine_yaml) == (whole.commands, 3500, whole.machine_yaml)
        assert parts.checkpoint_texts() == whole.checkpoint_texts()
        assert sorted(parts.messages(STATE_TYPES)) == sorted(whole.messages(STATE_TYPES))
    recorded = states_of(one)["/x/state"]
    with RunInputs(split) as parts:
        what_if = WhatIf(parts, Change(begin=2.5))
        blocks = [outputs["x"].block for outputs in what_if.run()]
    assert "checkpoint at 2.4 s" in what_if.note
    positions = np.concatenate([np.asarray(block.set_position) for block in blocks])
    assert positions.tobytes() == recorded["set_position"][2500:].tobytes()


def test_parts_of_a_size(whole, tmp_path):
    path = run(tmp_path / "run", Settings(split=Split(size=200e3)))
    sizes = [part.stat().st_size for part in sorted(path.glob("*.mcap"))]
    assert len(sizes) > 1 and all(size > 200e3 for size in sizes[:-1])
    assert equal(states_of(whole), states_of(path))


def test_parts_of_an_older_recording_are_replaced_and_nothing_else(tmp_path):
    path = run(tmp_path / "run", Settings(split=Split(seconds=1.0)))
    (path / "notes.txt").write_text("mine")
    run(path, Settings(split=Split(seconds=1.0)), seconds=1.5)
    assert sorted(file.name for file in path.iterdir()) == ["metadata.yaml", "notes.txt", "run_0.mcap", "run_1.mcap"]
    assert read_recording(path).last_cycle == 1499


def test_a_recording_whose_recorder_was_killed_is_whole_up_to_its_last_chunk(copy):
    with Reader(copy) as bag:
        before = bag.message_count
    last = copy / "run_3.mcap"
    last.write_bytes(last.read_bytes()[:-3000])
    text = yaml.safe_load((copy / "metadata.yaml").read_text())  # it lists the parts that were closed
    information = text["rosbag2_bagfile_information"]
    information["files"].pop()
    information["relative_file_paths"].pop()
    (copy / "metadata.yaml").write_text(yaml.safe_dump(text))
    recorded = read_recording(copy)
    assert not recorded.complete and "without having been closed" in recorded.missing
    assert recorded.last_cycle >= 2999
    assert verify(recorded, replay_blocks).equal
    missing = close_cut_recording(copy)
    assert missing == recorded.missing
    with Reader(copy) as bag:
        assert 0 < bag.message_count == sum(1 for _ in bag.messages()) <= before
    described = yaml.safe_load((copy / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert len(described["files"]) == 4
    (copy / "metadata.yaml").unlink()
    assert read_recording(copy).last_cycle == recorded.last_cycle


def test_folders_that_hold_no_recording_are_refused(tmp_path, copy):
    for call in (read_recording, cnc_ptp.recording.open):
        assert refusal(call, tmp_path) == (
            f"P-ERR-26014 recording {tmp_path}: a folder without a metadata.yaml of rosbag2; nothing was read, give a file "
            "of the folder"
        )


@pytest.mark.parametrize("described", [True, False])
def test_a_part_that_is_missing_is_named(copy, described):
    (copy / "run_1.mcap").unlink()
    if not described:
        (copy / "metadata.yaml").unlink()
    for call in (read_recording, cnc_ptp.recording.open, RunInputs):
        for given in [copy, copy / "metadata.yaml"][: 1 + described]:
            assert refusal(call, given) == (
                f"P-ERR-26001 recording {copy}: its part run_1.mcap is not there; nothing was read, put it back, or "
                "'cnc_ptp recover' makes a recording of the others"
            )
    text = f"recording {copy / 'run_1.mcap'}: cannot be opened: No such file or directory"
    assert f"lost: run_1.mcap: {text}" in recovered(copy, copy.with_name("saved"))[1]
    assert read_recording(copy.with_name("saved")).missing == "run_1.mcap is missing"


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    file = tmp_path / "file"
    file.write_text("good")
    for path, reason in ((file, "File exists"), (file / "run", "Not a directory")):
        assert refusal(lambda path=path: Recording(path, MACHINE, settings=Settings(split=Split(seconds=1.0)))) == (
            f"P-ERR-26020 recording {path}: no folder for its parts: {reason}; nothing is recorded"
        )
    assert file.read_text() == "good"


def recovered(folder, output):
    result = CliRunner().invoke(main, ["recover", str(folder), "-o", str(output)])
    return result.exit_code, result.output.splitlines()


def test_a_folder_of_parts_is_recovered_part_by_part(parts, copy, tmp_path):
    """The first part has a damaged chunk, the second is no recording, the third is missing, the last was cut."""
    output = tmp_path / "saved"
    index = McapIndex(copy / "run_0.mcap")
    place = index.chunks[-1]
    index.close()
    data = bytearray((copy / "run_0.mcap").read_bytes())
    data[place.offset + place.length // 2] ^= 0x55
    (copy / "run_0.mcap").write_bytes(data)
    (copy / "run_1.mcap").write_bytes(b"")
    (copy / "run_2.mcap").unlink()
    last = copy / "run_3.mcap"
    last.write_bytes(last.read_bytes()[:-50_000])
    status, [first, *lost] = recovered(copy / "metadata.yaml", output)
    assert status == 0 and first.startswith(f"{output}: ") and len(lost) == 4
    assert lost[0] == (f"lost: run_1.mcap: recording {copy / 'run_1.mcap'}: not an MCAP file: it is empty")
    assert lost[1] == f"lost: run_2.mcap: recording {copy / 'run_2.mcap'}: cannot be opened: No such file or directory"
    assert lost[2].startswith("lost: run_0.mcap: at offset ") and lost[3].startswith("lost: run_3.mcap: nothing whole ")
    assert sorted(file.name for file in output.iterdir()) == ["metadata.yaml", "saved_0.mcap", "saved_1.mcap"]
    saved = read_recording(output)
    assert saved.machine_yaml and not saved.complete and saved.last_cycle > 3000
    assert first.endswith(f" messages, 0 s to {saved.last_cycle / 1000:g} s")
    with Reader(output) as bag:
        assert bag.message_count == sum(1 for _ in bag.messages()) == int(first.split()[1])
    assert sorted(file.name for file in copy.iterdir()) == ["metadata.yaml", "run_0.mcap", "run_1.mcap", "run_3.mcap"]


def test_whole_parts_are_recovered_as_they_are(parts, tmp_path):
    assert recovered(parts, tmp_path / "saved")[1] == [
        f"{tmp_path / 'saved'}: {sum(1 for _ in iter_messages(parts))} messages, 0 s to 3.499 s"
    ]
    assert equal(states_of(parts), states_of(tmp_path / "saved"))
    assert verify(read_recording(tmp_path / "saved"), replay_blocks).equal


def test_parts_are_not_recovered_into_themselves_and_not_without_one_that_is_readable(copy, tmp_path):
    for source in (copy, copy / "metadata.yaml"):
        status, lines = recovered(source, copy)
        assert status == 2 and f"would overwrite the recording {copy}" in " ".join(lines).replace("\n", "")
    assert len([*copy.glob("*.mcap")]) == 4
    for part in copy.glob("*.mcap"):
        part.write_bytes(b"")
    assert refusal(recover, copy, tmp_path / "saved").startswith(
        f"P-ERR-26002 recording {copy / 'run_3.mcap'}: not an "
    )
    assert not (tmp_path / "saved").exists()


def contents(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def saved_before(folder):
    """A folder of two parts, with a file that is none."""
    with Recording(folder, MACHINE, settings=Settings(split=Split(seconds=0.01)), chunk_seconds=0.01) as recording:
        for first in (0, 10):
            recording.tick(CycleTick(first, 10))
            recording.flush()
    (folder / "notes.txt").write_text("good")
    return contents(folder)


def test_parts_without_a_message_are_refused_like_a_file(tmp_path):
    empty, output = tmp_path / "empty", tmp_path / "saved"
    with Recording(empty, MACHINE, settings=Settings(split=Split(seconds=1.0))):
        pass
    before = saved_before(output)
    assert refusal(recover, empty, output) == (
        f"P-ERR-26224 recording {empty}: holds no message that can be saved; nothing was written"
    )
    assert refusal(recover, empty, tmp_path / "new") == (
        f"P-ERR-26224 recording {empty}: holds no message that can be saved; nothing was written"
    )
    assert contents(output) == before and sorted(each.name for each in tmp_path.iterdir()) == ["empty", "saved"]


def test_recovered_parts_take_the_place_of_former_ones(parts, tmp_path):
    output = tmp_path / "saved"
    saved_before(output)
    (tmp_path / "link").symlink_to(output)
    recover(parts, tmp_path / "link")
    assert equal(states_of(parts), states_of(output))
    assert sorted(contents(output)) == ["metadata.yaml", "notes.txt", *(f"saved_{n}.mcap" for n in range(4))]
    assert sorted(each.name for each in tmp_path.iterdir()) == ["link", "saved"]


@pytest.mark.parametrize("place", ["recovery._recover_file", "parts._move"])
@pytest.mark.parametrize("calls", [0, 3, *long([1])])
@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError(5, "Input/output error")], ids=repr)
def test_an_interruption_leaves_what_is_there(parts, tmp_path, monkeypatch, place, calls, error):
    output = tmp_path / "saved"
    before = saved_before(output)
    name = f"cnc_ptp.recording.{place}"
    inside, left = pkgutil.resolve_name(name.replace("._", ":_")), [None] * calls

    def broken(*arguments):
        if not left:
            raise error
        left.pop()
        return inside(*arguments)

    monkeypatch.setattr(name, broken)
    if error is KeyboardInterrupt:
        with pytest.raises(KeyboardInterrupt):
            recover(parts, output)
    else:
        assert refusal(recover, parts, output) == (
            f"P-ERR-26007 recording {output} cannot be written: Input/output error; nothing was written"
        )
    assert contents(output) == before
    assert [each.name for each in tmp_path.iterdir()] == ["saved"]


def test_a_disk_that_is_full_leaves_what_is_there(parts, tmp_path):
    with small_disk(tmp_path / "disk", 64) as disk:
        output = disk / "saved"
        before = saved_before(output)
        assert refusal(recover, parts, output) == (
            f"P-ERR-26007 recording {output} cannot be written: No space left on device; nothing was written"
        )
        assert contents(output) == before and [each.name for each in disk.iterdir()] == ["saved"]
    lacks = f"there is no folder {tmp_path / 'none'}, make it or give another name"
    good = tmp_path / "good"
    good.write_text("good")
    for source, output, number, what, reason in (
        (parts, good, 26020, ": no folder for its parts", "File exists"),
        (parts, tmp_path / "none" / "saved", 26020, ": no folder for its parts", lacks),
        (parts / "run_0.mcap", tmp_path / "none" / "a.mcap", 26007, " cannot be written", lacks),
        (parts / "run_0.mcap", tmp_path / "disk", 26007, " cannot be written", "Is a directory"),
    ):
        text = f"P-ERR-{number} recording {output}{what}: {reason}; nothing was written"
        assert refusal(recover, source, output) == text
    assert good.read_text() == "good"


def test_parts_of_which_the_last_was_cut_at_any_byte(tmp_path):
    """The recorder was killed: the last part ends anywhere, the `metadata.yaml` lists the part before."""
    folder = tmp_path / "run"
    with Recording(folder, MACHINE, settings=Settings(split=Split(seconds=0.02)), chunk_seconds=0.01) as recording:
        for first in range(0, 50, 10):
            recording.tick(CycleTick(first, 10))
            recording.flush()
    names = sorted(path.name for path in folder.glob("*.mcap"))
    last, whole = folder / names[-1], (folder / names[-1]).read_bytes()
    before = sum(1 for _ in iter_messages(folder)) - sum(1 for _ in iter_messages(last))
    counts = []
    (folder / "metadata.yaml").unlink()
    for size in [0, 1, 7, *range(8, len(whole), 211), len(whole)]:
        last.write_bytes(whole[:size])
        counts.append(recover(folder, tmp_path / "saved").messages)
        assert sum(1 for _ in iter_messages(folder)) == counts[-1]
        close_cut_recording(folder)
        assert len(read_recording(folder).ticks) == counts[-1]
    assert counts == sorted(counts) and counts[0] == before and counts[-1] > before


@pytest.mark.parametrize(
    ("text", "split"),
    [("500MB", Split(size=5e8)), ("1.5 GiB", Split(size=1.5 * 2**30)), ("10min", Split(seconds=600.0)), ("2h", Split(seconds=7200.0))],
)  # fmt: skip
def test_splits_are_read(text, split):
    assert read_split(text) == split


@pytest.mark.parametrize("text", ["", "500", "MB", "5 apples", "-5s", "1e3s"])
def test_splits_without_a_unit_are_refused(text):
    assert refusal(read_split, text) == (
        f"P-ERR-26019 --split '{text}': it is not a number with one of the units KB, MB, GB, KiB, MiB, GiB, s, min, h, as "
        "500MB or 10min; nothing was started"
    )


def test_empty_parts_are_refused():
    assert refusal(read_split, "0MB") == (
        "P-ERR-26019 --split '0MB': a part must hold something, as 500MB or 10min; nothing was started"
    )


@pytest.mark.parametrize("compression", ["lz4", "none"])
def test_other_compressions_hold_the_same(tmp_path, compression):
    paths = [tmp_path / name for name in ("zstd.mcap", "other.mcap")]
    for path, kind in zip(paths, ("zstd", compression), strict=True):
        record(path, list(Blocks(7).machine(30)), settings=Settings(kind))
    assert [(m.topic, m.log_time_ns, m.cdr) for m in iter_messages(paths[0])] == [
        (m.topic, m.log_time_ns, m.cdr) for m in iter_messages(paths[1])
    ]
    with paths[1].open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        kinds = {chunk.compression for chunk in reader.get_summary().chunk_indexes}
        assert kinds == {"" if compression == "none" else compression}
        assert sum(1 for _ in reader.iter_messages()) == sum(1 for _ in iter_messages(paths[0]))


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="not a checkout")
def test_a_recording_says_what_it_was_made_by(whole):
    metadata = read_recording(whole).metadata
    assert metadata["format"] == "1"
    assert {name: metadata[name] for name in origin()} == origin()
    head = subprocess.run(["git", "-C", ROOT, "rev-parse", "HEAD"], capture_output=True, text=True).stdout.strip()
    assert metadata["revision"].removesuffix("-dirty") == head


def test_the_revision_of_an_installed_package_is_not_that_of_somebody_elses_checkout(tmp_path):
    (tmp_path / "site-packages").mkdir()
    assert revision(tmp_path / "site-packages") == ""
    (tmp_path / ".git").write_text("not a checkout")
    assert revision(tmp_path) == ""


def test_scenario_and_plc_file_are_in_the_recording(tmp_path):
    scenario, plc = tmp_path / "story.yaml", ROOT / "examples" / "plc_setpoint_generator.py"
    scenario.write_text(SCENARIO)
    for option, name, file in (("--scenario", "scenario.yaml", scenario), ("--plc", f"plc/{plc.name}", plc)):
        path = tmp_path / f"{file.stem}.mcap"
        words = ["simulate", str(PTP_FILE), option, str(file), "--duration", "0.1", "--record", str(path)]
        assert CliRunner().invoke(main, words).exit_code == 0
        assert read_recording(path).attachments == {name: file.read_text()}


def from_the_future(path, **metadata):
    with Recording(path, MACHINE, notes=metadata) as recording:
        recording.block("plc", PlcBlock(0, 10))
    return path


def test_a_recording_from_the_future_is_refused_by_every_command(tmp_path):
    path = from_the_future(tmp_path / "new.mcap", format="2", version="9.1")
    text = (
        f"P-ERR-26016 recording {path}: has format 2 of cnc_ptp 9.1, this version reads up to format 1; nothing was read, "
        "use a newer version of cnc_ptp"
    )
    assert refusal(read_recording, path) == text == refusal(cnc_ptp.recording.open, path)
    assert refusal(RunInputs, path) == text
    commands = (
        ["replay"],
        ["report", "-o", "page.html"],
        ["plot", "x/set_velocity", "-o", "a.svg"],
        ["export", "--topic", "x/state", "-o", "a.csv"],
    )
    for name, *words in commands:
        result = CliRunner().invoke(main, [name, str(path), *words])
        assert (result.exit_code, " ".join(result.stderr.split())) == (2, text), name
    other = from_the_future(tmp_path / "other.mcap", format="b")
    assert refusal(read_recording, other).startswith(
        f"P-ERR-26016 recording {other}: has format b, this version reads up"
    )


def test_a_run_that_lacks_commands_is_not_computed_with_changes(tmp_path):
    path = from_the_future(tmp_path / "late.mcap", not_computable="commands before cycle 10 are missing")
    text = (
        f"P-ERR-26018 recording {path}: commands before cycle 10 are missing; the run cannot be computed again, its "
        "states can be read and drawn"
    )
    assert refusal(RunInputs, path) == text


def test_recordings_without_a_format_are_the_oldest(tmp_path):
    path = from_the_future(tmp_path / "old.mcap", format="0")
    assert read_recording(path).complete


def test_topics_of_other_programs_are_read(tmp_path):
    path = foreign_file(tmp_path / "foreign.mcap")
    with cnc_ptp.recording.open(path) as opened:
        assert opened.columns("/point")["x"].tolist() == [number / 2 for number in range(20)]
    table = tmp_path / "point.csv"
    result = CliRunner().invoke(main, ["export", str(path), "--topic", "/point", "-o", str(table)])
    assert result.exit_code == 0 and table.read_text().splitlines()[:2] == ["time,x,y,z", "0.0,0.0,1.0,0.0"]
