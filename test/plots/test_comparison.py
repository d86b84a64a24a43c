"""Two recordings on top of each other: alignment, differences against those that were put in, the page."""

import json
from dataclasses import replace

import numpy as np
import pytest
from recording_support import smooth_run

from cnc_ptp.commands.look.report import report
from cnc_ptp.errors import CncError
from cnc_ptp.plots.comparison import compared_rows, comparison_page, merged, page_of
from cnc_ptp.protocol.blocks import CommandRecord
from cnc_ptp.recording.difference import aligned, compared, differences, parameter_differences, program_start
from cnc_ptp.recording.long_recording import read_for_report
from cnc_ptp.recording.reader import read_recording

EVIL = "</script><script>alert(1)</script>"


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("comparison") / "run.mcap"
    smooth_run(path, 2.0)
    return path


@pytest.fixture
def first(path):
    return read_recording(path)


@pytest.fixture
def second(path):
    """Later by 300 cycles; x is off by 0.25 mm from cycle 500 (of the first one) on, by 0.75 mm in cycle 900."""
    recorded = read_recording(path)
    for rows in recorded.states.values():
        rows["cycle"] += np.uint64(300)
    recorded.events = [replace(event, cycle=event.cycle + 300) for event in recorded.events]
    x = recorded.states["/x/state"]
    x["set_position"][500:] += 0.25
    x["set_position"][900] += 0.5
    return recorded


def test_programs_begin_at_one_time(first, second):
    a, b = aligned(first, second)
    assert program_start(a) == program_start(b) == 310
    assert [event.cycle for event in a.events] == [event.cycle for event in b.events]
    assert first.states["/x/state"]["cycle"][0] == 0  # the recording itself is unchanged


def test_recordings_begin_at_one_time(first, second):
    rows = second.states["/s/state"]
    second.states["/s/state"] = np.concatenate([rows[:1], rows])
    second.states["/s/state"]["cycle"][0] = 100
    a, b = aligned(first, second, "start")
    assert (a.states["/x/state"]["cycle"][0], b.states["/x/state"]["cycle"][0]) == (100, 300)


def test_differences_are_those_that_were_put_in(first, second):
    found = {(each.unit, each.field): each for each in differences(*aligned(first, second))}
    x = found["x", "set_position"]
    assert x.largest == pytest.approx(0.75, abs=1e-12)
    assert (x.parted, x.cycle) == (800, 1200)
    assert x.first == 40.0
    others = [each for key, each in found.items() if key != ("x", "set_position")]
    assert {(each.largest, each.parted) for each in others} == {(0.0, -1)}
    assert {each.unit for each in others} == {"channel", "s", "x", "y", "z"}


def test_rows_have_the_lines_of_both_and_the_difference(first, second):
    rows = {row.heading: row for row in compared_rows(aligned(first, second), {})}
    position = rows["X: position in mm"]
    assert [line.name for line in position.lines] == ["A set", "A actual", "B set", "B actual"]
    assert len({line.colour for line in position.lines}) == 4
    difference, actual = rows["X: position, B − A in mm"].lines
    assert difference.rows["difference"][899:901] == pytest.approx([0.25, 0.75], abs=1e-12)
    assert not np.any(actual.rows["difference"])


def test_a_unit_that_only_one_has_is_drawn(first, second):
    del second.states["/y/state"]
    rows = {row.heading: row for row in compared_rows(aligned(first, second), {})}
    assert [line.name for line in rows["Y: position in mm"].lines] == ["A set", "A actual"]
    assert "Y: position, B − A in mm" not in rows


def test_states_events_and_commands_of_both(first, second):
    both = merged(aligned(first, second))
    assert {"/x A/state", "/x B/state"} <= both.states.keys()
    assert {event.source for event in both.events} == {
        f"{which} {of}" for which in "AB" for of in ("channel", "s", "y")
    }
    assert len(both.commands) == 6


