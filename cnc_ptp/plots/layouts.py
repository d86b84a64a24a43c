"""Layouts of Foxglove and PlotJuggler for a machine: which plots of which topics stand where.

`views` says what is worth looking at; `foxglove` and `plotjuggler` write it in the format of each program.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

from cnc_ptp.parameters import ChannelParameters, MachineParameters
from cnc_ptp.plots.colours import BY_AXIS
from cnc_ptp.recording.rows import axis_label

COLOURS = [*(pair.set for pair in BY_AXIS), *(pair.actual for pair in BY_AXIS)]
EVENTS, COMMANDS = "/events", "/commands"


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a topic, and its name in a legend."""

    topic: str
    name: str
    label: str


@dataclass(frozen=True, slots=True)
class Plot:
    """Fields over time, or over the field `x`; `states`: as bands, where the program can draw them."""

    title: str
    fields: tuple[Field, ...]
    x: Field | None = None
    states: bool = False


@dataclass(frozen=True, slots=True)
class View:
    """Plots on one tab."""

    title: str
    plots: tuple[Plot, ...]

    def fields(self) -> Iterator[Field]:
        for plot in self.plots:
            yield from plot.fields
            if plot.x is not None:
                yield plot.x


def views(machine: MachineParameters) -> list[View]:
    """Axes, channels, spindles, threads and circles, as far as the machine has them."""
    found = [_axis(name, "deg" if axis.rotary else "mm") for name, axis in machine.axes.items()]
    found = [*map(_channel, machine.channels.values()), *found, *map(_spindle, machine.spindles)]
    for channel in machine.channels.values():
        linear = [axis.node for axis in channel.axes if not machine.axes[axis.node].rotary]
        if channel.main_spindle and linear:
            found.append(_thread(channel.name))
        if len(linear) > 1:
            found.append(_circle(channel, linear[:2]))
    return found


def _state(unit: str, *names: str) -> tuple[Field, ...]:
    """`set_position` is `set position` in a legend."""
    return tuple(Field(f"/{unit}/state", name, name.replace("_", " ")) for name in names)


def _axis(name: str, distance: str) -> View:
    return View(
        axis_label(name),
        (
            Plot("State", _state(name, "state"), states=True),
            Plot(f"Position in {distance}", _state(name, "set_position", "actual_position")),
            Plot(f"Velocity in {distance}/s", _state(name, "set_velocity", "actual_velocity")),
            Plot(f"Acceleration in {distance}/s²", _state(name, "set_acceleration")),
            Plot(f"Following error in {distance}", _state(name, "following_error")),
            Plot("Torque", _state(name, "additive_torque", "actual_torque")),
        ),
    )


def _channel(channel: ChannelParameters) -> View:
    name, nodes = channel.name, [axis.node for axis in channel.axes]
    errors = tuple(Field(f"/{node}/state", "following_error", axis_label(node)) for node in nodes)
    return View(
        name,
        (
            Plot("State", _state(name, "state"), states=True),
            Plot("Feed in mm/s", _state(name, "programmed_feed", "path_velocity")),
            Plot("Override in %", _state(name, "override_percent")),
            Plot("Line of the program", _state(name, "line")),
            Plot("Distance to go in mm", _state(name, "distance_to_go")),
            Plot("Following errors", errors),
        ),
    )


def _spindle(name: str) -> View:
    return View(
        name,
        (
            Plot("State", _state(name, "state"), states=True),
            Plot("Speed in rpm", _state(name, "programmed_speed_rpm", "set_speed_rpm", "actual_speed_rpm")),
            Plot("Angle in deg", _state(name, "set_position_deg", "actual_position_deg", "target_position_deg")),
            Plot("Following error in deg", _state(name, "following_error_deg")),
            Plot("Override in %", _state(name, "override_percent")),
        ),
    )


def _thread(channel: str) -> View:
    def of(*names: str) -> tuple[Field, ...]:
        return tuple(Field(f"/{channel}/thread", name, name.replace("_", " ")) for name in names)

    return View(
        f"Thread of {channel}",
        (
            Plot("Pitch error in mm", of("set_pitch_error", "actual_pitch_error")),
            Plot("Phase error in deg", of("set_phase_error_deg", "actual_phase_error_deg")),
            Plot("Lead in mm", of("lead")),
        ),
    )


