"""Checkpoints of recordings on demand and of snapshots: a what-if begins at one of them, whatever was forgotten."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from machine_support import PTP, ROOT, MachineBench

from cnc_ptp.client import Machine, RecorderOptions
from cnc_ptp.commands.run.what_if import compute
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.parameters import machine_text
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command, CommandRecord, CycleTick
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.memory import LastStates
from cnc_ptp.recording.on_demand import OnDemand, Snapshots
from cnc_ptp.recording.reader import Recorded, read_recording
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.settings import Settings
from cnc_ptp.recording.what_if import Change, WhatIf
from cnc_ptp.state import machine_state
from cnc_ptp.state.machine_state import StateStore
from cnc_ptp.wire.block_codec import codec_of
from cnc_ptp.wire.stamps import Stamps

SCENARIO = """
- {at: 0.0, to: x, do: reset}
- {at: 0.1, to: x, do: move_absolute, target: 400, velocity: 200}
- {at: 0.9, to: x, do: set_override, percent: 60}
- {at: 2.2, to: x, do: move_absolute, target: -100, velocity: 150}
"""
FORGOTTEN = "commands up to cycle {} were forgotten before it began, there were too many"
OF_OTHERS = "P-ERR-26152 checkpoint: the state is that of a kernel with other sources; nothing was restored"


class Graph:
    """A machine whose units give their states to a recorder as those of a graph do: each its own, x one block late."""

    def __init__(self, *, keep: float = 0.0, every: int = 500, lost: tuple[int, ...] = ()) -> None:
        """`lost`: cycles whose state of y never comes."""
        self.bench = MachineBench(scenario=SCENARIO, machine=PTP, end_when_idle=False)
        self.recorder = OnDemand(
            machine_text(ROOT / "config" / "ptp.yaml"),
            Stamps(0, 1_000_000),
            unit_kinds(PTP),
            settings=Settings(),
            snapshots=Snapshots(keep),
            publish=lambda event: None,
        )
        self._store, self._every, self._lost = StateStore(PTP), every, lost
        self._late: list[partial[None]] = []
        self.answers: list[object] = []

    def run(self, seconds: float) -> Graph:
        for _ in range(round(seconds * 100)):
            self._block()
        return self

    def _block(self) -> None:
        outputs = self.bench.offline.tick()
        plc = outputs[PLC].block
        self.recorder.tick(CycleTick(plc.first_cycle, plc.count))
        for take in self._late:
            take()
        self._late = []
        for name, output in outputs.items():
            data = codec_of(type(output.block)).encode(output.block, self.recorder.stamps)
            self.recorder.encoded_block(name, type(output.block), data)
            for record in output.records:
                self.recorder.command(record)
        cycle = self.bench.offline.next_cycle
        if cycle % self._every == 0:
            runners, blocks = self.bench.offline.parts
            for name, runner in runners.items():
                own = {} if name == PLC else {name: runner}
                state = self._store.encode_units(cycle, own, {name: blocks[name]})
                take = partial(self.recorder.checkpoint, cycle, state, name)
                if name == "x":
                    self._late.append(take)
                elif name != "y" or cycle not in self._lost:
                    take()
            self.recorder.checkpoint_texts(self._store.texts)
        self.recorder.carry_out(cycle * 1e-3)

    def snapshot(self, file: Path, seconds: float = 0.0, until: float = 0.0) -> Graph:
        self.recorder.snapshot(str(file), seconds, until, self.answers.append)
        return self

    def close(self) -> None:
        self.recorder.close()


def checkpoints_of(path: Path) -> list[int]:
    with RunInputs(path) as recorded:
        return recorded.checkpoints


def changed(path: Path, new: Path, change: Change) -> tuple[Recorded, str]:
    with RunInputs(path) as recorded:
        run = WhatIf(recorded, change)
        compute(run, recorded, new)
    return read_recording(new), run.note


def refusal(path: Path, change: Change) -> str:
    with RunInputs(path) as recorded, pytest.raises(CncError) as refused:
        next(WhatIf(recorded, change).run())
    return str(refused.value)


def require_equal(path: Path, again: Recorded) -> None:
    """All states of `again` are those of the recording."""
    for topic, rows in read_recording(path).states.items():
        of_both = rows[np.isin(rows["cycle"], again.states[topic]["cycle"])]
        assert len(of_both) == len(again.states[topic]) > 0
        for name in rows.dtype.names or ():
            assert of_both[name].tobytes() == again.states[topic][name].tobytes(), (topic, name)


def test_a_snapshot_has_the_whole_checkpoints_of_its_time_and_the_newest_before(tmp_path: Path) -> None:
    graph = Graph(keep=1.2, lost=(2500,)).run(3.25).snapshot(tmp_path / "a.mcap").run(0.5)
    graph.close()
    assert checkpoints_of(tmp_path / "a.mcap") == [2000, 3000]  # the first cycle is 2050
    for begin, note in ((2.06, "2 s"), (2.9, "2 s"), (3.1, "3 s")):
        again, computed = changed(tmp_path / "a.mcap", tmp_path / "b.mcap", Change(begin))
        assert computed == f"computed from the checkpoint at {note}"
        require_equal(tmp_path / "a.mcap", again)


def test_a_snapshot_with_an_end_has_the_checkpoints_up_to_it(tmp_path: Path) -> None:
    graph = Graph(keep=3.0).run(3.25).snapshot(tmp_path / "a.mcap", 0.9, 2.55).run(0.5)
    graph.close()
    assert checkpoints_of(tmp_path / "a.mcap") == [1500, 2000, 2500]
    for begin, note in ((1.7, "1.5 s"), (2.52, "2.5 s")):
        again, computed = changed(tmp_path / "a.mcap", tmp_path / "b.mcap", Change(begin))
        assert computed == f"computed from the checkpoint at {note}"
        assert max(rows["cycle"].max() for rows in again.states.values()) == 2549
        require_equal(tmp_path / "a.mcap", again)


def test_a_change_in_a_snapshot_acts_from_its_time_on(tmp_path: Path) -> None:
    Graph(keep=2.0).run(3.0).snapshot(tmp_path / "a.mcap").run(0.5).close()
    stop = Entry(2.6, Command("x", "stop"))
    again, note = changed(tmp_path / "a.mcap", tmp_path / "b.mcap", Change(2.5, commands=[stop]))
    assert note == "computed from the checkpoint at 2.5 s"
    before, after = read_recording(tmp_path / "a.mcap").states["/x/state"], again.states["/x/state"]
    until = before["set_position"][before["cycle"] >= 2500]
    assert until[:100].tobytes() == after["set_position"][:100].tobytes()
    assert before["set_velocity"][-1] != 0.0 and after["set_velocity"][-1] == 0.0


def forgetful(path: Path, **options: object) -> Path:
    """A snapshot of 1.0 s to 3.0 s by a recorder that has forgotten the commands up to 1.6 s."""
    graph = Graph(keep=2.0, **options).run(1.5)  # type: ignore[arg-type]
    graph.recorder.command(CommandRecord(1600, "x", "stop", "{}", False, 23001, "not in the run"))
    graph.recorder._history._most = 0
    graph.recorder.command(CommandRecord(1600, "x", "stop", "{}", False, 23001, "not in the run"))
    graph.recorder._history._most = 2**20
    graph.run(1.5).snapshot(path).run(0.5).close()
    return path


def test_a_run_whose_first_commands_were_forgotten_is_computed_from_a_checkpoint(tmp_path: Path) -> None:
    path = forgetful(tmp_path / "a.mcap")
    assert checkpoints_of(path) == [2000, 2500, 3000]  # those before lack commands
    again, note = changed(path, tmp_path / "b.mcap", Change(2.1))
    assert note == "computed from the checkpoint at 2 s"
    require_equal(path, again)
    assert refusal(path, Change(1.9)) == (
        f"P-ERR-26018 recording {path}: {FORGOTTEN.format(1600)}, and it has no checkpoint up to --from 1.9 s; "
        "nothing was computed, its first one is at 2 s"
    )


def test_without_a_checkpoint_it_cannot_be_computed_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = forgetful(tmp_path / "a.mcap", every=100_000)
    assert refusal(path, Change(2.5)) == (
        f"P-ERR-26018 recording {path}: {FORGOTTEN.format(1600)}, and it has no checkpoint; nothing was computed, keep "
        "more seconds (--keep) than lie between two checkpoints (--checkpoints)"
    )
    other = forgetful(tmp_path / "b.mcap")
    monkeypatch.setattr(machine_state, "kernel_digest", lambda: bytes(16))
    assert refusal(other, Change(2.5)) == (
        f"P-ERR-26018 recording {other}: {FORGOTTEN.format(1600)}, and its checkpoints do not count: {OF_OTHERS}; "
        "nothing was computed, its states can be read and drawn"
    )


def test_a_recording_on_demand_begins_with_the_newest_checkpoint_before_it(tmp_path: Path) -> None:
    graph = Graph(lost=(1500,)).run(1.75)
    graph.recorder.start(str(tmp_path / "a.mcap"))
    graph.run(1.0).close()
    assert checkpoints_of(tmp_path / "a.mcap") == [1000, 2000, 2500]
    again, note = changed(tmp_path / "a.mcap", tmp_path / "b.mcap", Change(1.8))
    assert note == "computed from the checkpoint at 1 s"
    require_equal(tmp_path / "a.mcap", again)


def test_a_client_offline_has_them_too(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with Machine.offline(ROOT / "config" / "ptp.yaml", recorder=RecorderOptions(keep=3.0)) as machine:
        machine.x.move_absolute(100, velocity=50)
        machine.run_for(24.0)
        machine.x.move_absolute(0, velocity=50)
        machine.run_for(1.0)
        machine.recorder.snapshot(path)
    assert checkpoints_of(path) == [20_000]
    with RunInputs(path) as recorded:
        assert 21_000 < recorded.begin < recorded.end - 2000
        begin = (recorded.begin + 500) * 1e-3
    again, note = changed(path, tmp_path / "b.mcap", Change(begin))
    assert note == "computed from the checkpoint at 20 s"
    require_equal(path, again)


def test_memory_of_states_is_bounded() -> None:
    states = LastStates(["x", "plc"], most_bytes=100)
    for cycle in range(0, 1000, 10):
        states.add(cycle, "x", bytes(20))
        if cycle % 20 == 0:
            states.add(cycle, "plc", bytes(5))
        states.forget(cycle - 500)
        assert sum(len(state) for of in states._states.values() for state in of.values()) <= 100
    assert [*states.between(0, 1000)] == [960, 980]
    states.forget(990)
    assert [*states._states] == [980, 990]
    states.add(1000, "", bytes(500))
    states.forget(2000)
    assert states.between(1500, 2000) == {1000: {"": bytes(500)}}


def test_states_of_a_far_future_are_left_out() -> None:
    """A flood of foreign ones would hold up the recorder."""
    recorder = Graph().run(1.0).recorder
    known = dict(recorder._states._states)
    for cycle in range(10**6, 10**6 + 100):
        recorder.checkpoint(cycle, b"", "x")
    assert known and recorder._states._states == known
