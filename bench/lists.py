"""The vendor's lists of a large machine: 32 axes and 16 spindles, every parameter of each in its list."""

from __future__ import annotations

from collections.abc import Iterator

from bench.figures import Effort, Figure, ShowProgress, median_of, stopwatch
from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.lists.exporting import export_lists
from cnc_ptp.parameters.lists.importing import import_lists
from cnc_ptp.parameters.lists.kinds import AXIS, kind_of
from cnc_ptp.parameters.lists.values import to_list

AXES, SPINDLES = 32, 16
GOAL = 2.0
"""Seconds."""


def lists_of(axes: int, spindles: int) -> dict[str, bytes]:
    """The lists of a channel with axes and spindles; each has every parameter of its list, with a remark."""
    numbers = range(1, axes + spindles + 1)
    files = {f"achs_mds_{name_of(number, axes)}.lis": axis_list(number, number > axes) for number in numbers}
    return {**files, "sda_mds_channel.lis": channel_list(axes, spindles)}


def name_of(number: int, axes: int) -> str:
    return f"x{number}" if number <= axes else f"s{number - axes}"


def axis_list(number: int, spindle: bool) -> bytes:
    kind, implied = ("spindle", {"kenngr.achs_typ": "ACHSTYP_SPINDEL"}) if spindle else ("axis", {})
    defaults = ParameterSet("axis", kind, Place("", 1, 1), implied={**implied, "kopf.achs_nr": number})
    lines = [f"# axis {number}"]
    for declaration, indexes, value in defaults.parameters():
        if kind_of(declaration) is AXIS:
            text = to_list(declaration, value, "")
            lines.append(f"{declaration.list_style_name(indexes):44} {text:12} # {declaration.id} of {number}")
    return "\n".join([*lines, ""]).encode()


def channel_list(axes: int, spindles: int) -> bytes:
    lines = [f"gruppe[0].achs_anzahl {axes}", f"spdl_anzahl {spindles}"]
    for index in range(axes):
        lines += [
            f"gruppe[0].achse[{index}].{line}" for line in (f"bezeichnung X{index + 1}", f"log_achs_nr {index + 1}")
        ]
    for index in range(spindles):
        number = axes + index + 1
        lines += [f"spindel[{index}].{line}" for line in (f"bezeichnung S{index + 1}", f"log_achs_nr {number}")]
    if spindles:
        lines += [f"main_spindle_ax_nr {axes + 1}", "main_spindle_name S"]
    return "\n".join([*lines, ""]).encode()


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Import of the lists, and export of the machine that they are."""
    axes, spindles = effort.scaled(AXES), effort.scaled(SPINDLES)
    files = lists_of(axes, spindles)
    text = import_lists("lists", files).text
    lines = sum(content.count(b"\n") for content in files.values())

    def seconds_of_import() -> float:
        with stopwatch() as watch:
            import_lists("lists", files)
        return watch.wall

    def seconds_of_export() -> float:
        with stopwatch() as watch:
            export_lists(text, "machine.yaml")
        return watch.wall

    show(f"{len(files)} lists")
    goal = GOAL if (axes, spindles) == (AXES, SPINDLES) else None
    name = f"{axes} axes, {spindles} spindles, {lines} lines"
    yield Figure(f"import: {name}", median_of(effort.runs, seconds_of_import), "s", goal=goal, at_most=True)
    yield Figure(f"export: {name}", median_of(effort.runs, seconds_of_export), "s")
