"""A line for the log about one parameter, as all notices word it."""

from cnc_ptp.parameters.parameter_set import ParameterSet


def line(parameters: ParameterSet, number: str, indexes: tuple[int, ...], text: str) -> str:
    """Place, number, name and node of the parameter, then `text`."""
    name = parameters.catalogue.by_id[number].list_style_name(indexes)
    return f"{parameters.where(number, *indexes)}: {number} {name} of /{parameters.node}: {text}"
