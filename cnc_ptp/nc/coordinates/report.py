"""The offsets that count, as the canonical stream and the state topics show them."""

from cnc_ptp.nc.canonical import OffsetReport
from cnc_ptp.nc.coordinates.coordinates import Offsets
from cnc_ptp.nc.coordinates.frame import IDENTITY
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel


def offset_report(channel: Channel, state: ModalState) -> OffsetReport:
    """Of the state of the coordinates."""
    count, coordinates, diameter = len(channel.axes), state.coordinates, state.turning.diameter
    if diameter is not None and coordinates.kinematics is not None and diameter.place in coordinates.kinematics.plane:
        diameter = None
    frame = coordinates.frame(count, channel.main)
    own = coordinates.own
    zeros = (0.0,) * count

    def each(offsets: Offsets) -> tuple[float, ...]:
        return offsets or zeros

    linear = IDENTITY if frame is None else frame.linear
    return OffsetReport(
        zero_index=own.zero_index,
        zero=each(own.zero),
        added=each(own.added),
        preset=each(own.preset),
        clamp_index=coordinates.clamp_index,
        clamp=each(coordinates.clamp),
        tool=each(coordinates.tool),
        scale=coordinates.scale if coordinates.scaled and coordinates.scale else (1.0,) * count,
        mirrored=tuple([sign < 0.0 for sign in coordinates.mirror or (1.0,) * count]),
        angle=None if coordinates.turn is None else coordinates.turn[0],
        systems=tuple([system.command for system in coordinates.systems]),
        machine=coordinates.outside is not None,
        matrix=(*linear[0], *linear[1], *linear[2]),
        shift=zeros if frame is None else frame.shift,
        diameter=diameter.place if diameter is not None and channel.turning.shown else -1,
        kinematics=coordinates.kinematics,
    )
