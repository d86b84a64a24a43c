"""Recordings that begin and end while a machine runs, and snapshots: each can be computed again to the bit."""

import math
import resource
from functools import partial

import pytest
from machine_support import PTP, ROOT, MachineBench
from rosbags.rosbag2 import Reader

from cnc_ptp.commands.run.replay import replay_blocks
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.parameters import machine_text
from cnc_ptp.protocol.blocks import CommandRecord, CycleTick, Event, EventValue, Severity, json_of
from cnc_ptp.recording.closing import close_cut
from cnc_ptp.recording.mcap_chunks import NOTHING_LEFT
from cnc_ptp.recording.mcap_file import NOT_WRITTEN
from cnc_ptp.recording.memory import BATCH, OBJECT, History, LastSeconds
from cnc_ptp.recording.on_demand import OnDemand, Snapshots
from cnc_ptp.recording.origin import RECORD_WHEN, WITHOUT
from cnc_ptp.recording.reader import iter_messages, read_recording
from cnc_ptp.recording.recovery import recover
from cnc_ptp.recording.settings import Settings, Split
from cnc_ptp.recording.trigger import Condition
from cnc_ptp.recording.verify import verify
from cnc_ptp.wire.block_codec import codec_of
from cnc_ptp.wire.stamps import Stamps

KINDS = unit_kinds(PTP)
MACHINE_TEXT = machine_text(ROOT / "config" / "ptp.yaml")
SCENARIO = """
- {at: 0.0, to: x, do: reset}
- {at: 0.1, to: x, do: move_absolute, target: 400, velocity: 200}
- {at: 0.9, to: x, do: set_override, percent: 60}
- {at: 1.5, to: x, do: move_absolute, target: -100, velocity: 150}
"""


class Story:
    """A machine offline whose recorder gets blocks and commands as a graph delivers them: x and commands come late."""

    def __init__(self, *, keep=0.0, folder=None, when=None, first_cycle=0, settings=None):
        self.bench = MachineBench(scenario=SCENARIO, machine=PTP, end_when_idle=False)
        self.published, self.answers = [], []
        self.now = 100.0
        self.recorder = OnDemand(
            MACHINE_TEXT,
            Stamps(0, 1_000_000),
            KINDS,
            first_cycle=first_cycle,
            settings=settings or Settings(),
            snapshots=Snapshots(keep, folder, when),
            publish=self.published.append,
        )
        self._late = []

    def run(self, seconds):
        for _ in range(round(seconds * 100)):
            self._block()
        return self

    def _block(self):
        outputs = self.bench.offline.tick()
        plc = outputs["plc"].block
        self.recorder.tick(CycleTick(plc.first_cycle, plc.count))
        late, self._late = self._late, []
        for take in late:
            take()
        for name, output in outputs.items():
            data = codec_of(type(output.block)).encode(output.block, self.recorder.stamps)
            take = partial(self.recorder.encoded_block, name, type(output.block), data)
            if name == "x":
                self._late.append(take)
            else:
                take()
            self._late += [partial(self.recorder.command, record) for record in output.records]
            self._late += [partial(self.recorder.event, event) for event in output.events]
        self.now += 0.01
        self.recorder.flush_if_due(self.now)

    def stop(self):
        self.recorder.stop(self.answers.append)
        return self

    def snapshot(self, file, seconds=0.0, until=0.0):
        self.recorder.snapshot(str(file), seconds, until, self.answers.append)
        return self

    def refused(self, call, *arguments):
        with pytest.raises(CncError) as refusal:
            call(*arguments)
        return str(refusal.value)


def computed_again(path):
    """The recording, whose states are equal to a second computation; first and last cycle of all units are the same."""
    recorded = read_recording(path)
    result = verify(recorded, replay_blocks)
    assert result.equal, result.text()
    spans = {(int(rows["cycle"].min()), int(rows["cycle"].max())) for rows in recorded.states.values()}
    assert len(spans) == 1
    assert all(len(rows) == rows["cycle"].max() - rows["cycle"].min() + 1 for rows in recorded.states.values())
    return recorded, *spans.pop()


