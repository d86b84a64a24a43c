"""Layouts of Foxglove and PlotJuggler: each path in them is a topic and a field of a recording of that machine."""

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

import cnc_ptp.recording
from cnc_ptp.commands.look.layout import layout
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import read_machine
from cnc_ptp.plots.layouts import views

LATHE = Path(__file__).parents[2] / "config" / "lathe.yaml"
PROGRAM = "%T\nG18 G90 M03 S400\nG00 X36 Z105\nG33 Z100 K1.5\nM05\nM30\n"


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Topics with their fields of a recording with a thread; events and commands among them."""
    folder = tmp_path_factory.mktemp("layouts")
    program, path = folder / "thread.nc", folder / "run.mcap"
    program.write_text(PROGRAM)
    command = [sys.executable, "-m", "cnc_ptp", "simulate", LATHE, "--program", program, "--record", path]
    subprocess.run(command, check=True, capture_output=True)
    with cnc_ptp.recording.open(path) as recording:
        return {name: set(topic.fields) for name, topic in recording.topics.items()}


def written(tmp_path, program, name):
    assert layout(str(LATHE), program, str(tmp_path / name)) == 0
    return (tmp_path / name).read_text()


def test_views_of_a_lathe():
    titles = [view.title for view in views(read_machine(str(LATHE)))]
    assert titles == ["channel", "X", "Z", "s", "s2", "Thread of channel", "Circle of channel"]


def test_paths_of_foxglove_exist(tmp_path, recorded):
    panels = json.loads(written(tmp_path, "foxglove", "lathe.json"))["configById"]
    paths = [path["value"] for panel in panels.values() for path in panel.get("paths", [])]
    paths += [panel["xAxisPath"]["value"] for panel in panels.values() if "xAxisPath" in panel]
    assert len(paths) > 30
    for path in paths:
        topic, field = path.split(".")
        assert field in recorded[topic], path
    topics = [panel["topicPath"] for panel in panels.values() if "topicPath" in panel]
    assert topics == ["/events", "/commands"]
    assert set(topics) <= recorded.keys()


def test_panels_of_foxglove_stand_somewhere(tmp_path):
    found = json.loads(written(tmp_path, "foxglove", "lathe.json"))

    def names(node):
        return [node] if isinstance(node, str) else names(node["first"]) + names(node["second"])

    tabs = [tab["layout"] for tab in found["configById"]["Tab!views"]["tabs"]]
    placed = names(found["layout"]) + [name for tab in tabs for name in names(tab)]
    assert sorted(placed) == sorted(found["configById"])


def test_curves_of_plotjuggler_exist(tmp_path, recorded):
    root = ElementTree.fromstring(written(tmp_path, "plotjuggler", "lathe.xml"))
    curves = list(root.iter("curve"))
    names = [curve.get("name") for curve in curves if curve.get("curve_x") is None]
    names += [curve.get(side) for curve in curves if curve.get("curve_x") for side in ("curve_x", "curve_y")]
    assert len(names) > 30
    for name in names:
        topic, _, field = name.rpartition("/")
        assert field in recorded[topic], name
    assert [plot.get("mode") for plot in root.iter("plot")].count("XYPlot") == 2


def test_the_ending_of_the_file(tmp_path):
    with pytest.raises(CncError) as caught:
        layout("config/mill.yaml", "foxglove", str(tmp_path / "mill.xml"))
    assert str(caught.value) == (
        f"P-ERR-27030 {tmp_path / 'mill.xml'}: the file name of a layout for foxglove must end in .json; "
        "nothing was started"
    )
