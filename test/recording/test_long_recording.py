"""Recordings for reports: a long one is reduced to extremes, of a part every cycle is read; against the whole file."""

import math
import shutil

import numpy as np
import pytest
from recording_support import smooth_blocks, smooth_run

from cnc_ptp.errors import CncError
from cnc_ptp.plots.report import report_page
from cnc_ptp.plots.report_figures import time_columns
from cnc_ptp.protocol.blocks import AxisBlock, CycleTick
from cnc_ptp.recording import long_recording
from cnc_ptp.recording.long_recording import extremes, read_for_report
from cnc_ptp.recording.mcap_index import NOT_CLOSED
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.rows import time_rows
from cnc_ptp.recording.selection import selected
from cnc_ptp.recording.settings import Settings, Split
from cnc_ptp.recording.statistics import summary
from cnc_ptp.recording.writer import Recording
from cnc_ptp.wire.layout import Header, encode
from cnc_ptp.wire.schemas import load_schema

SECONDS = 7.3
FEW = 1000
"""States that are kept as they are: less than the recordings here have."""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("long") / "run.mcap"
    smooth_run(path, SECONDS)
    return path


@pytest.fixture(autouse=True)
def smaller(monkeypatch):
    """Pairs of 2 · 73 cycles, and batches that end between them."""
    monkeypatch.setattr(long_recording, "STATES", 100)
    monkeypatch.setattr(long_recording, "PLACES", 1000)
    monkeypatch.setattr(long_recording, "BATCH", 2)


def test_short_recordings_are_read_as_a_whole(path):
    recorded = read_for_report(path)
    assert recorded.reduced is None
    assert all((rows == recorded.states[topic]).all() for topic, rows in read_recording(path).states.items())


def test_states_are_the_extremes_of_all_cycles(path):
    whole, reduced = read_recording(path), read_for_report(path, most_states=FEW)
    assert reduced.stride == 73
    assert reduced.states.keys() == whole.states.keys()
    for topic, rows in reduced.states.items():
        all_rows = whole.states[topic]
        assert len(rows) == 100
        assert rows["cycle"].tolist() == list(range(0, 7300, 73))
        for name in rows.dtype.names[1:]:
            for pair in range(50):
                part = all_rows[name][146 * pair : 146 * (pair + 1)]
                shown = rows[name][2 * pair : 2 * pair + 2]
                assert sorted(shown) == [part.min(), part.max()]
                assert shown[1] == (part.max() if part[-1] >= part[0] else part.min())


def test_figures_are_those_of_all_cycles(path):
    whole, reduced = read_recording(path), read_for_report(path, most_states=FEW)
    assert summary(reduced) == summary(whole)
    assert reduced.last_cycle == whole.last_cycle == 7299
    assert (reduced.events, reduced.commands) == (whole.events, whole.commands)
    assert (reduced.machine_yaml, reduced.metadata) == (whole.machine_yaml, whole.metadata)
    assert {topic: info.count for topic, info in reduced.topics.items()} == {
        topic: info.count for topic, info in whole.topics.items()
    }


def test_paths_are_places_as_they_were(path):
    whole, reduced = read_recording(path), read_for_report(path, most_states=FEW)
    assert reduced.reduced.path_stride == 7
    for axis, rows in reduced.reduced.paths.items():
        every = whole.states[f"/{axis}/state"][::7]
        assert all((rows[name] == every[name]).all() for name in rows.dtype.names)


def test_what_is_left_over_is_a_pair_too(tmp_path):
    smooth_run(tmp_path / "run.mcap", 1.23)
    reduced = read_for_report(tmp_path / "run.mcap", most_states=FEW)
    assert reduced.stride == 12
    assert reduced.states["/x/state"]["cycle"][-2:].tolist() == [1224, 1227]
    assert reduced.last_cycle == 1229


def test_of_a_part_every_cycle_is_read(path):
    part = selected(read_for_report(path, 3.0, 3.05, most_states=10_000), begin=3.0, end=3.05)
    whole = selected(read_recording(path), begin=3.0, end=3.05)
    assert part.reduced is None
    assert all((rows == part.states[topic]).all() for topic, rows in whole.states.items())
    assert part.states["/x/state"]["cycle"].tolist() == list(range(3000, 3050))


def test_a_part_that_is_too_long_is_reduced(path):
    part = read_for_report(path, 2.0, 6.0, most_states=FEW)
    rows = part.states["/x/state"]
    assert 2000 <= rows["cycle"].min() <= rows["cycle"].max() <= 6000
    errors = np.abs(read_recording(path).states["/x/state"]["following_error"][2000:6001])
    assert abs(part.reduced.largest["x"][0]) == errors.max()


def test_missing_cycles_count_and_interrupt_lines(tmp_path):
    with Recording(tmp_path / "run.mcap", "") as recording:
        for name, block in smooth_blocks(5.0):
            if name == "plc":
                recording.tick(CycleTick(block.first_cycle, 10))
            if not 2000 <= block.first_cycle < 2500:
                recording.block(name, block)
    reduced = read_for_report(tmp_path / "run.mcap", most_states=FEW)
    assert summary(reduced)["lost_blocks"] == 50 * 5
    steps = np.diff(reduced.states["/x/state"]["cycle"].astype(int))
    assert (steps > reduced.stride).sum() == 1
    columns = time_columns(reduced, time_rows(reduced, {}, {}))
    assert columns["stride"] == reduced.stride == 45


