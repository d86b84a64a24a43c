"""A problem with one parameter, as all checks word it."""

from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.parameter_set import ParameterSet


def problem(parameters: ParameterSet, error_id: int, number: str, indexes: tuple[int, ...], text: str) -> Problem:
    """A problem with one parameter of a node."""
    declaration = parameters.catalogue.by_id[number]
    subject = f"{declaration.list_name} list, {number} {declaration.list_style_name(indexes)} of /{parameters.node}"
    return Problem(error_id, parameters.where(number, *indexes), f"{subject}: {text}")
