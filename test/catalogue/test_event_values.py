"""Events carry the numbers of their text with units, and of them limit, actual, faulty, expected, corrected value."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest
from builtin_interfaces.msg import Time
from machine_support import axis_bench, spindle_bench
from rclpy.serialization import serialize_message

from cnc_ptp.machine.wiring import build_units
from cnc_ptp.nodes.convert import event_of, event_to_message, message_to_record, record_to_message
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import NO_VALUE, CommandRecord, Event, EventValue, Severity
from cnc_ptp.protocol.event_values import event_values, read_event_values
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.writer import Recording

ROOT = Path(__file__).parents[2]
EVENT = Event(
    7, "x", Severity.WARNING, 23012, "jerk", 3,
    [EventValue("jerk", 5.0, "mm/s³", "faulty"), EventValue("corrected", 2.0, "mm/s³", "corrected")],
)  # fmt: skip


def test_a_refused_command_has_its_limit_and_what_was_commanded() -> None:
    bench = axis_bench()
    limit = bench.unit._axis.parameters.max_velocity
    bench.give("move_velocity", velocity=limit + 1.0)
    event = bench.unit.events[-1]
    assert event.error_id == 23004
    assert event.faulty == EventValue("velocity", limit + 1.0, "mm/s", "faulty")
    assert event.limit == EventValue("limit", limit, "mm/s", "limit")
    assert event.actual == event.expected == event.corrected == NO_VALUE


def test_the_argument_of_a_command_gives_the_unit() -> None:
    bench = axis_bench()
    bench.give("move_absolute", target=1.0, acceleration=1e9)
    event = bench.unit.events[-1]
    assert (event.faulty, event.limit.unit) == (EventValue("value", 1e9, "mm/s²", "faulty"), "mm/s²")


def test_a_speed_that_is_limited_has_the_one_that_is_used() -> None:
    bench = spindle_bench()
    bench.accepted("set_limits", min_speed_rpm=0.0, max_speed_rpm=500.0)
    record = bench.give("start", direction="cw", speed_rpm=900.0)
    assert record.warning_id == 24029
    event = bench.unit.events[-1]
    assert event.faulty == EventValue("speed", 900.0, "rpm", "faulty")
    assert event.corrected.unit == "rpm"
    assert event.corrected.value == pytest.approx(500.0)


def test_a_rotary_axis_counts_in_degrees() -> None:
    values = event_values({"position": 400.0, "limit": 360.0, "state": "Homing"}, "deg")
    assert values == [EventValue("position", 400.0, "deg", "faulty"), EventValue("limit", 360.0, "deg", "limit")]
    assert event_values({"velocity": 1.0, "time": 2.0, "code": 3}, "deg") == [
        EventValue("velocity", 1.0, "deg/s", "faulty"),
        EventValue("time", 2.0, "s"),
        EventValue("code", 3.0, "", "faulty"),
    ]


def test_a_notice_about_the_machine_file_has_the_value_that_is_used(tmp_path: Path) -> None:
    text = (ROOT / "config" / "mill.yaml").read_text(encoding="utf-8")
    machine = tmp_path / "m.yaml"
    machine.write_text(
        text.replace(
            "/x:\n  ros__parameters:\n", "/x:\n  ros__parameters:\n    vorsteuer.velocity_delay_time: 60000\n", 1
        )
    )
    event = next(event for event in build_units(read_machine(str(machine)))["plc"].events if event.error_id == 70349)
    assert event.faulty == EventValue("P-AXIS-00389", 60000.0, "µs", "faulty")
    assert (event.limit.unit, event.corrected) == ("µs", EventValue("corrected", 0.0, "µs", "corrected"))


# as a message, and in recordings


def test_messages_have_them_as_fields() -> None:
    message = event_to_message(EVENT, Time())
    assert (message.faulty.name, message.faulty.value, message.faulty.unit) == ("jerk", 5.0, "mm/s³")
    assert (message.corrected.value, message.limit.name) == (2.0, "")
    assert event_of(serialize_message(message)) == EVENT


def test_recordings_have_them_too(tmp_path: Path) -> None:
    path = tmp_path / "r.mcap"
    with Recording(path, (ROOT / "config" / "mill.yaml").read_text(encoding="utf-8")) as recording:
        recording.event(EVENT)
        recording.command(CommandRecord(1, "x", "stop", "{}", True, 0, "P-WARN-23073 nothing", warning_id=23073))
    recorded = read_recording(path)
    assert recorded.events == [EVENT]
    assert recorded.commands[0].warning_id == 23073


def test_events_of_older_recordings_are_read() -> None:
    """Those without roles, and the oldest, without values."""
    value = SimpleNamespace(name="limit", value=1.0, unit="mm")
    assert read_event_values(SimpleNamespace(values=[value])) == [EventValue("limit", 1.0, "mm")]
    assert read_event_values(SimpleNamespace()) == []


def test_the_number_of_a_warning_comes_with_its_record() -> None:
    bench = axis_bench()
    record = bench.give("stop")
    assert (record.accepted, record.warning_id) == (True, 23073)
    assert message_to_record(record_to_message(record, Time())) == record
    assert message_to_record(record_to_message(record, Time())).warning_id == 23073
