"""`cnc_ptp circle`: the circle test of a machine, run offline, as table and picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from cnc_ptp.channel.program_check import NO_CHANNEL
from cnc_ptp.commands.commissioning.circle_page import circle_page
from cnc_ptp.commands.commissioning.circle_picture import circle_picture
from cnc_ptp.commands.commissioning.circle_report import CircleTest, Variant, VariantResult, circle_lines
from cnc_ptp.commands.commissioning.trial_run import run_trial
from cnc_ptp.commands.console import RUN_FAILED, print_lines
from cnc_ptp.commands.output_file import check_output, write_output
from cnc_ptp.commands.picture_file import check_picture, picture_kind
from cnc_ptp.commissioning.circle_program import CircleProgram, Plane, circle_program, find_plane, measured_turn
from cnc_ptp.commissioning.faults import BAD_CIRCLE, BAD_PLANE, NOTHING_TO_COMPARE
from cnc_ptp.commissioning.roundness import bidirectional_deviation, evaluate_circle
from cnc_ptp.errors import CncError
from cnc_ptp.machine.program_files import read_file
from cnc_ptp.machine.run_entries import check_program
from cnc_ptp.parameters import AxisParameters, MachineParameters, complete_text, load_machine
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command

DIRECTIONS = {"both": (False, True), "ccw": (False,), "cw": (True,)}
FILE = "circle.nc"
LARGEST = 1e5
"""mm and mm/min; beyond it is no circle test."""
LONGEST_TEST = 3600.0
"""s; all turns of a run, which keeps its positions in memory."""
SMALLEST_RADIUS = 1e-3
"""mm; below the increments of an encoder there is no circle."""


@dataclass(frozen=True, slots=True)
class Place:
    """The two axes of the plane: nodes, and where the centre is (mm)."""

    channel: str
    nodes: tuple[str, str]
    centre: tuple[float, float]


def circle(
    machine: str,
    radius: float,
    feed: float,
    plane: str,
    centre: tuple[float, float] | None,
    direction: str,
    feedforward: bool,
    friction: bool | None,
    compare: str | None,
    outputs: Sequence[str],
    magnification: float | None,
    record: str | None = None,
) -> int:
    """Runs the circle test of all variants; `record` keeps the runs. Status 1 when a run failed."""
    check_numbers(radius=radius, feed=feed, centre=centre, magnification=magnification)
    for output in outputs:
        check_picture(output, machine_file=machine)
    text = complete_text(read_file("machine file", machine), machine)
    parameters = load_machine(text, machine)
    found = find_plane(plane)
    place = find_place(parameters, found, centre)
    chosen = variants(feedforward, friction, compare)
    check_comparison(parameters, place, chosen)
    compensated = compensated_axes(parameters, found, place)
    programs = [
        circle_program(
            found,
            centre=place.centre,
            radius=radius,
            feed=feed,
            directions=DIRECTIONS[direction],
            before=variant.blocks(compensated),
        )
        for variant in chosen
    ]
    check_time(programs[0], feed)
    records = record_files(record, len(chosen))
    for path in records:
        check_output(path, machine_file=machine)
    results = run_variants(parameters, place, list(zip(chosen, programs, records, strict=True)), feed, text)
    if results is None:
        return RUN_FAILED
    others = tuple(axis for axis in found.axes if axis not in compensated)
    show(CircleTest(found.axes, place.centre, radius, feed, results, others), outputs, magnification)
    return 0


def record_files(record: str | None, runs: int) -> list[str | None]:
    """The recording of each run: `record`, of several runs with their number behind its name."""
    if record is None or runs == 1:
        return [record] * runs
    path = Path(record)
    return [str(path.with_name(f"{path.stem}_{number}{path.suffix}")) for number in range(1, runs + 1)]


def run_variants(
    machine: MachineParameters,
    place: Place,
    runs: Sequence[tuple[Variant, CircleProgram, str | None]],
    feed: float,
    machine_text: str,
) -> tuple[VariantResult, ...] | None:
    """The results of all runs, None when one failed. Raises ProgramError before the first of them."""
    for _, program, _ in runs:
        check_program(machine, program.text, FILE)
    results = []
    for variant, program, record in runs:
        result = run_variant(machine, place, program, variant, feed, record, machine_text)
        if result is None:
            return None
        results.append(result)
    return tuple(results)


def check_numbers(
    *, radius: float, feed: float, centre: tuple[float, float] | None, magnification: float | None
) -> None:
    """Raises CncError 27020 for a number outside its range."""
    numbers = [("radius", radius, SMALLEST_RADIUS, "mm"), ("feed", feed, 0.0, "mm/min")]
    numbers += [("centre", value, -LARGEST, "mm") for value in centre or ()]
    if magnification is not None:
        numbers.append(("magnification", magnification, 0.0, ""))
    for name, value, least, unit in numbers:
        above = least == 0.0
        if not least <= value <= LARGEST or (above and value == 0.0):
            shown = f"{value:g} {unit}".rstrip()
            permitted = f"above 0 and up to {LARGEST:g}" if above else f"within {least:g} ... {LARGEST:g}"
            raise CncError(BAD_CIRCLE, f"{name} {shown} is not {permitted}", "nothing was started")


def check_time(program: CircleProgram, feed: float) -> None:
    """Raises CncError 27020 for a circle that would take longer than a test lasts."""
    seconds = machine_time(program, feed)
    if seconds > LONGEST_TEST:
        circle = f"radius {program.radius:g} mm at feed {feed:g} mm/min"
        limit = f"{seconds:g} s of machine time, the limit is {LONGEST_TEST:.0f} s"
        raise CncError(BAD_CIRCLE, f"{circle} takes {limit}", "nothing was started")


def machine_time(program: CircleProgram, feed: float) -> float:
    """About how long the run of a program takes, s: its turns, with a second before each and at the end."""
    turn_time = 60.0 * 2.0 * math.pi * program.radius / feed
    return len(program.turns) * (turn_time + 1.0) + 1.0


def find_place(machine: MachineParameters, plane: Plane, centre: tuple[float, float] | None) -> Place:
    """The axes of the plane in the first channel; the centre is their position unless given.

    Raises CncError 26112 without channel, 27024 where it has not both axes.
    """
    if not machine.channels:
        raise CncError(NO_CHANNEL, "the machine has no channel to run a circle", "nothing was started")
    channel = next(iter(machine.channels.values()))
    nodes = {axis.name: axis.node for axis in channel.axes}
    missing = [axis for axis in plane.axes if axis not in nodes]
    if missing:
        known = ", ".join(nodes)
        raise CncError(
            BAD_PLANE,
            f"channel {channel.name} has no axis {' and no axis '.join(missing)} for plane {''.join(plane.axes)}",
            f"nothing was started. Axes: {known}",
        )
    first, second = (machine.axes[nodes[axis]] for axis in plane.axes)
    for axis in (first, second):
        if axis.rotary:
            raise CncError(
                BAD_PLANE, f"axis {axis.name} is rotary, a circle needs two linear axes", "nothing was started"
            )
    return Place(channel.name, (first.name, second.name), centre or (first.start_position, second.start_position))


def variants(feedforward: bool, friction: bool | None, compare: str | None) -> list[Variant]:
    """The variants to run: one, or the compared function off and on."""
    forwards = (False, True) if compare in ("feedforward", "both") else (feedforward,)
    frictions: tuple[bool | None, ...] = (False, True) if compare in ("friction", "both") else (friction,)
    return [Variant(forward, compensation) for compensation in frictions for forward in forwards]


def check_comparison(machine: MachineParameters, place: Place, chosen: Sequence[Variant]) -> None:
    """Raises CncError 27023 where feedforward or friction compensation would be switched on without any effect."""
    axes = [machine.axes[node] for node in place.nodes]
    names = ", ".join(axis.name for axis in axes)
    if any(variant.feedforward for variant in chosen) and not any(map(_feeds_forward, axes)):
        raise CncError(
            NOTHING_TO_COMPARE,
            f"axes {names}: feedforward has no effect, vorsteuer.vorsteuerung (P-AXIS-00223) is NONE",
            "nothing was started",
        )
    if any(variant.friction for variant in chosen) and not any(axis.control.friction.active for axis in axes):
        raise CncError(
            NOTHING_TO_COMPARE,
            f"axes {names}: friction compensation has no effect, it needs lr_param.frict_comp (P-AXIS-00522) and a "
            "table",
            "nothing was started, see cnc_ptp identify friction",
        )


def compensated_axes(machine: MachineParameters, plane: Plane, place: Place) -> list[str]:
    """The axes of the plane whose friction compensation can be switched."""
    pairs = zip(plane.axes, place.nodes, strict=True)
    return [axis for axis, node in pairs if machine.axes[node].control.friction.active]


def _feeds_forward(axis: AxisParameters) -> bool:
    return axis.control.feedforward.mode != 0


def run_variant(
    machine: MachineParameters,
    place: Place,
    program: CircleProgram,
    variant: Variant,
    feed: float,
    record: str | None,
    machine_text: str,
) -> VariantResult | None:
    """The result of one run, None when it failed (reported on standard error)."""
    job = [
        Entry(0.0, Command(place.channel, "load", {"program": FILE, "text": program.text, "dialect": "twincat"})),
        Entry(0.0, Command(place.channel, "start", {})),
    ]
    trial = run_trial(
        machine,
        job,
        fields={place.channel: ("line", "path_velocity"), **dict.fromkeys(place.nodes, ("actual_position",))},
        seconds=machine_time(program, feed),
        label=variant.name,
        record=record,
        machine_text=machine_text,
    )
    if trial.failed:
        trial.print_faults()
        return None
    points = np.column_stack([trial.columns[node]["actual_position"] for node in place.nodes])
    line = trial.columns[place.channel]["line"].astype(np.int64)
    path_feed = trial.columns[place.channel]["path_velocity"] * 60.0
    turns, circles, slowest = [], [], math.inf
    for clockwise in dict.fromkeys(turn.clockwise for turn in program.turns):
        chosen = measured_turn(program, clockwise, line, points)
        turns.append(points[chosen])
        slowest = min(slowest, float(path_feed[chosen].min()))
        circles.append(evaluate_circle(points[chosen], radius=program.radius, clockwise=clockwise))
    return VariantResult(variant, tuple(circles), bidirectional_deviation(turns), slowest)


def show(test: CircleTest, outputs: Sequence[str], magnification: float | None) -> None:
    """Prints the table and writes the pictures."""
    console = Console(highlight=False, soft_wrap=True)
    print_lines(console, circle_lines(test))
    for output in outputs:
        kind = picture_kind(output)
        page = kind == "html"
        write_output(output, circle_page(test, magnification) if page else circle_picture(test, magnification, kind))
        console.print(f"{output} written", markup=False)