def test_the_page(first, second):
    first.machine_yaml = "/x:\n  ros__parameters: {getriebe: {'0': {kv: 5000}}}\n"
    second.machine_yaml = first.machine_yaml.replace("5000", "8000")
    for recorded, text in ((first, "N10 G1 X1\nM30\n"), (second, f"N10 G1 X2\nM30\n({EVIL})\n")):
        arguments = json.dumps({"program": "a.nc", "text": text})
        recorded.commands = [CommandRecord(0, "channel", "load", arguments, True, 0, "")]
    second.complete, second.missing = False, EVIL
    page = comparison_page(first, second, names=("old", EVIL), date="2026-05-04")
    assert "<h1>Comparison of two recordings</h1>" in page
    assert EVIL not in page
    assert "B is incomplete: &lt;/script&gt;" in page
    assert "<b>0.800 s</b><span>set values part at</span>" in page
    assert "<b>+0.000 s</b><span>program time, B − A</span>" in page
    row = '<td class="text">x.getriebe.0.kv</td><td class="text">5000</td><td class="text">8000</td>'
    assert row in page
    assert "-N10 G1 X1\n+N10 G1 X2" in page
    assert page.count('class="plotly-graph-div"') == 3


def test_equal_recordings(first):
    page = comparison_page(first, first)
    assert "<b>never</b><span>set values part at</span>" in page
    assert "The machine files are equal." in page
    assert "<h2>Program</h2>" not in page


def test_what_there_is_to_say_in_short(first, second):
    assert compared(first, second).lines({"y": "deg"}) == [
        "B − A: at most 0.75 mm (x set position at 1.200 s); set values part at 0.800 s"
    ]
    assert compared(first, first).lines({}) == [
        "B − A: no difference in the values that are compared; set values never part"
    ]
    for rows in second.states.values():
        rows["cycle"] += np.uint64(10_000)
    assert compared(first, second, "run").lines({}) == ["A and B have no cycle in common"]


def test_units_that_only_one_has_are_named(first, second):
    del second.states["/y/state"], second.states["/z/state"], first.states["/s/state"]
    both = compared(first, second)
    assert both.lines({})[1:] == ["Only A has y, z. Only B has s."]
    assert '<p class="warn">Only A has y, z. Only B has s.</p>' in page_of(both)
    assert '<p class="warn">' not in comparison_page(first, first)


def test_parameters_without_a_readable_machine_file(first, second):
    first.machine_yaml, second.machine_yaml = "[", "/x: {ros__parameters: {a: 1}}"
    assert parameter_differences(first, second) == [("x.a", "–", "1")]


def test_units_in_common_are_needed(first, second):
    second.states = {f"/other{topic}": rows for topic, rows in second.states.items()}
    with pytest.raises(CncError) as caught:
        aligned(first, second)
    assert str(caught.value) == (
        f"P-ERR-26022 recordings {first.path} and {second.path}: have no unit in common; nothing was drawn"
    )


def test_one_cycle_time_is_needed(first, second):
    second.metadata["cycle_time_ns"] = "2000000"
    with pytest.raises(CncError) as caught:
        comparison_page(first, second)
    assert str(caught.value) == (
        f"P-ERR-26022 recordings {first.path} and {second.path}: cycle times of 1 ms and 2 ms; nothing was drawn"
    )


def test_a_recording_that_is_too_long(first, path):
    with pytest.raises(CncError) as caught:
        aligned(first, read_for_report(path, most_states=100))
    assert str(caught.value) == (
        f"P-ERR-26021 recording {path}: too long to be compared; nothing was drawn, choose --from and --to"
    )


def test_the_command(path, tmp_path, capsys):
    output = tmp_path / "difference.html"
    assert report(str(path), str(output), 0.5, 1.0, ["x", "y"], compare=str(path), align="start") == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{output}: {output.stat().st_size / 1e6:.1f} MB, cycles 500 to 999",
        "B − A: no difference in the values that are compared; set values never part",
    ]
    assert "Comparison of two recordings" in output.read_text()
    with pytest.raises(CncError, match="would overwrite the other recording"):
        report(str(tmp_path / "none.mcap"), str(path), None, None, (), compare=str(path))
