"""Options of the commands of commissioning, and which of them go together."""

from __future__ import annotations

from typing import Any

import click

from cnc_ptp.commands.arguments import option_group

identify_options = option_group(
    click.argument("axis"),
    click.option("--machine", type=click.Path(dir_okay=False), help="Machine file; a recording has its own."),
    click.option("--recording", type=click.Path(), help="Evaluate this recording, drive nothing."),
    click.option("-o", "--output", type=click.Path(dir_okay=False), help="YAML file to write instead of printing."),
    click.option("--record", type=click.Path(dir_okay=False), help="Write an MCAP recording of the run."),
)
"""Options that all identifications share."""

circle_options = option_group(
    click.argument("machine", type=click.Path(dir_okay=False)),
    click.option("--radius", type=float, required=True, help="mm"),
    click.option("--feed", type=float, required=True, help="mm/min"),
    click.option("--plane", default="XY", show_default=True, help="XY, ZX or YZ."),
    click.option("--centre", type=float, nargs=2, help="Centre in the plane, mm; without it the position of the axes."),
    click.option("--direction", type=click.Choice(["both", "ccw", "cw"]), default="both", show_default=True),
    click.option(
        "--feedforward/--no-feedforward", default=None, help="G135 (off without it, as after a program start)."
    ),
    click.option(
        "--friction/--no-friction", default=None, help="Friction compensation (without it as in the machine file)."
    ),
    click.option(
        "--compare",
        type=click.Choice(["feedforward", "friction", "both"]),
        help="Run without and with it, and draw all in one picture.",
    ),
    click.option(
        "-o",
        "--output",
        "outputs",
        type=click.Path(dir_okay=False),
        multiple=True,
        help="Picture: .svg, .png or .html.",
    ),
    click.option("--magnification", type=float, help="Of the deviations in the picture; without it chosen to fit."),
    click.option(
        "--record",
        type=click.Path(dir_okay=False),
        help="Keep the run in this MCAP file; those of --compare in FILE_1, FILE_2, … in their order.",
    ),
)
"""The circle, what is compared, where it goes."""

curve_fit_options = option_group(
    click.argument("kind", type=click.Choice(["polynomial", "hyperbola"])),
    click.option(
        "--point",
        "points",
        multiple=True,
        metavar="SPEED:ACCELERATION",
        help="12000:16000 in --unit and °/s²; ascending.",
    ),
    click.option(
        "--csv", type=click.Path(dir_okay=False), help="Columns acceleration_deg_s2, speed_deg_s or speed_rpm."
    ),
    click.option(
        "--unit",
        type=click.Choice(["deg/s", "rpm"]),
        default="deg/s",
        show_default=True,
        help="Of the speeds in --point, --limit and --top-speed.",
    ),
    click.option("--limit", type=float, help="Limit speed, one of the points; without it the first."),
    click.option("--top-speed", type=float, help="Speed up to which the curve must hold; without it the last point."),
    click.option("--a-min", type=click.IntRange(0, 2**32 - 1), default=0, show_default=True, help="Floor in °/s²."),
    click.option("--spindle", default="s", show_default=True, help="For the lines of the machine file."),
    click.option("--gear", type=click.IntRange(0, 5), default=0, show_default=True, help="Index of getriebe[i]."),
    click.option(
        "-o",
        "--output",
        "outputs",
        type=click.Path(dir_okay=False),
        multiple=True,
        help="Picture (.svg, .png, .html), or the lines of the machine file (.yaml) instead of printing them.",
    ),
)
"""The points, the unit, where the curve goes."""


def require_source(options: dict[str, Any]) -> None:
    """Raises UsageError unless there is something to identify, and only once."""
    if options["machine"] is None and options["recording"] is None:
        raise click.UsageError("--machine (drives the axis offline) or --recording is needed.")
    if options["recording"] is not None and options["record"] is not None:
        raise click.UsageError("--record and --recording exclude each other: a recording is evaluated without a run.")
    if options["recording"] is not None and options.get("velocities"):
        raise click.UsageError("--velocity and --recording exclude each other: a recording is evaluated without a run.")


def require_one_state(options: dict[str, Any]) -> None:
    """Raises UsageError when what a circle test compares is also switched."""
    compared = options["compare"]
    for name in ("feedforward", "friction"):
        if compared in (name, "both") and options[name] is not None:
            switches = f"--{name} and --no-{name} are for what is not compared."
            raise click.UsageError(f"--compare {compared} runs without and with {name}: {switches}")
