"""The commands of `cnc_ptp identify` and `cnc_ptp curve`."""

from __future__ import annotations

import sys
from typing import Any

import click

from cnc_ptp.commands.commissioning.options import curve_fit_options, identify_options, require_source
from cnc_ptp.commands.group import Group


@click.group("identify", cls=Group)
def identify_commands() -> None:
    """Identify the friction or the drive of an axis.

    Gives friction table, drive time constant and position controller gain.
    """


@identify_commands.command("friction")
@identify_options
@click.option("--velocity", "velocities", type=float, multiple=True, help="Drive these velocities (mm/s, deg/s) only.")
def friction_command(**options: Any) -> None:
    """Identify the friction of AXIS: drive in both directions at constant velocities, read the torque, write YAML."""
    from cnc_ptp.commands.commissioning.identify import identify_friction

    require_source(options)
    sys.exit(identify_friction(**options))


@identify_commands.command("dynamics")
@identify_options
def dynamics_command(**options: Any) -> None:
    """Identify the drive of AXIS: time constant, dead time, inertia; propose Kv and feedforward as YAML."""
    from cnc_ptp.commands.commissioning.identify import identify_dynamics

    require_source(options)
    sys.exit(identify_dynamics(**options))


@click.group("curve", cls=Group)
def curve_commands() -> None:
    """Acceleration curves of spindles (P-AXIS-00202)."""


@curve_commands.command("fit")
@curve_fit_options
def fit_command(**options: Any) -> None:
    """Coefficients b1, b2, b3 of an acceleration curve from interpolation points of the drive.

    The point at the limit speed gives n_grenz and a_konst. Above it 3 points make the polynomial and 2 the hyperbola,
    exactly; with more of them the curve is the least squares fit, and the table shows how far it is off each point.
    """
    from cnc_ptp.commands.commissioning.curve import curve_fit

    if bool(options["points"]) == bool(options["csv"]):
        raise click.UsageError("Either --point (again and again) or --csv is needed.")
    sys.exit(curve_fit(**options))