def _circle(channel: ChannelParameters, axes: Sequence[str]) -> View:
    first, second = axes
    title = f"{axis_label(second)} over {axis_label(first)}"

    def over(kind: str) -> Plot:
        x = Field(f"/{first}/state", f"{kind}_position", axis_label(first))
        return Plot(f"{title}, {kind}", (Field(f"/{second}/state", f"{kind}_position", f"{kind} position"),), x)

    errors = tuple(Field(f"/{axis}/state", "following_error", axis_label(axis)) for axis in axes)
    return View(f"Circle of {channel.name}", (over("actual"), over("set"), Plot("Following errors in mm", errors)))


def foxglove(machine: MachineParameters) -> str:
    """A layout as Foxglove imports it (JSON): a tab for each view, beside them events and commands."""
    panels: dict[str, Any] = {}
    tabs = []
    for number, view in enumerate(views(machine)):
        names = []
        for place, plot in enumerate(view.plots):
            kind = "StateTransitions" if plot.states else "Plot"
            names.append(f"{kind}!{number}-{place}")
            panels[names[-1]] = _foxglove_panel(plot)
        tabs.append({"title": view.title, "layout": _split(names, "column")})
    panels["Tab!views"] = {"activeTabIdx": 0, "tabs": tabs}
    for name, topic in (("RawMessages!events", EVENTS), ("RawMessages!commands", COMMANDS)):
        panels[name] = {"topicPath": topic, "diffEnabled": False, "expansion": "all"}
    side = _split(["RawMessages!events", "RawMessages!commands"], "column")
    layout = {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {"direction": "row", "first": "Tab!views", "second": side, "splitPercentage": 76},
    }
    return json.dumps(layout, indent=1, ensure_ascii=False) + "\n"


def _foxglove_panel(plot: Plot) -> dict[str, Any]:
    paths = [
        {
            "value": f"{field.topic}.{field.name}",
            "label": field.label,
            "enabled": True,
            "color": colour,
            "timestampMethod": "receiveTime",
        }
        for field, colour in zip(plot.fields, COLOURS, strict=False)
    ]
    panel: dict[str, Any] = {"foxglovePanelTitle": plot.title, "paths": paths, "isSynced": True}
    if plot.states:
        return panel
    panel |= {"showLegend": True, "legendDisplay": "floating", "showPlotValuesInLegend": True}
    panel |= {"showXAxisLabels": True, "showYAxisLabels": True, "xAxisVal": "timestamp"}
    if plot.x is not None:
        value = f"{plot.x.topic}.{plot.x.name}"
        panel |= {
            "xAxisVal": "custom",
            "xAxisPath": {"value": value, "enabled": True, "timestampMethod": "receiveTime"},
        }
    return panel


def _split(names: Sequence[str], direction: str) -> Any:
    """Panels of one size beside each other or below each other."""
    if len(names) == 1:
        return names[0]
    return {
        "direction": direction,
        "first": names[0],
        "second": _split(names[1:], direction),
        "splitPercentage": round(100 / len(names), 3),
    }


def plotjuggler(machine: MachineParameters) -> str:
    """A layout as PlotJuggler loads it (XML): a tab for each view."""
    root = ElementTree.Element("root")
    tabs = ElementTree.SubElement(root, "tabbed_widget", {"name": "Main Window", "parent": "main_window"})
    for view in views(machine):
        tab = ElementTree.SubElement(tabs, "Tab", tab_name=view.title, containers="1")
        container = ElementTree.SubElement(tab, "Container")
        count = len(view.plots)
        sizes = ";".join(f"{1.0 / count:.6f}" for _ in view.plots)
        splitter = ElementTree.SubElement(container, "DockSplitter", orientation="-", count=str(count), sizes=sizes)
        for plot in view.plots:
            area = ElementTree.SubElement(splitter, "DockArea", name=plot.title)
            mode = "TimeSeries" if plot.x is None else "XYPlot"
            drawn = ElementTree.SubElement(area, "plot", mode=mode, style="Lines", flip_x="false", flip_y="false")
            for field, colour in zip(plot.fields, COLOURS, strict=False):
                _add_curve(drawn, field, plot.x, colour)
    ElementTree.SubElement(tabs, "currentTabIndex", index="0")
    ElementTree.indent(root, " ")
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _add_curve(plot: ElementTree.Element, field: Field, x: Field | None, colour: str) -> None:
    name = f"{field.topic}/{field.name}"
    if x is None:
        ElementTree.SubElement(plot, "curve", name=name, color=colour)
        return
    other = f"{x.topic}/{x.name}"
    ElementTree.SubElement(plot, "curve", name=f"{field.label} of {x.label}", color=colour, curve_x=other, curve_y=name)


FORMATS = {"foxglove": (foxglove, ".json"), "plotjuggler": (plotjuggler, ".xml")}
