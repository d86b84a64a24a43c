"""Program and scenario of a run, read and checked before anything starts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.channel.program_start import ProgramStart
from cnc_ptp.machine.program_files import NO_SEARCH, Search, folder_of, read_file, read_program
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nc.block_search import StartPoint
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.parser import NO_FILES
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.scenario import BAD_SCENARIO, Entry, ScenarioError, parse_scenario
from cnc_ptp.protocol.blocks import Command


def read_entries(
    machine: MachineParameters,
    *,
    program: str | None,
    scenario: str | None,
    may_be_empty: bool = False,
    dialect: str | None = None,
    begin: StartPoint | None = None,
) -> list[Entry]:
    """The entries of a run: load and start of `program` on the first channel at 0 s, then the scenario.

    `dialect`: vocabulary of `program`; None: that of the machine file. `begin`: where it begins, if not at its
    beginning. `may_be_empty`: a scenario may have no entries. Loads carry the text of their program; a path in a
    scenario, relative to its file, becomes one relative to the working directory.
    Raises ScenarioError, ProgramError, CncError 26110 (file) and 26112 (a program but no channel).
    """
    entries: list[Entry] = []
    if program is not None:
        search = program_search(machine)
        text, files = read_program(program, search)
        try:
            check_program(machine, text, program, files, dialect, begin)
        except ProgramError as error:
            search.explain(error, program)
            error.effect = "nothing has moved"
            raise
        channel = next(iter(machine.channels))
        entries.append(Entry(0.0, Command(channel, "load", load_arguments(program, text, files, dialect))))
        entries.append(Entry(0.0, Command(channel, "start", start_arguments(begin))))
    if scenario is not None:
        folder = Path(scenario).parent
        text = read_file("scenario", scenario)
        entries += parse_scenario(
            text, scenario, unit_kinds(machine), lambda what, path: read_file(what, str(folder / path))
        )
        if len(entries) == (2 if program is not None else 0) and not may_be_empty:
            raise ScenarioError(BAD_SCENARIO, f"scenario {scenario} has no entries", "nothing was started")
        for entry in entries[2 if program is not None else 0 :]:
            if entry.command.command == "load":
                arguments = entry.command.arguments
                arguments["program"] = str(folder / arguments["program"])
                add_files(arguments, program_search(machine, entry.command.target))
    entries.sort(key=lambda entry: entry.at)
    add_manual_files([entry.command for entry in entries], machine)
    return entries


def check_program(
    machine: MachineParameters,
    text: str,
    file: str,
    files: Mapping[str, str] = NO_FILES,
    dialect: str | None = None,
    begin: StartPoint | None = None,
) -> None:
    """Interprets a program for the first channel as started from the start positions, unless it is read as it runs.

    Raises ProgramError, CncError 26112 and the errors of ProgramStart.
    """
    check = ProgramCheck.of_first_channel(machine, file)
    parsed = check.parse(text, file, files, dialect)
    start = None if begin is None else ProgramStart(begin, parsed)
    check.known_ahead(parsed, check.start, check.state({}, {}, {}), start)


def start_arguments(begin: StartPoint | None) -> dict[str, Any]:
    """Arguments of the command `start`."""
    if begin is None:
        return {}
    place: dict[str, Any] = {"line": begin.line} if begin.line else {"block_number": begin.block_number}
    if begin.file:
        place["in_program"] = begin.file
    return place | ({"pass_number": begin.pass_number} if begin.pass_number > 1 else {})


def load_arguments(program: str, text: str, files: Mapping[str, str], dialect: str | None = None) -> dict[str, Any]:
    """Arguments of the command `load`."""
    arguments: dict[str, Any] = {"program": program, "text": text}
    if files:
        arguments["files"] = dict(files)
    if dialect is not None:
        arguments["dialect"] = dialect
    return arguments


def program_search(machine: MachineParameters, channel: str = "") -> Search:
    """Where a channel, or the first one, looks for programs that others call."""
    of_channel = machine.channels.get(channel) or next(iter(machine.channels.values()), None)
    return Search(of_channel.folders, of_channel.cycles) if of_channel else NO_SEARCH


def add_manual_files(
    commands: Iterable[Command], machine: MachineParameters, loaded: Mapping[str, str] = NO_FILES
) -> None:
    """To manual blocks the texts of the programs that they call, from the folder of the program loaded before.

    `loaded`: the file of the program that a channel has before these commands. Raises CncError 26110, 26122.
    """
    programs = dict(loaded)
    for command in commands:
        arguments = command.arguments
        if command.command == "load":
            programs[command.target] = arguments["program"]
        elif command.command == "mdi" and "files" not in arguments:
            search = program_search(machine, command.target)
            files = search.called(arguments["text"], folder_of(programs.get(command.target, "")))
            if files:
                arguments["files"] = files


def add_files(arguments: dict[str, Any], search: Search) -> None:
    """To a load with the text of its program the texts of those that it calls. Raises CncError 26110, 26122."""
    if "text" in arguments and "files" not in arguments:
        files = search.called(arguments["text"], folder_of(arguments["program"]))
        if files:
            arguments["files"] = files
