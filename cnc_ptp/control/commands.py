"""Commands that act below the setpoint: feedforward and friction compensation of an axis or spindle."""

from __future__ import annotations

from typing import Protocol

from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.control.feedforward import Feedforward
from cnc_ptp.errors import CncError

BAD_WEIGHT = 23060
NO_FRICTION_COMPENSATION = 70495
FULL_WEIGHT = 100.0


class FeedforwardLoop(Protocol):
    """A control loop with feedforward; what is selected holds in all its gears."""

    @property
    def feedforward(self) -> Feedforward:
        """That of the gear in work."""

    def select_feedforward(self, on: bool, weight_percent: float) -> None:
        """G135 or G137 with the weight of G136."""


class FeedforwardCommands:
    """do_set_feedforward and do_reset_feedforward for one loop."""

    def __init__(self, loop: FeedforwardLoop, subject: str) -> None:
        """`subject` for messages: "axis x", "spindle s"."""
        self._feedforward_loop = loop
        self._subject = subject
        self._on = False
        self._weight_percent = FULL_WEIGHT

    def do_set_feedforward(
        self, cycle: int, *, on: bool | None = None, weight_percent: float | None = None
    ) -> str | None:
        """G135/G137 (`on`) and G136 (`weight_percent`, 0 … 100); what is left out stays. Refusal 23060.

        A warning when nothing is asked for, or when the axis has no feedforward (P-AXIS-00223).
        """
        if on is None and weight_percent is None:
            return f"{self._subject}: set_feedforward without effect, neither on nor weight_percent is given"
        if weight_percent is not None and not 0.0 <= weight_percent <= FULL_WEIGHT:
            reason = f"weight_percent = {weight_percent} is not within 0 ... 100 (G136)"
            self._refuse("set_feedforward", BAD_WEIGHT, reason)
        self._on = self._on if on is None else on
        self._weight_percent = self._weight_percent if weight_percent is None else float(weight_percent)
        self._feedforward_loop.select_feedforward(self._on, self._weight_percent)
        if on and self._feedforward_loop.feedforward.mode == 0:
            return f"{self._subject}: feedforward without effect, P-AXIS-00223 (vorsteuer.vorsteuerung) is NONE"
        return None

    def do_reset_feedforward(self, cycle: int) -> None:
        """Start of an NC program: feedforward off, weight 100 %; P-AXIS-00255 keeps it on."""
        self._on, self._weight_percent = False, FULL_WEIGHT
        self._feedforward_loop.select_feedforward(False, FULL_WEIGHT)

    def _refuse(self, command: str, error_id: int, reason: str) -> None:
        raise CncError(error_id, f"{self._subject}: {command} refused: {reason}; nothing was changed")


class ControlCommands(FeedforwardCommands):
    """The same, and do_set_friction_compensation, for the control loop of an axis."""

    def __init__(self, loop: ControlLoop, subject: str) -> None:
        super().__init__(loop, subject)
        self._loop = loop

    def do_set_friction_compensation(self, cycle: int, *, on: bool) -> str | None:
        """COMP ON FRICT and COMP OFF FRICT; stays after the program end. Refusal 70495.

        A warning when there is nothing to compensate with (P-COMP-00041 = 0, no table).
        """
        if on and not self._loop.friction.permitted:
            reason = "friction compensation is not activated (P-AXIS-00522 lr_param.frict_comp = 0)"
            self._refuse("set_friction_compensation", NO_FRICTION_COMPENSATION, reason)
        self._loop.friction.switch(on)
        if on and not self._loop.friction.effective:
            reason = "P-COMP-00041 (frict_comp.mode) is 0, or the table has no entries"
            return f"{self._subject}: friction compensation without effect, {reason}"
        return None
