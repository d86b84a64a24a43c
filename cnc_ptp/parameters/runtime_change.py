"""What a node says to a parameter that somebody wants to change while it runs."""

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.parameter_set import ParameterSet

MEMORY_IS_FIXED = 110641
POINTS = "P-COMP-00062"
"""Table size for which memory is kept from the start on (TF5200 friction compensation 5.2.2)."""


def change_refusal(parameters: ParameterSet, ros_name: str, wanted: object) -> CncError | None:
    """The error 110641 for a change of P-COMP-00062; None for all others, which are read-only without more reason."""
    declaration = parameters.catalogue.by_id[POINTS]
    if ros_name != declaration.ros_name(()) or not declaration.belongs_to(parameters.kind):
        return None
    name, value = declaration.list_style_name(()), parameters.value(POINTS)
    text = f"{name} = {value} ({POINTS}) cannot be changed to {wanted} after start-up"
    effect = "nothing was changed, set it in the machine file and start again"
    return CncError(MEMORY_IS_FIXED, f"{parameters.kind} {parameters.node}: {text}; {effect}")
