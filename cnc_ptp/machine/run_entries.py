"""Program and scenario of a run, read and checked before anything starts."""

from __future__ import annotations

from pathlib import Path

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.scenario import BAD_SCENARIO, Entry, ScenarioError, parse_scenario
from cnc_ptp.protocol.blocks import Command

UNREADABLE = 26110


def read_entries(
    machine: MachineParameters, *, program: str | None, scenario: str | None, may_be_empty: bool = False
) -> list[Entry]:
    """The entries of a run: load and start of `program` on the first channel at 0 s, then the scenario.

    `may_be_empty`: a scenario may have no entries. Loads carry the text of their program; a path in a scenario,
    relative to its file, becomes one relative to the working directory.
    Raises ScenarioError, ProgramError, CncError 26110 (file) and 26112 (a program but no channel).
    """
    entries: list[Entry] = []
    if program is not None:
        text = read_file("NC program", program)
        check_program(machine, text, program)
        channel = next(iter(machine.channels))
        entries.append(Entry(0.0, Command(channel, "load", {"program": program, "text": text})))
        entries.append(Entry(0.0, Command(channel, "start", {})))
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
                entry.command.arguments["program"] = str(folder / entry.command.arguments["program"])
    return sorted(entries, key=lambda entry: entry.at)


def check_program(machine: MachineParameters, text: str, file: str) -> None:
    """Interprets a program for the first channel as started from the start positions. Raises ProgramError, 26112."""
    check = ProgramCheck.of_first_channel(machine, file)
    check.blocks(parse_program(text, file), check.start)


def read_file(what: str, path: str) -> str:
    """Text of a file. Raises CncError 26110."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise CncError(UNREADABLE, f"{what} {path} cannot be read: {error.strerror}", "nothing was started") from None
    except UnicodeDecodeError:
        raise CncError(
            UNREADABLE, f"{what} {path} cannot be read: it is not UTF-8 text", "nothing was started"
        ) from None
