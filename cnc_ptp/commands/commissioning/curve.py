"""`cnc_ptp curve fit`: the acceleration curve of a spindle from interpolation points."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console

from cnc_ptp.commands.commissioning.curve_page import curve_page
from cnc_ptp.commands.commissioning.curve_picture import curve_picture
from cnc_ptp.commands.commissioning.curve_report import curve_lines, curve_yaml
from cnc_ptp.commands.console import RUN_FAILED, print_error, print_lines
from cnc_ptp.commands.output_file import check_output, deliver, write_output
from cnc_ptp.commands.picture_file import KINDS, picture_kind
from cnc_ptp.commissioning.curve_fit import CurveFit, curve_fault, fit_curve
from cnc_ptp.commissioning.curve_points import SPEED_UNITS, parse_point, parse_point_file
from cnc_ptp.commissioning.faults import BAD_OUTPUT, BAD_SPINDLE_NAME
from cnc_ptp.errors import CncError
from cnc_ptp.machine.program_files import read_file
from cnc_ptp.parameters.read.machine_sections import name_trouble

YAML = ("yaml", "yml")


def curve_fit(
    kind: str,
    points: Sequence[str],
    csv: str | None,
    unit: str,
    limit: float | None,
    top_speed: float | None,
    a_min: int,
    spindle: str,
    gear: int,
    outputs: Sequence[str],
) -> int:
    """Fits, prints the table and the lines for the machine file. Status 1 when no spindle can run on the curve."""
    if trouble := name_trouble(spindle, {}):
        raise CncError(BAD_SPINDLE_NAME, f"spindle name '{spindle}' {trouble}", "nothing was fitted")
    check_outputs(outputs, csv)
    given = (
        [parse_point(point, unit) for point in points]
        if csv is None
        else parse_point_file(read_file("point file", csv), csv)
    )
    scale = SPEED_UNITS[unit]
    fit = fit_curve(
        kind,
        given,
        limit_speed=None if limit is None else limit * scale,
        top_speed=None if top_speed is None else top_speed * scale,
        minimum=a_min,
    )
    fault = curve_fault(fit)
    console = Console(highlight=False, soft_wrap=True)
    print_lines(console, curve_lines(fit, usable=fault is None))
    draw(console, fit, [output for output in outputs if picture_kind(output) not in YAML])
    if fault is not None:
        print_error(fault)
        return RUN_FAILED
    lines = curve_yaml(fit, spindle, gear)
    files = [output for output in outputs if picture_kind(output) in YAML]
    for output in files or (None,):
        deliver(console, output, lines)
    return 0


def check_outputs(outputs: Sequence[str], csv: str | None) -> None:
    """Raises CncError 27030 for an output that cannot be made or would overwrite the points."""
    for output in outputs:
        if picture_kind(output) not in (*KINDS, *YAML):
            known = ".svg, .png or .html (picture), .yaml or .yml (lines for the machine file)"
            raise CncError(BAD_OUTPUT, f"{output}: its name must end in {known}", "nothing was started")
        check_output(output, point_file=csv)


def draw(console: Console, fit: CurveFit, outputs: Sequence[str]) -> None:
    """Writes the pictures."""
    for output in outputs:
        kind = picture_kind(output)
        write_output(output, curve_page(fit) if kind == "html" else curve_picture(fit, kind))
        console.print(f"{output} written", markup=False)
