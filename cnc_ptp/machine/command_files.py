"""What commands name as files, read before a unit gets them: the kernel itself opens none."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cnc_ptp.machine.program_files import read_file, read_program
from cnc_ptp.machine.run_entries import add_files, add_manual_files, load_arguments, program_search
from cnc_ptp.nc.parser import NO_FILES
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.cam_file import parse_cam
from cnc_ptp.plc.setpoint_file import parse_setpoints
from cnc_ptp.protocol.blocks import Command


def with_program(command: Command, machine: MachineParameters, loaded: Mapping[str, str] = NO_FILES) -> Command:
    """A `load` with the text of its program, `load` and `mdi` with those of the programs that they call; others as is.

    `loaded`: channel -> file of the program that it has. Raises CncError 26110, 26122.
    """
    arguments = command.arguments
    if command.command == "mdi":
        add_manual_files([command], machine, loaded)
    elif command.command == "load" and "text" in arguments:
        add_files(arguments, program_search(machine, command.target))
    elif command.command == "load":
        path = arguments["program"]
        text, files = read_program(path, program_search(machine, command.target))
        return Command(command.target, "load", load_arguments(path, text, files, arguments.get("dialect")), command.id)
    return command


def with_table(arguments: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Arguments with the rows of their `file` as `name`, a cam table or external setpoints; with rows as they are.

    Raises CncError 26110 (file), 25102 and 25103 (what is in it).
    """
    if "file" not in arguments or name in arguments:
        return dict(arguments)
    given = dict(arguments)
    file = given.pop("file")
    if name == "table":
        given[name] = parse_cam(read_file("cam file", file), file)
    else:
        given[name] = parse_setpoints(read_file("setpoint file", file), file)
    return given
