"""Verification finds every altered, missing, doubled and surplus sample and names it."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples
from recording_support import Blocks, record

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import PlcBlock
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.verify import Difference, ranges_text, state_topic, verify

COUNT = 60


def computed(*, skip=(), change=None):
    """A second computation of the same run; `change(name, block)` may alter blocks."""
    for name, block in Blocks(11).machine(COUNT):
        if (name, block.first_cycle) in skip:
            continue
        if change:
            change(name, block)
        yield name, block


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("verify") / "run.mcap"
    record(path, list(computed()), chunk_seconds=0.2)
    return path


@pytest.fixture
def recorded(path):
    return read_recording(path)


def test_equal_run(recorded):
    result = verify(recorded, lambda _: computed())
    assert result.equal
    assert result.first == []
    assert result.text() == f"{recorded.path}: 2400 states of 4 topics are equal to the bit"


SAMPLES = [
    (unit, field)
    for unit, type_name in (("x", "axis"), ("s", "spindle"), ("channel", "channel"))
    for field in [item.name for item in dataclasses.fields(getattr(Blocks(0), type_name)(0))]
    if field
    not in (
        "first_cycle",
        "count",
        "path_active",
        "modulo_begin",
        "modulo_length",
        "torque_digits",
        "axes",
        "path_spindles",
        "spindle_travel",
        "spindle_speed",
        "spindle_acceleration",
        "spindle_jerk",
        "done",
        "commands",
        "requests",
        "blocks_done",
        "blocks_total",
        "master",
        "target_velocity",
        "couples_actual",
        "probe_on",
        "probe_switched",
        "probe_cycle",
        "probe_position",
        "job",
        "job_events",
        "answers",
        "control_units",
        "gear_request",
        "master_wanted",
        "source",
        "plc_commands",
        "plc_acknowledged",
        "refused",
    )
    and not (unit == "channel" and field.startswith(("set_", "thread_")))
]


@settings(max_examples=examples(60), deadline=None)
@given(sample=st.sampled_from(SAMPLES), cycle=st.integers(0, 10 * COUNT - 1))
def test_a_single_altered_sample_is_found_and_named(path, sample, cycle):
    unit, field = sample
    recorded = read_recording(path)
    rows = recorded.states[f"/{unit}/state"] = recorded.states[f"/{unit}/state"].copy()
    before = rows[field][cycle].item()
    bits = rows[field].dtype.itemsize
    if rows[field].dtype == bool:
        rows[field][cycle] = not before
    else:
        raw = rows[field][cycle : cycle + 1].copy().view(f"u{bits}")
        raw ^= raw.dtype.type(1)
        rows[field][cycle] = raw.view(rows[field].dtype)[0]
    after = rows[field][cycle].item()
    result = verify(recorded, lambda _: computed())
    assert not result.equal
    assert result.differences == 1
    [found] = result.first
    assert (found.topic, found.cycle, found.field) == (f"/{unit}/state", cycle, field)
    assert repr((found.recorded, found.computed)) == repr((after, before))
    assert result.text().splitlines()[1:] == [str(found)]


def test_stamps_are_compared_too(recorded):
    rows = recorded.states["/x/state"] = recorded.states["/x/state"].copy()
    rows["header.stamp.nanosec"][7] += 1
    result = verify(recorded, lambda _: computed())
    assert result.text().splitlines()[1:] == [
        "/x/state cycle 7 header.stamp.nanosec: recorded 7000001, computed 7000000"
    ]


def test_zero_and_minus_zero_and_nans_differ_by_their_bits(recorded):
    def change(name, block):
        if (name, block.first_cycle) == ("x", 30):
            recorded.states["/x/state"] = rows = recorded.states["/x/state"].copy()
            rows["set_position"][30], block.set_position[0] = 0.0, -0.0
            rows["set_position"][31] = np.array([0x7FF8000000000001], dtype=np.uint64).view(np.float64)[0]
            block.set_position[1] = math.nan

    list(computed(change=change))
    result = verify(recorded, lambda _: computed(change=change))
    assert result.text().splitlines()[1:] == [
        "/x/state cycle 30 set_position: recorded 0.0, computed -0.0",
        "/x/state cycle 30 set_position_modulo: recorded 5e-324, computed -0.0",
        "/x/state cycle 31 set_position: recorded nan (0x7ff8000000000001), computed nan (0x7ff8000000000000)",
        "/x/state cycle 31 set_position_modulo: recorded 5e-324, computed nan",
    ]


def test_the_earliest_differences_are_named_and_all_are_counted(recorded):
    def change(name, block):
        if name == "y" and block.first_cycle >= 100:
            block.actual_velocity = [
                value + 1.0 if math.isfinite(value) and abs(value) < 1e6 else 5.0 for value in block.actual_velocity
            ]
            block.error_id = [value ^ 1 for value in block.error_id]

    result = verify(recorded, lambda _: computed(change=change))
    assert not result.equal
    assert result.topics["/y/state"].differences == result.differences == 1000
    assert {name: topic.differences for name, topic in result.topics.items() if topic.differences} == {"/y/state": 1000}
    assert len(result.first) == 20
    assert {difference.cycle for difference in result.first} == set(range(100, 110))
    assert result.text().splitlines()[0] == f"{recorded.path}: 1000 differences in 2400 states"
    assert result.text().splitlines()[-1] == "/y/state: 980 further differences"


def test_gaps_doubles_and_surplus(recorded):
    rows = recorded.states["/x/state"]
    keep = np.delete(rows, [5, 6, 300])
    recorded.states["/x/state"] = np.concatenate([keep, rows[40:42]])
    result = verify(recorded, lambda _: computed(skip={("x", 200), ("s", 0)}))
    assert result.text().splitlines()[1:] == [
        "/x/state: 3 cycles missing: 5-6, 300",
        "/x/state: 2 cycles recorded twice: 40-41",
        "/x/state: 10 cycles not computed: 200-209",
        "/s/state: 10 cycles not computed: 0-9",
    ]
    assert result.topics["/x/state"].compared == 600 - 3 - 10 + 2


def test_an_altered_cycle_number_shows_as_gap_and_double(recorded):
    rows = recorded.states["/x/state"] = recorded.states["/x/state"].copy()
    rows["cycle"][50] = 51
    result = verify(recorded, lambda _: computed())
    lines = result.text().splitlines()[1:]
    assert "/x/state: 1 cycles missing: 50" in lines
    assert "/x/state: 1 cycles recorded twice: 51" in lines
    assert "/x/state cycle 51 header.stamp.nanosec: recorded 50000000, computed 51000000" in lines


def test_a_topic_that_was_not_recorded_or_not_computed(recorded):
    del recorded.states["/y/state"]
    result = verify(recorded, lambda _: (pair for pair in computed() if pair[0] != "s"))
    assert result.text().splitlines()[1:] == [
        "/s/state: 600 cycles not computed: 0-599",
        "/y/state: 600 cycles missing: 0-599",
    ]


def test_a_file_that_was_cut_off_is_compared_up_to_its_end(path, tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    recorded = read_recording(cut)
    assert 0 < recorded.last_cycle < 599
    result = verify(recorded, lambda _: computed())
    assert result.equal
    lengths = [len(rows) for rows in recorded.states.values()]
    assert result.compared == sum(lengths)
    assert max(lengths) - min(lengths) <= 200  # each unit has chunks of its own; those of the last second may be cut


def test_blocks_of_changing_length(tmp_path):
    def run():
        blocks = Blocks(5)
        yield "x", blocks.axis(0, 10)
        yield "x", blocks.axis(10, 3)
        yield "plc", PlcBlock(0, 10)
        yield "/x/block", blocks.axis(13, 10)

    record(tmp_path / "run.mcap", [(state_topic(name).split("/")[1], block) for name, block in run()])
    assert verify(read_recording(tmp_path / "run.mcap"), lambda _: run()).compared == 23


def test_recording_without_states_or_machine_file(recorded):
    recorded.states = {}
    result = verify(recorded, lambda _: iter(()))
    assert not result.equal
    assert result.text() == f"{recorded.path}: holds no per-cycle states, nothing could be compared"
    recorded.machine_yaml = ""
    with pytest.raises(CncError) as error:
        verify(recorded, lambda _: iter(()))
    assert str(error.value) == (
        f"P-ERR-26004 recording {recorded.path}: holds no attachment machine.yaml; it cannot be verified, record it "
        "with cnc_ptp"
    )


def test_recording_of_an_older_version_is_compared_in_what_it_has(recorded):
    without = [name for name in recorded.states["/x/state"].dtype.names if name not in ("set_direction", "error_id")]
    for unit in "xy":
        recorded.states[f"/{unit}/state"] = recorded.states[f"/{unit}/state"][without]
    recorded.states["/s/state"] = recorded.states["/s/state"][["cycle", "gear"]]
    spindle = read_recording(recorded.path).states["/s/state"].dtype.names
    result = verify(recorded, lambda _: computed())
    assert result.equal
    assert result.text().splitlines() == [
        f"{recorded.path}: 2400 states of 4 topics are equal to the bit",
        "note: recorded without set_direction, error_id (/x/state, /y/state): not compared",
        f"note: recorded without {', '.join(n for n in spindle if n not in ('cycle', 'gear'))} (/s/state): not compared",
    ]


def test_difference_in_a_recording_of_an_older_version(recorded):
    rows = recorded.states["/x/state"][["cycle", "set_position", "state"]].copy()
    rows["state"][44] ^= 3
    recorded.states["/x/state"] = rows
    result = verify(recorded, lambda _: computed())
    assert (result.equal, result.differences) == (False, 1)
    first, difference, note = result.text().splitlines()
    assert first == f"{recorded.path}: 1 differences in 2400 states"
    assert difference.startswith("/x/state cycle 44 state: recorded ")
    assert note.startswith("note: recorded without header.stamp.sec, ")


def test_recording_of_a_newer_version(recorded):
    rows = recorded.states["/x/state"]
    more = np.zeros(
        len(rows), dtype=[*((name, rows.dtype[name]) for name in rows.dtype.names), ("a", "f8"), ("b", "u1")]
    )
    for name in rows.dtype.names:
        more[name] = rows[name]
    recorded.states["/x/state"] = more
    with pytest.raises(CncError) as error:
        verify(recorded, lambda _: computed())
    assert str(error.value) == (
        f"P-ERR-26004 recording {recorded.path}: /x/state has the fields a, b, which this version does not compute; "
        "it cannot be verified, use the version that recorded it"
    )


def test_names_and_ranges():
    assert state_topic("x") == state_topic("/x/block") == state_topic("/x/state") == "/x/state"
    assert ranges_text([9, 3, 4, 5]) == "3-5, 9"
    assert ranges_text(list(range(0, 20, 2))) == "0, 2, 4, 6, 8, …"
    assert str(Difference(4, "/x/state", "state", 1, 2)) == "/x/state cycle 4 state: recorded 1, computed 2"
