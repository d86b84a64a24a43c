"""Feed releases of an axis, one for each direction (TX1250 2.1, 2.6)."""

from __future__ import annotations

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import TRAJECTORY_ENDED
from cnc_ptp.errors import warning_text


class FeedReleaseCommands:
    """`set_feed_release`. What a withheld release stops: `PtpGenerator.release`, `Monitoring.watch`."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    def do_set_feed_release(self, cycle: int, *, forward: bool, backward: bool) -> str | None:
        """Releases motion towards greater and towards smaller positions, each separately.

        A positioning in a direction that is withheld stops on its ramp and continues when it is released. A path stops
        with its channel; a motion that only others can stop (a slave, external setpoints) is a fault, 23058. A
        trajectory cannot be resumed: it ends on the ramp, with warning 23068.
        """
        axis, followed = self._axis, self._axis.ptp.follows
        axis.release_feed(cycle, forward=forward, backward=backward)
        if followed and not axis.ptp.follows:
            ended = "the trajectory is aborted, a direction is no longer released; the axis stops on its ramp"
            return warning_text(TRAJECTORY_ENDED, f"axis {axis.name}: {ended}")
        return None