def test_a_recording_begins_and_ends_while_the_machine_moves(tmp_path):
    story = Story().run(0.5)
    answer = story.recorder.start(str(tmp_path / "a.mcap"))
    story.run(1.2).stop().run(0.1)
    assert story.answers == [] and story.recorder.current is not None  # its last commands may still come
    story.run(0.3)
    assert (answer.cycle, [answer.cycle for answer in story.answers]) == (500, [1700])
    recorded, first, last = computed_again(tmp_path / "a.mcap")
    assert (first, last) == (500, 1699)
    assert recorded.metadata[RECORD_WHEN] == "asked for, from cycle 500 on"
    assert [record.command for record in recorded.commands] == [
        "reset",
        "move_absolute",
        "set_override",
        "move_absolute",
    ]
    with Reader(tmp_path / "a.mcap") as bag:
        assert {each.topic: each.msgcount for each in bag.connections}["/x/state"] == 1200
    assert story.recorder.start(str(tmp_path / "b.mcap")).cycle == 2100
    story.run(0.2)
    story.recorder.close()
    assert read_recording(tmp_path / "b.mcap").complete


def test_a_snapshot_has_the_last_seconds(tmp_path):
    story = Story(keep=1.0).run(2.0)
    story.snapshot(tmp_path / "a.mcap").run(0.1).snapshot(tmp_path / "b.mcap", 0.25).run(1.0)
    story.recorder.close()
    assert [(answer.cycle, answer.warning) for answer in story.answers] == [(1000, ""), (1850, "")]
    recorded, first, last = computed_again(tmp_path / "a.mcap")
    assert (first, last, recorded.metadata[RECORD_WHEN]) == (1000, 1999, "snapshot of cycles 1000 to 1999")
    assert computed_again(tmp_path / "b.mcap")[1:] == (1850, 2099)


def test_a_snapshot_of_more_than_is_kept_says_so(tmp_path):
    story = Story(keep=10.0).run(0.5).snapshot(tmp_path / "a.mcap", 3.0).run(0.5)
    story.recorder.close()
    [answer] = story.answers
    assert answer.warning == "recorder: 0.5 s were kept and are in the snapshot, 3 s were asked for"
    assert computed_again(tmp_path / "a.mcap")[1:] == (0, 499)


def test_a_snapshot_ends_where_it_is_told_to(tmp_path):
    """Its window is 1.3 s to 1.605 s; blocks have 10 cycles."""
    story = Story(keep=2.0).run(2.0)
    for cycle in (1600, 1609, 1610):
        story.recorder.event(Event(cycle, "x", Severity.INFO, 0, "an event"))
    story.snapshot(tmp_path / "a.mcap", 0.305, 1.605).run(0.5)
    story.recorder.close()
    assert [(answer.cycle, answer.warning, answer.error) for answer in story.answers] == [(1300, "", None)]
    recorded, first, last = computed_again(tmp_path / "a.mcap")
    assert (first, last, recorded.metadata[RECORD_WHEN]) == (1300, 1609, "snapshot of cycles 1300 to 1609")
    assert recorded.complete
    assert [record.command for record in recorded.commands] == [
        "reset",
        "move_absolute",
        "set_override",
        "move_absolute",
    ]
    assert [event.cycle for event in recorded.events if event.text == "an event"] == [1600, 1609]


def test_a_snapshot_has_commands_up_to_its_end_only(tmp_path):
    Story(keep=2.0).run(2.0).snapshot(tmp_path / "a.mcap", until=1.5).run(0.5).recorder.close()
    recorded, first, last = computed_again(tmp_path / "a.mcap")
    assert (first, last, [record.command for record in recorded.commands]) == (
        0,
        1499,
        ["reset", "move_absolute", "set_override"],
    )


