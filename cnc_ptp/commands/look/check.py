"""`cnc_ptp check`: an NC program's errors with line and column."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from rich.console import Console

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.commands.console import print_error
from cnc_ptp.commands.language.canonical_text import format_block
from cnc_ptp.errors import WRONG_INPUT, CncError
from cnc_ptp.machine.program_files import read_program
from cnc_ptp.machine.run_entries import program_folders
from cnc_ptp.nc.canonical import BUSY
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.interpreter import awaits_path, interpret
from cnc_ptp.nc.interpreter import check as check_text
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.parser import parse_all
from cnc_ptp.nc.vocabularies import VOCABULARIES
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.notes import Note

AXES_WITHOUT_MACHINE = ("X", "Y", "Z")
SPINDLES_WITHOUT_MACHINE = ("S",)


def check(program: str, machine: str | None, canonical: bool = False, dialect: str | None = None) -> int:
    """Prints all syntax errors and the first modal one, and the warnings of the machine file.

    Without a machine, axes X Y Z and spindle S are taken. `canonical`: prints the blocks that result, too. `dialect`:
    vocabulary of the program; None: that of the machine file, or twincat.
    """
    parameters = None if machine is None else read_machine(machine)
    text, files = read_program(program, () if parameters is None else program_folders(parameters))
    vocabulary = VOCABULARIES[dialect or "twincat"]
    if parameters is None:
        axes, spindles = AXES_WITHOUT_MACHINE, SPINDLES_WITHOUT_MACHINE
        errors = check_text(text, program, axes, spindles, files=files, vocabulary=vocabulary)
    else:
        print_notices(parameters)
        checked = ProgramCheck.of_first_channel(parameters, program)
        vocabulary = checked.vocabulary if dialect is None else vocabulary
        errors = checked.errors(text, program, files, vocabulary)
    if canonical:
        print_stream(parse_all(text, program, files=files, vocabulary=vocabulary)[0], parameters)
    for error in errors:
        print_error(error)
    if not errors and not canonical:
        print(f"{Path(program).name}: no errors in {len(text.splitlines())} lines")
    return WRONG_INPUT if errors else 0


def print_stream(program: Program, machine: MachineParameters | None) -> None:
    """The canonical blocks up to the first error, or to a line that reads what only the run knows."""
    if machine is None:
        blocks = interpret(program, (0.0,) * 3, AXES_WITHOUT_MACHINE, SPINDLES_WITHOUT_MACHINE, runs=True)
    else:
        checked = ProgramCheck.of_first_channel(machine, program.file)
        blocks = checked.running(program, checked.start, checked.state({}, {}, {}))
    with suppress(CncError):
        for block in blocks:
            if block is BUSY:
                continue
            print(format_block(block))
            if awaits_path(block):
                print("what follows is known only while the program runs")
                return


def print_notices(machine: MachineParameters) -> None:
    """Prints the warnings of a machine file on standard error."""
    console = Console(stderr=True, highlight=False, soft_wrap=True)
    for notice in machine.warnings:
        console.print(str(Note(notice.error_id, str(notice))), style="yellow", markup=False)
