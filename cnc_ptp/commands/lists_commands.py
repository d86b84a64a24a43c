"""The commands of `cnc_ptp lists`."""

from __future__ import annotations

import sys
from typing import Any

import click

from cnc_ptp.commands.arguments import MACHINE, parse_kinds
from cnc_ptp.commands.group import Group


@click.group("lists", cls=Group)
def lists_commands() -> None:
    """Read and write the vendor's ASCII lists of axes, channels, tools."""


@lists_commands.command("import")
@click.argument("folder", type=click.Path())
@click.option("-o", "--output", required=True, type=click.Path(), help="Machine file to write.")
@click.option("--report", type=click.Path(), help="File to write what became of each line, and every default.")
@click.option("--as", "kinds", multiple=True, callback=parse_kinds, metavar="FILE=KIND", help="What a list is.")
@click.option("--strict", is_flag=True, help="An unknown line is an error.")
@click.option("--incomplete", is_flag=True, help="Only report what values and lists say against each other.")
@click.option("--force", is_flag=True, help="Overwrite the output.")
def import_command(**options: Any) -> None:
    """Make a machine file of the lists in FOLDER.

    Prints what was corrected and what is unknown; unknown lines and comments are kept for an export.
    """
    from cnc_ptp.commands.lists import import_folder

    sys.exit(import_folder(**options))


@lists_commands.command("export")
@MACHINE
@click.option("-o", "--output", required=True, type=click.Path(), metavar="FOLDER", help="Folder to write.")
@click.option("--force", is_flag=True, help="Replace the lists in a folder that is there.")
def export_command(**options: Any) -> None:
    """Write a machine file as lists, one file for each axis, channel and table."""
    from cnc_ptp.commands.lists import export_folder

    sys.exit(export_folder(**options))
