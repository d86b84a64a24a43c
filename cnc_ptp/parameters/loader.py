"""Machine file -> MachineParameters: read, check each value and values against each other, or report all problems."""

from pathlib import Path

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.check.machine_checks import check_machine
from cnc_ptp.parameters.check.machine_notices import machine_notices
from cnc_ptp.parameters.errors import ParameterError, Place, Problem
from cnc_ptp.parameters.read.machine_sections import read_parameters
from cnc_ptp.parameters.view.machine_view import MachineParameters, machine_view


def read_machine(path: str | Path) -> MachineParameters:
    """The machine of a file; raises ParameterError (25017 when it cannot be read)."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        problem = Problem(errors.UNREADABLE, Place(str(path), 1, 1), f"machine file cannot be read, {reason}")
        raise ParameterError([problem]) from error
    return load_machine(text, str(path))


def load_machine(text: str, file: str) -> MachineParameters:
    """The machine that the text of a ROS parameters file describes; `file` is for messages. Raises ParameterError."""
    machine, sets, problems = read_parameters(text, file)
    problems += check_machine(sets)
    if problems:
        raise ParameterError(problems)
    return machine_view(machine, sets, tuple(machine_notices(machine, sets)))
