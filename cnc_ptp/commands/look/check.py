"""`cnc_ptp check`: an NC program's errors with line and column."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.commands.console import print_error
from cnc_ptp.errors import WRONG_INPUT
from cnc_ptp.machine.program_files import read_program
from cnc_ptp.nc.interpreter import check as check_text
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.notes import Note

AXES_WITHOUT_MACHINE = ("X", "Y", "Z")
SPINDLES_WITHOUT_MACHINE = ("S",)


def check(program: str, machine: str | None) -> int:
    """Prints all syntax errors and the first modal one, and the warnings of the machine file.

    Without a machine, axes X Y Z and spindle S are taken.
    """
    text, files = read_program(program)
    if machine is None:
        errors = check_text(text, program, AXES_WITHOUT_MACHINE, SPINDLES_WITHOUT_MACHINE, files=files)
    else:
        parameters = read_machine(machine)
        print_notices(parameters)
        errors = ProgramCheck.of_first_channel(parameters, program).errors(text, program, files)
    for error in errors:
        print_error(error)
    if not errors:
        print(f"{Path(program).name}: no errors in {len(text.splitlines())} lines")
    return WRONG_INPUT if errors else 0


def print_notices(machine: MachineParameters) -> None:
    """Prints the warnings of a machine file on standard error."""
    console = Console(stderr=True, highlight=False, soft_wrap=True)
    for notice in machine.warnings:
        console.print(str(Note(notice.error_id, str(notice))), style="yellow", markup=False)
