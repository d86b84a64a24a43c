"""Feed releases of an axis, one for each direction (TX1250 2.1, 2.6)."""

from __future__ import annotations

from cnc_ptp.axis.axis import Axis


class FeedReleaseCommands:
    """`set_feed_release`. What a withheld release stops: `PtpGenerator.release`, `Monitoring.watch`."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    def do_set_feed_release(self, cycle: int, *, forward: bool, backward: bool) -> None:
        """Releases motion towards greater and towards smaller positions, each separately.

        A positioning in a direction that is withheld stops on its ramp and continues when it is released. A path stops
        with its channel; a motion that only others can stop (a slave, external setpoints) is a fault, 23058.
        """
        self._axis.release_feed(cycle, forward=forward, backward=backward)
