"""What must not change, and what is not possible, while the radius is compensated."""

from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.radius import radius_faults as faults
from cnc_ptp.nc.radius.tool_radius import described, radius_of, tip_of, tool_of
from cnc_ptp.parameters import Tool


def require_same_radius(state: ModalState, data: Tool, source: Source, column: int, word: str) -> None:
    """Raises ProgramError 21680 for data with another radius or tip while the tool is beside the contour."""
    compensation, active = state.radius_compensation, tool_of(state)
    if not compensation.engaged or not compensation.side:
        return
    if (radius_of(active), tip_of(active)) != (radius_of(data), tip_of(data)):
        values = {"before": described(active), "behind": described(data)}
        raise faults.RADIUS_CHANGED.at(source, column, word=word, **values)


def require_same_plane(state: ModalState, source: Source, word: str) -> None:
    """Raises ProgramError 20133 for G17 to G19 while the tool is beside the contour."""
    if state.radius_compensation.engaged:
        raise faults.PLANE_CHANGE.at(source, source.column(word), g=word)


def require_same_system(state: ModalState, source: Source, column: int, command: str) -> None:
    """Raises ProgramError 20802 for a change of the coordinate system while the radius is compensated."""
    if state.radius_compensation.on:
        raise faults.SYSTEM_CHANGE.at(source, column, command=command)


def require_off(state: ModalState, source: Source, column: int, what: str) -> None:
    """Raises ProgramError 20651 for what is not possible while the radius is compensated."""
    if state.radius_compensation.on:
        raise faults.NOT_WHILE.at(source, column, what=what)