def test_nan_is_the_largest_following_error(tmp_path):
    with Recording(tmp_path / "run.mcap", "") as recording:
        for name, block in smooth_blocks(3.0):
            if isinstance(block, AxisBlock) and name == "y" and block.first_cycle == 700:
                block.following_error[3] = math.nan
            recording.block(name, block)
    value, cycle = read_for_report(tmp_path / "run.mcap", most_states=FEW).reduced.largest["y"]
    assert math.isnan(value)
    assert cycle == 703


def test_a_file_that_was_not_closed(path, tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[:-3000])
    reduced = read_for_report(cut, most_states=FEW)
    assert not reduced.complete
    assert reduced.missing == "the file was not closed; what was recorded after its last whole chunk is missing"
    assert reduced.states["/x/state"]["cycle"].max() > 6000


def test_states_of_another_size_are_corrupt(tmp_path):
    schema = load_schema("cnc_ptp/msg/AxisState")
    zero = dict.fromkeys((field.name for field in schema.fields if field.name != "header"), 0)
    with Recording(tmp_path / "run.mcap", "") as recording:
        for name, block in smooth_blocks(1.0):
            recording.block(name, block)
        data = encode(schema, type("State", (), zero)(), lambda _: Header())
        recording.raw("/q/state", "cnc_ptp/msg/AxisState", data + bytes(4), 5)
    with pytest.raises(CncError) as caught:
        read_for_report(tmp_path / "run.mcap", most_states=FEW)
    size = len(data)
    assert caught.value.number == 26003
    assert caught.value.reason.endswith(f": a message of /q/state has {size + 4} bytes instead of {size}")


def test_the_page_says_what_it_shows(path):
    page = report_page(read_for_report(path, most_states=FEW))
    assert "smallest and largest values of each 0.146 s, the path a place each 0.007 s" in page
    assert '"Over the path"' not in page and "<h2>Blocks</h2>" not in page
    assert "<h2>Path</h2>" in page


def test_extremes_of_whole_numbers_keep_their_type():
    rows = np.zeros(8, dtype=[("cycle", "<u8"), ("line", "<u4")])
    rows["cycle"], rows["line"] = range(8), [1, 4, 2, 2, 9, 7, 7, 6]
    found = extremes(rows, ("line", "absent"), 2)
    assert found.dtype == rows.dtype
    assert found.tolist() == [(0, 1), (2, 4), (4, 9), (6, 6)]


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """The same run in parts of 2 s."""
    path = tmp_path_factory.mktemp("parts") / "run"
    smooth_run(path, SECONDS, settings=Settings(split=Split(seconds=2.0)))
    assert len([*path.glob("*.mcap")]) == 4
    return path


def test_the_parts_of_a_folder_are_reduced_to_the_same(path, parts):
    of_file, of_parts = (read_for_report(each, most_states=FEW) for each in (path, parts))
    assert of_parts.states.keys() == of_file.states.keys()
    for topic, rows in of_file.states.items():
        assert all((rows[name] == of_parts.states[topic][name]).all() for name in rows.dtype.names)
    for axis, rows in of_file.reduced.paths.items():
        assert (rows == of_parts.reduced.paths[axis]).all()
    assert summary(of_parts) == summary(of_file)
    assert {name: info.count for name, info in of_parts.topics.items()} == {
        name: info.count for name, info in of_file.topics.items()
    }
    assert (of_parts.machine_yaml, of_parts.complete, of_parts.path) == (of_file.machine_yaml, True, parts)


@pytest.mark.parametrize("name", ["", "metadata.yaml"])
def test_of_a_time_over_two_parts_every_cycle_is_read(path, parts, name):
    part = selected(read_for_report(parts / name, 1.9, 2.1, most_states=math.inf), begin=1.9, end=2.1)
    whole = selected(read_recording(path), begin=1.9, end=2.1)
    assert part.reduced is None
    assert part.states["/x/state"]["cycle"].tolist() == list(range(1900, 2100))
    for topic, rows in whole.states.items():
        assert all((rows[name] == part.states[topic][name]).all() for name in rows.dtype.names)


def test_a_time_beyond_the_end_says_what_there_is(path, parts):
    for each in (path, parts):
        with pytest.raises(CncError) as refused:
            selected(read_for_report(each, 20.0, 30.0, most_states=FEW), begin=20.0, end=30.0)
        assert str(refused.value) == (
            f"P-ERR-26011 recording {each}: nothing from 20 s to 30 s, it covers 0 s to 7.299 s; nothing was drawn"
        )


def test_a_part_that_was_not_closed_is_read_as_far_as_it_is_whole(parts, tmp_path):
    copy = shutil.copytree(parts, tmp_path / "run")
    last = copy / "run_3.mcap"
    last.write_bytes(last.read_bytes()[:-3000])
    reduced = read_for_report(copy, most_states=FEW)
    assert (reduced.complete, reduced.missing) == (False, NOT_CLOSED)
    assert reduced.last_cycle >= 5999