def test_a_snapshot_until_a_time_of_which_a_block_is_late_waits_for_it(tmp_path):
    story = Story(keep=2.0).run(1.0).snapshot(tmp_path / "a.mcap", 0.1, 0.995)  # the last block of x is late
    story.run(0.5)
    story.recorder.close()
    assert computed_again(tmp_path / "a.mcap")[1:] == (890, 999)


@pytest.mark.parametrize("until", [0.0, math.nan])
def test_without_an_end_a_snapshot_ends_now(tmp_path, until):
    story = Story(keep=1.0).run(2.0).snapshot(tmp_path / "a.mcap", 0.5, until).run(0.5)
    story.recorder.close()
    assert computed_again(tmp_path / "a.mcap")[1:] == (1500, 1999)


@pytest.mark.parametrize("until", [-1.0, 0.9, 0.99, 3.001, 1e9, math.inf, -math.inf])
def test_an_end_of_which_nothing_is_kept_is_refused(tmp_path, until):
    story = Story(keep=1.0).run(3.0)  # it keeps a second and a block more
    assert story.refused(story.snapshot, tmp_path / "a.mcap", 0.5, until) == (
        f"P-ERR-26197 recorder: snapshot refused: until = {until:.10g} is not within 0.991 ... 3 s, which are kept; "
        "nothing was changed"
    )
    assert not [*tmp_path.iterdir()]


def test_an_end_whose_cycles_are_forgotten_meanwhile_is_refused(tmp_path):
    story = Story(keep=1.0).run(3.0).snapshot(tmp_path / "a.mcap", 0.5, 1.05).run(0.5)
    story.recorder.close()
    assert [str(answer.error) for answer in story.answers] == [
        "P-ERR-26197 recorder: snapshot refused: until = 1.05 is not within 1.201 ... 3.21 s, which are kept; "
        "nothing was changed"
    ]
    assert not [*tmp_path.iterdir()]


def test_a_snapshot_is_taken_of_what_led_to_an_error(tmp_path):
    story = Story(keep=0.5, folder=tmp_path).run(1.0)
    story.recorder.event(Event(990, "x", Severity.ERROR, 23001, "x: stopped"))
    story.recorder.event(Event(995, "y", Severity.ERROR, 23001, "y: it is in the same snapshot"))
    story.recorder.event(Event(995, "recorder", Severity.ERROR, 26114, "recorder: its own ones do not count"))
    story.run(1.0)
    story.recorder.close()
    assert [path.name for path in sorted(tmp_path.glob("*.mcap"))] == ["error_990.mcap"]
    recorded, first, last = computed_again(tmp_path / "error_990.mcap")
    assert (first, last) == (490, 1489)
    assert "x: stopped" in [event.text for event in recorded.events]
    [event] = story.published
    text = f"recorder: snapshot {tmp_path / 'error_990.mcap'} has cycles from 490 on"
    assert (event.severity, event.error_id, event.text) == (Severity.INFO, 26194, text)


def test_a_snapshot_is_taken_when_a_condition_becomes_true(tmp_path):
    story = Story(keep=0.4, folder=tmp_path, when=Condition("x.set_position > 100", KINDS)).run(3.0)
    story.recorder.close()
    [path] = tmp_path.glob("trigger_*.mcap")
    recorded, first, last = computed_again(path)
    states = recorded.states["/x/state"]
    crossing = int(states["cycle"][states["set_position"] > 100.0][0])
    assert first < crossing - 380 and crossing + 480 < last


def test_an_own_snapshot_that_fails_is_an_event(tmp_path):
    folder = tmp_path / "snaps"
    folder.mkdir()
    story = Story(keep=0.5, folder=folder).run(1.0)
    folder.rmdir()
    story.recorder.event(Event(990, "x", Severity.ERROR, 23001, "x: stopped"))
    story.run(1.0)
    story.recorder.close()
    [event] = story.published
    assert (event.severity, event.error_id) == (Severity.WARNING, 26195)
    assert event.text == (
        f"recorder: snapshot {folder / 'error_990.mcap'} was not taken: recording {folder / 'error_990.mcap'} cannot be "
        f"written: there is no folder {folder}, make it or give another name; the run continues"
    )


