"""Commands as people type them, checked before anything is sent."""

from math import isnan
from pathlib import Path

import pytest

from cnc_ptp.commands.client.command_words import read_arguments
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.client.machine_client import arguments_of, services_of
from cnc_ptp.nodes.client.requests import request_of
from cnc_ptp.nodes.unit.requests import given_arguments
from cnc_ptp.protocol.commands import COMMANDS


def read(kind, command, *words, unit="u"):
    return read_arguments(kind, unit, command, words, arguments_of(kind, unit, command))


@pytest.mark.parametrize(
    ("kind", "command", "words", "arguments"),
    [
        ("axis", "move_absolute", ["target=100", "velocity=50"], {"target": 100.0, "velocity": 50.0}),
        ("axis", "move_absolute", ["-12.5", "velocity=1e2"], {"target": -12.5, "velocity": 100.0}),
        ("axis", "halt", [], {}),
        ("axis", "power", ["off"], {"enabled": False}),
        ("axis", "power", ["on=TRUE"], {"enabled": True}),
        ("axis", "set_override_type", ["0x3"], {"type": 3}),
        ("axis", "couple", ["master=x", "factor=-0.5"], {"master": "x", "factor": -0.5}),
        ("axis", "decouple", ["target=0"], {"target": 0.0}),
        ("axis", "couple_cam", ["x", "file=/a/cam.csv"], {"master": "x", "file": "/a/cam.csv"}),
        ("spindle", "start", ["direction=cw", "speed_rpm=500"], {"direction": "cw", "speed_rpm": 500.0}),
        ("channel", "mdi", ["G1 X10 F500"], {"text": "G1 X10 F500"}),
        ("channel", "mdi", ["S[G136=80]"], {"text": "S[G136=80]"}),
        ("channel", "mdi", ["text=G1 X=1"], {"text": "G1 X=1"}),
        ("channel", "load", ["a/b.nc"], {"program": str(Path.cwd() / "a" / "b.nc")}),
        ("plc", "acknowledge", ["17"], {"id": 17}),
        ("axis", "external_setpoints", ["file=/a/setpoints.csv"], {"file": "/a/setpoints.csv"}),
    ],
)
def test_words_become_arguments_and_a_request(kind, command, words, arguments):
    read_words = read(kind, command, *words)
    assert read_words == arguments
    assert {name: type(value) for name, value in read_words.items()} == {n: type(v) for n, v in arguments.items()}
    request = request_of(services_of(kind)[command], read_words)
    assert {name: getattr(request, name) for name in arguments} == arguments


def test_a_request_says_what_it_has():
    service = services_of("axis")["decouple"]
    assert request_of(service, {"target": 0.0}).has_target and not request_of(service, {}).has_target
    service = services_of("axis")["set_feedforward"]
    assert not request_of(service, {"weight_percent": 50.0}).has_enabled
    assert isnan(request_of(service, {"enabled": True}).weight_percent), "unchanged, as in a scenario"


def test_texts_and_tables_travel_with_a_request():
    load = request_of(services_of("channel")["load"], {"program": "a", "text": "L b\nM30", "files": {"b": "M17"}})
    assert (load.text, [*load.file_names], [*load.file_texts]) == ("L b\nM30", ["b"], ["M17"])
    cam = request_of(services_of("axis")["couple_cam"], {"master": "x", "table": [[0, 1], [2, 3]]})
    assert ([*cam.master_points], [*cam.slave_points], cam.file) == ([0.0, 2.0], [1.0, 3.0], "")
    series = request_of(services_of("axis")["external_setpoints"], {"setpoints": [[1, 2, 3, 4, -1]]})
    (row,) = series.setpoints
    assert (row.cycle, row.position, row.velocity, row.acceleration, row.direction) == (1, 2.0, 3.0, 4.0, -1)


def test_rows_are_typed_as_yaml():
    words = ["axes=[x, y]", "points=[[0.6, [100, 50], [40, 0]], [1.2, [120.5, 0]]]", "path_tolerance=[1, 1e-1]"]
    given = read("plc", "follow_trajectory", *words)
    assert given == {
        "axes": ["x", "y"],
        "points": [[0.6, [100, 50], [40, 0]], [1.2, [120.5, 0]]],
        "path_tolerance": [1, 0.1],
    }
    given = read("plc", "follow_trajectory", *words[:2], "goal_time=0.5")
    request = request_of(services_of("plc")["follow_trajectory"], given)
    assert [list(point.velocities) for point in request.points] == [[40.0, 0.0], []]
    assert read("axis", "external_setpoints", "setpoints=[[10, 1.5, 0, 0, 1]]") == {"setpoints": [[10, 1.5, 0, 0, 1]]}
    assert read("axis", "couple_cam", "master=x", "table=[[0, 1], [2, 3]]")["table"] == [[0, 1], [2, 3]]


