"""States that stay in the file: found by their cycles as in memory, and in a bounded memory."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from long_support import long
from recording_support import MACHINE, Blocks, smooth_run

from cnc_ptp.commands.commissioning.axis_data import FIELDS
from cnc_ptp.commands.run.replay import end_of
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import AxisBlock, CycleTick
from cnc_ptp.recording.mcap_index import McapIndex
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.settings import Settings, Split
from cnc_ptp.recording.stored_states import StoredStates, cycles_of, read_columns, read_stored, without
from cnc_ptp.recording.verify import verify
from cnc_ptp.recording.writer import Recording

STATE = np.dtype([("cycle", "<u8"), ("value", "<f8")])
PIECES = st.lists(st.lists(st.integers(0, 40) | st.integers(2**63, 2**64 - 1), max_size=12), max_size=6)


def stored(pieces):
    """As states in pieces, and as one array in the order of the file; values count up."""
    count = sum(map(len, pieces))
    whole = np.zeros(count, dtype=STATE)
    whole["cycle"] = [cycle for piece in pieces for cycle in piece]
    whole["value"] = np.arange(count)
    states, begin = StoredStates(STATE), 0
    for piece in pieces:
        rows = whole[begin : begin + len(piece)]
        states.add(rows["cycle"], lambda rows=rows: rows)
        begin += len(piece)
    return states, whole


@given(PIECES, st.integers(0, 45), st.integers(0, 20))
def test_states_are_found_by_their_cycles_in_any_order(pieces, first, length):
    states, whole = stored(pieces)
    in_order = whole[np.argsort(whole["cycle"], kind="stable")]
    inside = (in_order["cycle"] >= first) & (in_order["cycle"] <= first + length)
    assert states.rows(first, first + length).tolist() == in_order[inside].tolist()
    cycles, counts = np.unique(whole["cycle"], return_counts=True)
    assert len(states) == len(whole)
    assert cycles_of(states.repeated()) == cycles[counts > 1].tolist()
    assert cycles_of(states.intervals()) == cycles.tolist()
    if len(whole):
        assert (states.first, states.last) == (cycles[0], cycles[-1])


@given(st.sets(st.integers(0, 30)), st.sets(st.integers(0, 30)))
def test_what_others_do_not_have(own, others):
    def intervals(cycles):
        return [*StoredStates.of_rows(np.array([(c, 0.0) for c in sorted(cycles)], dtype=STATE)).intervals()]

    assert cycles_of(without(intervals(own), intervals(others))) == sorted(own - others)


def damaged(path, seed, settings):
    """Blocks twice, too early, too late, not at all, and with other values; a second computation of the run."""
    lost, twice, early = {30 * seed}, {50 + 10 * seed}, {200}
    with Recording(path, MACHINE, chunk_seconds=0.2, settings=settings) as recording:
        for name, block in Blocks(seed).machine(60):
            if name == "plc":
                recording.tick(CycleTick(block.first_cycle, 10))
            first = block.first_cycle
            if name == "x" and first in lost:
                continue
            if name == "x" and first in early:
                block.first_cycle = 2**40 + seed
            if name == "s" and first == 300:
                block.set_speed_rpm[seed] = 1.0
            for _ in range(2 if name == "y" and first in twice else 1):
                recording.block(name, block)
    return lambda _: Blocks(seed).machine(55)


@pytest.mark.parametrize("settings", [Settings(), Settings(split=Split(seconds=0.2))], ids=["file", "parts"])
@pytest.mark.parametrize("seed", [1, *long([2])])
@pytest.mark.parametrize("cut", [0, 20_000])
def test_the_result_of_a_verification_is_the_same(tmp_path, seed, settings, cut):
    path = tmp_path / "run"
    replay = damaged(path, seed, settings)
    newest = sorted(path.glob("*.mcap"))[-1] if path.is_dir() else path
    newest.write_bytes(newest.read_bytes()[: len(newest.read_bytes()) - cut])
    in_memory, in_file = read_recording(path), read_stored(path)
    assert in_file.states == {} and in_file.events == [] and in_file.missing == in_memory.missing
    assert (end_of(in_file), in_file.last_cycle) == (end_of(in_memory), in_memory.last_cycle)
    one, other = verify(in_memory, replay), verify(in_file, replay)
    assert not one.equal and one.topics["/y/state"].duplicated and one.topics["/x/state"].missing
    assert cut or (one.differences == 1 and one.topics["/x/state"].surplus)
    assert other.topics == one.topics and other.text() == one.text()


CYCLES = 120_000


def moving(count):
    """The blocks of one axis."""
    for first in range(0, count, 10):
        values = [0.5 * first + place for place in range(10)]
        yield "x", AxisBlock(first, 10, *[values] * 15, *[[1] * 10] * 3)


def peak_of(call):
    tracemalloc.start()
    try:
        result = call()
        return result, tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.long
def test_neither_a_verification_nor_an_identification_has_all_states_in_memory(tmp_path):
    path = tmp_path / "run.mcap"
    with Recording(path, MACHINE, chunk_seconds=0.2) as recording:
        for name, block in moving(CYCLES):
            recording.block(name, block)
    recorded, all_states = peak_of(lambda: read_recording(path))
    size = recorded.states["/x/state"].nbytes
    assert all_states > size > 10_000_000
    del recorded
    result, needed = peak_of(lambda: verify(read_stored(path), lambda _: moving(CYCLES)))
    assert result.equal and result.compared == CYCLES
    assert needed < size / 2
    columns, needed = peak_of(lambda: read_columns(path, "/x/state", FIELDS))
    assert columns.states["/x/state"].nbytes == CYCLES * 8 * (1 + len(FIELDS))
    assert needed < size


def test_an_identification_has_the_columns_of_its_axis(tmp_path):
    path = tmp_path / "run.mcap"
    smooth_run(path, 1.5)
    whole, columns = read_recording(path), read_columns(path, "/y/state", FIELDS)
    assert [*columns.states] == ["/y/state"] and columns.ticks is None and columns.events == []
    for name in ("cycle", *FIELDS):
        assert columns.states["/y/state"][name].tobytes() == whole.states["/y/state"][name].tobytes()
    assert columns.topics == whole.topics and columns.machine_yaml == MACHINE


def test_a_file_that_is_changed_while_it_is_compared(tmp_path):
    path = tmp_path / "run.mcap"
    smooth_run(path, 0.5, axes=("x",))
    recorded = read_stored(path)
    index = McapIndex(path)
    [ids] = [index.ids_of("/x/state")]
    [place] = [chunk for chunk in index.chunks if not ids.isdisjoint(chunk.indexes)]
    index.close()
    path.write_bytes(path.read_bytes()[: place.offset + 20])
    with pytest.raises(CncError) as error:
        recorded.stored["/x/state"].rows(0, 10)
    assert str(error.value) == (
        f"P-ERR-26003 recording {path}: corrupt at offset {place.offset}: the chunk that was there is gone, the file was "
        "changed meanwhile; nothing was read, take an intact copy of the file or save what is whole with 'cnc_ptp recover'"
    )
    path.unlink()
    with pytest.raises(CncError) as error:
        recorded.stored["/x/state"].rows(0, 10)
    assert str(error.value) == (
        f"P-ERR-26001 recording {path}: cannot be opened: No such file or directory; nothing was read, check the path"
    )