def test_names_of_own_snapshots_are_free_ones(tmp_path):
    (tmp_path / "error_990.mcap").write_text("of another run")
    story = Story(keep=0.5, folder=tmp_path).run(1.0)
    story.recorder.event(Event(990, "x", Severity.ERROR, 23001, "x: stopped"))
    story.run(1.0)
    story.recorder.close()
    assert (tmp_path / "error_990.mcap").read_text() == "of another run"
    assert computed_again(tmp_path / "error_990_1.mcap")


def test_start_while_recording_is_refused(tmp_path):
    story = Story().run(0.1)
    file = tmp_path / "a.mcap"
    story.recorder.start(str(file))
    assert story.refused(story.recorder.start, str(tmp_path / "b.mcap")) == (
        f"P-ERR-26190 recorder: start refused: recording {file} is being written; nothing was changed"
    )
    assert not (tmp_path / "b.mcap").exists()
    story.recorder.close()


def test_stop_without_a_recording_is_refused(tmp_path):
    story = Story().run(0.1)
    text = "P-ERR-26191 recorder: stop refused: no recording is being written; nothing was changed"
    assert story.refused(story.stop) == text
    story.recorder.start(str(tmp_path / "a.mcap"))
    story.run(0.1).stop()
    text = "P-ERR-26191 recorder: stop refused: the recording is ending already; nothing was changed"
    assert story.refused(story.stop) == text


@pytest.mark.parametrize("what", ["start", "snapshot"])
def test_files_that_cannot_be_written_are_refused(tmp_path, what):
    story = Story(keep=1.0).run(0.2)
    call = story.recorder.start if what == "start" else story.snapshot
    there = tmp_path / "there.mcap"
    there.write_text("good")
    refused = f"recorder: {what} refused"
    assert story.refused(call, str(there)) == (
        f"P-ERR-26192 {refused}: {there} exists; nothing was changed, choose another name"
    )
    assert there.read_text() == "good"
    assert story.refused(call, str(tmp_path)).startswith(f"P-ERR-26192 {refused}: {tmp_path} exists;")
    missing = tmp_path / "missing" / "a.mcap"
    assert story.refused(call, str(missing)) == (
        f"P-ERR-26113 {refused}: recording {missing} cannot be written: there is no folder {missing.parent}, make it or give "
        "another name; nothing was changed"
    )
    read_only = "/proc/self/a.mcap"  # root may write into any folder but this
    assert story.refused(call, read_only).startswith(
        f"P-ERR-26113 {refused}: recording {read_only} cannot be written: "
    )
    assert story.refused(call, "") == (
        f"P-ERR-26113 {refused}: recording  cannot be written: Is a directory; nothing was changed"
    )
    assert story.recorder.current is None and [*tmp_path.iterdir()] == [there]


def test_a_snapshot_of_nothing_is_refused(tmp_path):
    file = tmp_path / "a.mcap"
    assert Story().refused(Story().snapshot, file) == (
        "P-ERR-26193 recorder: snapshot refused: nothing is kept in memory; `cnc_ptp run` keeps the last seconds with "
        "--keep; nothing was changed"
    )
    story = Story(keep=1.0)
    text = "P-ERR-26193 recorder: snapshot refused: no block of all units has come yet; nothing was changed"
    assert story.refused(story.snapshot, file) == text
    assert not file.exists()