@pytest.mark.parametrize("row", [[0.5, [1, 2]], [0.5, [1, 2], [3, 4]], [0.5, [1, 2], [3, 4], [5, 6]]])
def test_a_trajectory_travels_with_a_request(row):
    given = {"axes": ["x", "c"], "points": [row], "path_tolerance": [0.5, 1.0]}
    request = request_of(services_of("plc")["follow_trajectory"], given)
    assert given_arguments(COMMANDS["plc"]["follow_trajectory"], request) == given


def test_what_is_no_point_of_a_trajectory_is_not_sent():
    with pytest.raises(CncError) as caught:
        request_of(services_of("plc")["follow_trajectory"], {"axes": ["x"], "points": [[0.5, "far"]]})
    assert str(caught.value) == (
        "P-ERR-22001 plc: follow_trajectory: point [0.5, 'far'] is not time, positions, velocities and accelerations; "
        "nothing was sent"
    )


@pytest.mark.parametrize(
    ("kind", "command", "words", "text"),
    [
        ("axis", "move_absolute", [], "22001 axis u: move_absolute refused: argument 'target' is missing"),
        ("axis", "move_absolute", ["far"], "22001 axis u: move_absolute refused: target = 'far' is not a number"),
        ("axis", "move_absolute", ["nan"], "22001 axis u: move_absolute refused: target = nan is not finite"),
        (
            "axis",
            "move_absolute",
            ["1", "speed=2"],
            "22001 axis u: move_absolute refused: unknown argument 'speed'; nothing was changed. Known: target, velocity, "
            "acceleration, deceleration, jerk",
        ),
        (
            "axis",
            "move_absolute",
            ["1", "target=2"],
            "22001 axis u: move_absolute refused: argument 'target' is given twice; nothing was sent",
        ),
        (
            "axis",
            "couple",
            ["x"],
            "22001 axis u: couple refused: 'x' has no name; write name=value. Known: factor, master; nothing was sent",
        ),
        (
            "axis",
            "halt",
            ["--now"],
            "22001 axis u: halt refused: '--now' has no name; write name=value. Known: none; nothing was sent",
        ),
        ("axis", "power", ["maybe"], "22001 axis u: power refused: enabled = 'maybe' is not a switch"),
        (
            "axis",
            "set_override_type",
            ["1.5"],
            "22001 axis u: set_override_type refused: type = '1.5' is not an integer",
        ),
        ("spindle", "start", ["direction=up", "speed_rpm=1"], "direction = 'up' is not cw or ccw"),
        (
            "axis",
            "move_absolute",
            ["target=200", "velocity=0"],
            "22001 axis u: move_absolute refused: velocity = 0 must be greater than 0; nothing was sent",
        ),
        ("spindle", "set_limits", ["max_speed_rpm=0"], "max_speed_rpm = 0 must be greater than 0; nothing was sent"),
        ("channel", "mdi", ["\udcff"], "22001 channel u: mdi refused: text is no text in UTF-8; nothing was sent"),
        ("axis", "couple", ["master=x", "factor=1", "above=z"], "unknown argument 'above'"),
        ("spindle", "stop", ["own=on"], "unknown argument 'own'"),
        ("axis", "fly", [], "22002 axis u: unknown command 'fly'; nothing was sent. Known: "),
        ("axis", "jog", ["5"], "22002 axis u: jog has no service, use: cnc_ptp jog u + --speed ..."),
        (
            "axis",
            "move_absolut",
            [],
            "unknown command 'move_absolut'; did you mean move_absolute?; nothing was sent. Known: ",
        ),
        ("axis", "lead", [], "22002 axis u: unknown command 'lead'; nothing was sent. Known: "),
    ],
)
def test_what_is_wrong_is_told_before_anything_is_sent(kind, command, words, text):
    with pytest.raises(CncError) as caught:
        read(kind, command, *words)
    assert text in str(caught.value)
