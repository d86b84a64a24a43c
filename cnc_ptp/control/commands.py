"""Commands that act below the setpoint: feedforward and friction compensation of an axis or spindle."""

from __future__ import annotations

from math import inf
from typing import NoReturn, Protocol

from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.control.feedforward import Feedforward
from cnc_ptp.errors import CncError, Value, warning_text

BAD_WEIGHT = 23060
FEEDFORWARD_WAITS = 23061
WEIGHT_LIMITED = 23062
NO_FRICTION_COMPENSATION = 70495
FULL_WEIGHT = 100.0


def feedforward_warning(feedforward: Feedforward, velocity: float, unit: str) -> tuple[str, dict[str, Value]] | None:
    """The warning when feedforward waits at a constant set `velocity` (mm/s, deg/s) for missing velocity reserve.

    Its text, and the numbers of it by name.
    """
    limit = feedforward.take_wait()
    if limit is None:
        return None
    text = (
        f"feedforward waits: at {abs(velocity):g} {unit}/s there is no room up to {limit:g} {unit}/s (P-AXIS-00212) to "
        f"make up the following error; {feedforward.percent:g} % is active, the rest follows when the motion is slower"
    )
    return text, {"velocity": abs(velocity), "limit": limit, "percent": feedforward.percent}


class FeedforwardLoop(Protocol):
    """A control loop with feedforward; what is selected holds in all its gears."""

    @property
    def feedforward(self) -> Feedforward:
        """The control loop of the active gear."""

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
        self, cycle: int, *, enabled: bool | None = None, weight_percent: float | None = None
    ) -> str | None:
        """G135/G137 (`enabled`) and G136 (`weight_percent`); what is left out stays. Refusal 23060.

        A warning when nothing is given, when a weight above 100 is limited to it (TF5200 feedforward 3), or where
        there is no feedforward (P-AXIS-00223).
        """
        if enabled is None and weight_percent is None:
            return f"{self._subject}: set_feedforward without effect, neither enabled nor weight_percent is given"
        if weight_percent is not None and not 0.0 <= weight_percent < inf:
            reason = f"weight_percent = {weight_percent} must be a number of 0 or more (G136)"
            self._refuse("set_feedforward", BAD_WEIGHT, reason, weight_percent=weight_percent)
        self._on = self._on if enabled is None else enabled
        if weight_percent is not None:
            self._weight_percent = min(FULL_WEIGHT, float(weight_percent))
        self._feedforward_loop.select_feedforward(self._on, self._weight_percent)
        warnings, number = [], 0
        if weight_percent is not None and weight_percent > FULL_WEIGHT:
            warnings.append(f"weight_percent = {weight_percent:g} is above 100 and limited to it (G136)")
            number = WEIGHT_LIMITED
        if enabled and self._feedforward_loop.feedforward.mode == 0:
            warnings.append("feedforward without effect, P-AXIS-00223 (vorsteuer.vorsteuerung) is NONE")
        text = f"{self._subject}: {'; '.join(warnings)}"
        if number and weight_percent is not None:
            return warning_text(number, text, weight_percent=weight_percent, limit=FULL_WEIGHT)
        return warning_text(number, text) if warnings else None

    def reselect(self) -> None:
        """What is selected holds for another feedforward of the loop, too."""
        self._feedforward_loop.select_feedforward(self._on, self._weight_percent)

    def do_reset_feedforward(self, cycle: int) -> None:
        """Start of an NC program: feedforward off, weight 100 %; P-AXIS-00255 keeps it on."""
        self._on, self._weight_percent = False, FULL_WEIGHT
        self._feedforward_loop.select_feedforward(False, FULL_WEIGHT)

    def _refuse(self, command: str, number: int, reason: str, /, **values: Value) -> NoReturn:
        raise CncError(number, reason, "nothing was changed", where=f"{self._subject}: {command} refused", **values)


class ControlCommands(FeedforwardCommands):
    """The same, and do_set_friction_compensation, for the control loop of an axis."""

    def __init__(self, loop: ControlLoop, subject: str) -> None:
        super().__init__(loop, subject)
        self._loop = loop

    def do_set_friction_compensation(self, cycle: int, *, enabled: bool) -> str | None:
        """COMP ON FRICT and COMP OFF FRICT; stays after the program end. Refusal 70495.

        A warning when there is nothing to compensate with (P-COMP-00041 = 0, no table).
        """
        if enabled and not self._loop.friction.permitted:
            reason = "friction compensation is not activated (P-AXIS-00522 lr_param.frict_comp = 0)"
            self._refuse("set_friction_compensation", NO_FRICTION_COMPENSATION, reason)
        self._loop.friction.switch(enabled)
        if enabled and not self._loop.friction.effective:
            reason = "P-COMP-00041 (frict_comp.mode) is 0, or the table has no entries"
            return f"{self._subject}: friction compensation without effect, {reason}"
        return None
