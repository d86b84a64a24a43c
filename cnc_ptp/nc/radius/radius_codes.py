"""G codes of the compensation of the tool radius."""

from collections.abc import Callable

from cnc_ptp.nc.functions import MAX_TOOL, number_function
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, GCode, NcBlock
from cnc_ptp.nc.radius.changes import require_same_radius
from cnc_ptp.nc.radius.radius_state import LEFT, RIGHT
from cnc_ptp.nc.tools.compensation import data_of, unknown_data

SIDES = {40: 0, 41: LEFT, 42: RIGHT}


def side(number: int) -> Callable[[ModalState], None]:
    """G40, G41, G42."""

    def select(state: ModalState) -> None:
        state.radius_compensation = state.radius_compensation._replace(side=SIDES[number])

    return select


def outer_corners(*, by_lines: bool) -> Callable[[ModalState], None]:
    """G25, G26."""

    def select(state: ModalState) -> None:
        state.radius_compensation = state.radius_compensation._replace(by_lines=by_lines)

    return select


def feed_of_arcs(*, at_contour: bool) -> Callable[[ModalState], None]:
    """G10, G11."""

    def select(state: ModalState) -> None:
        state.radius_compensation = state.radius_compensation._replace(contour_feed=at_contour)

    return select


def take_data(channel: Channel, state: ModalState, block: NcBlock, code: GCode) -> None:
    """D of G41 and G42 in the vocabulary iso: whose radius acts, until the next D. Raises ProgramError."""
    if "D" not in block.words:
        return
    number = number_function(block, "D", MAX_TOOL).number
    data = data_of(channel, state, number)
    if data is None:
        raise unknown_data(channel, block.source, block.source.column("D"), f"D{number}", number)
    require_same_radius(state, data, block.source, block.source.column("D"), f"D{number}")
    state.radius_compensation = state.radius_compensation._replace(data=data)
