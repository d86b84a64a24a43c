"""`cnc_ptp layout`: a layout file of Foxglove or PlotJuggler for a machine."""

from __future__ import annotations

from pathlib import Path

from cnc_ptp.commands.output_file import check_output, write_output
from cnc_ptp.commissioning.faults import BAD_OUTPUT
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import read_machine
from cnc_ptp.plots.layouts import FORMATS, views


def layout(machine: str, program: str, output: str) -> int:
    """Writes it; a name with another ending is refused, as the program would not show the file."""
    write, ending = FORMATS[program]
    if Path(output).suffix.lower() != ending:
        wrong = f"{output}: the file name of a layout for {program} must end in {ending}"
        raise CncError(BAD_OUTPUT, wrong, "nothing was started")
    check_output(output, machine_file=machine)
    parameters = read_machine(machine)
    write_output(output, write(parameters), remains="nothing was written")
    print(f"{output}: {', '.join(view.title for view in views(parameters))}")
    return 0