@pytest.mark.parametrize("seconds", [-1.0, math.inf, 86401.0])
def test_a_snapshot_of_an_impossible_time_is_refused(tmp_path, seconds):
    story = Story(keep=1.0).run(0.1)
    assert story.refused(story.snapshot, tmp_path / "a.mcap", seconds) == (
        f"P-ERR-26197 recorder: snapshot refused: seconds = {seconds:g} is not within 0 ... 86400 s; nothing was changed"
    )


def test_a_lost_unit_does_not_hold_a_stop_for_ever(tmp_path):
    story = Story().run(0.2)
    story.recorder.start(str(tmp_path / "a.mcap"))
    story.run(0.2)
    story.recorder._next["y"] = 390
    story.recorder.stop(story.answers.append)
    story.recorder.flush_if_due(story.now)
    story.recorder.flush_if_due(story.now + 1.9)
    assert not story.answers
    story.recorder.flush_if_due(story.now + 2.1)
    assert [answer.cycle for answer in story.answers] == [400]


def test_a_disk_that_gets_full_is_the_answer_to_a_stop(tmp_path):
    story = Story().run(0.1)
    story.recorder.start(str(tmp_path / "a.mcap"))
    story.run(0.1)
    current = story.recorder.current
    kept, current._file._stream = current._file._stream, open("/dev/full", "wb")  # noqa: SIM115
    story.stop()
    story.recorder.close()
    kept.close()
    [answer] = story.answers
    assert answer.error.number == NOT_WRITTEN and story.recorder.current is None


def test_a_recorder_that_came_late_says_that_nothing_can_be_computed_again(tmp_path):
    story = Story(first_cycle=10, keep=1.0)
    story.run(0.3).snapshot(tmp_path / "a.mcap").run(0.5)
    story.recorder.close()
    recorded = read_recording(tmp_path / "a.mcap")
    assert recorded.metadata[WITHOUT] == "the recorder came at cycle 10, commands before it are not recorded"
    with pytest.raises(CncError) as refusal:
        verify(recorded, replay_blocks)
    assert str(refusal.value) == (
        f"P-ERR-26018 recording {tmp_path / 'a.mcap'}: the recorder came at cycle 10, commands before it are not "
        "recorded; the run cannot be computed again, its states can be read and drawn"
    )


def test_commands_that_were_forgotten_are_said(tmp_path):
    story = Story().run(1.0)
    story.recorder._history._most = 2 * OBJECT
    story.recorder.command(CommandRecord(990, "x", "stop", "{}", True, 0, ""))
    story.recorder.start(str(tmp_path / "a.mcap"))
    story.recorder.close()
    assert read_recording(tmp_path / "a.mcap").metadata[WITHOUT] == (
        "commands up to cycle 900 were forgotten before it began, there were too many"
    )


def test_memory_is_bounded():
    kept = LastSeconds(1000, most_bytes=5000)
    for cycle in range(0, 3000, 10):
        kept.add(cycle, 400, "encoded_block", "x")
    assert kept._size <= 5000 and kept.first_whole(["x"]) == 2880 and kept.first_whole(["x", "y"]) is None
    history = History(10 * OBJECT)
    for cycle in range(100):
        history.add(Event(cycle, "x", 0, 0, ""))
    assert (history.forgotten, len(history.before(95))) == (89, 5)


def test_what_is_kept_compressed_comes_back_as_it_was():
    """More than a batch, of both kinds, with all fields."""
    records = []
    for cycle in range(0, 5 * BATCH, 2):
        values = {"limit": 1.5, "unit": "mm"} if cycle % 4 else {}
        records.append(CommandRecord(cycle, "x", "stop", "{}", bool(values), 7, "a text", cycle, values, 3, 23073))
        records.append(Event(cycle, "s", Severity.ERROR, 22054, "°", 4, [EventValue("a", cycle / 3, "mm", "limit")]))
    history = History()
    for record in records:
        history.add(record)
    kept = history.before(5 * BATCH - 2)
    assert kept == records[:-2]
    for name in ("arguments", "values", "job", "warning_id"):
        assert [getattr(each, name) for each in kept[::2]] == [getattr(each, name) for each in records[:-2:2]]


def test_overrides_in_each_block_take_little_memory():
    """Four values that change in each block."""
    history = History()
    for cycle in range(0, 100_000, 10):
        for unit in ("x", "y", "z", "channel"):
            percent = 50.0 + (cycle * 7 + len(unit)) % 41
            history.add(CommandRecord(cycle, unit, "set_override", json_of({"percent": percent}), True, 0, "", cycle))
    assert history._size < BATCH * 2 * OBJECT + 40_000 * 20


def test_what_does_not_fit_any_longer_is_forgotten_batch_by_batch():
    history = History(BATCH * 2 * OBJECT)
    for cycle in range(100 * BATCH):
        history.add(Event(cycle, "x", 0, 0, f"{(cycle * 2654435761) % 2**32:032b}" * 4))
    assert history.forgotten > 0 and history.forgotten % BATCH == BATCH - 1
    assert [each.cycle for each in history.before(100 * BATCH)] == [*range(history.forgotten + 1, 100 * BATCH)]


def test_parts_are_written_on_demand_too(tmp_path):
    story = Story(settings=Settings("lz4", Split(seconds=1.0), {"scenario.yaml": SCENARIO})).run(0.2)
    story.recorder.start(str(tmp_path / "a"))
    story.run(2.5).stop().run(0.3)
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == [
        *(f"a_{number}.mcap" for number in range(3)),
        "metadata.yaml",
    ]
    recorded, first, last = computed_again(tmp_path / "a")
    assert (first, last, recorded.attachments) == (200, 2699, {"scenario.yaml": SCENARIO})


def saved_of(cut, saved):
    """Messages; nothing is written where there is none."""
    try:
        return recover(cut, saved).messages
    except CncError as error:
        assert error.number == NOTHING_LEFT
        return 0


@pytest.mark.long
def test_a_recording_on_demand_that_was_cut_anywhere(tmp_path):
    path, cut, saved = (tmp_path / f"{name}.mcap" for name in ("a", "cut", "saved"))
    story = Story().run(0.3)
    story.recorder.start(str(path))
    story.run(1.5).stop().run(0.3)
    story.recorder.close()
    data, whole = path.read_bytes(), sum(1 for _ in iter_messages(path))
    counts = []
    for size in [*range(8, len(data), len(data) // 40), len(data)]:
        cut.write_bytes(data[:size])
        counts.append(saved_of(cut, saved))
        assert sum(1 for _ in iter_messages(cut)) == counts[-1]
        if counts[-1]:
            assert not verify(read_recording(saved), replay_blocks).differences
        close_cut(cut)
        assert sum(1 for _ in iter_messages(cut)) == counts[-1]
    assert counts == sorted(counts) and counts[-1] == whole and len({*counts}) > 3


def test_a_disk_that_gets_full_ends_a_recording_on_demand_and_nothing_else(tmp_path):
    """The limit of a process in place of a small disk: SIGXFSZ is ignored in Python, the write fails."""
    story = Story().run(0.3)
    story.recorder.start(str(tmp_path / "a.mcap"))
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (120_000, limits[1]))
    try:
        with pytest.raises(CncError) as full:
            story.run(20.0)
        assert full.value.number == NOT_WRITTEN
        story.recorder.fail(full.value, 300)  # as RecorderNode does
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert story.recorder.current is None
    with pytest.raises(CncError) as told:
        story.recorder.stop(lambda answer: None)
    assert told.value is full.value
    recorded = read_recording(tmp_path / "a.mcap")
    assert not recorded.complete and verify(recorded, replay_blocks).equal
    story.run(0.05)  # the error has cut the block short in which it came
    story.recorder.start(str(tmp_path / "b.mcap"))
    story.run(0.5).stop().run(0.3)
    story.recorder.close()
    assert computed_again(tmp_path / "b.mcap")
