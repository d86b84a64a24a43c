"""Synchronous operation of spindles: a slave carries out the commands of its master (TF5200 spindle 2.8.3).

The setpoints are not coupled cycle by cycle: commands are passed on, and each spindle moves within its own limits. Only
the PLC sees all spindles, so it decides whether a coupling is permitted: no master is a slave, so that no circle can
arise.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cnc_ptp.errors import NO_VALUES
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.spindle.faults import (
    BAD_RATIO,
    COUPLED_ALREADY,
    COUPLED_TO_ITSELF,
    COUPLING_CHAIN,
    NOT_COUPLED,
    UNKNOWN_MASTER,
)
from cnc_ptp.spindle.ratio import LARGEST_RATIO, SMALLEST_RATIO, is_permitted, scaled
from cnc_ptp.spindle.spindle import Spindle

PASSED_ON = ("start", "set_speed", "stop", "orient", "home")
"""Commands of a master that its slaves carry out too."""


class CouplingCommands:
    """`couple`, `decouple`, and the answer of the PLC."""

    def __init__(self, spindle: Spindle, spindles: tuple[str, ...]) -> None:
        """`spindles`: names of all spindles of the machine."""
        self._spindle = spindle
        self._spindles = spindles
        self.master = ""
        self.wanted = ""
        self.owner = ""
        """The channel that has coupled the spindle, empty for people."""
        self._ratio = self._wanted_ratio = 1.0

    def do_couple(
        self, cycle: int, *, master: str, factor_num: float = 1.0, factor_den: float = 1.0, owner: str = ""
    ) -> None:
        """Asks for a coupling to `master` with speeds and positions times factor_num / factor_den.

        `owner`: the channel that couples. Refused with 24003, 24019–24021 and 24027.
        """
        spindle = self._spindle
        spindle.require_ready("couple")
        if master == spindle.name:
            spindle.refuse("couple", COUPLED_TO_ITSELF, "a spindle cannot be its own master")
        if master not in self._spindles:
            known = ", ".join(self._spindles)
            spindle.refuse(
                "couple", UNKNOWN_MASTER, f"'{master}' is not a spindle of the machine ({known})", master=master
            )
        for name, value in (("factor_num", factor_num), ("factor_den", factor_den)):
            if value == 0.0:
                spindle.refuse("couple", BAD_RATIO, f"{name} = {value} must not be 0", argument=name, value=value)
        ratio = factor_num / factor_den
        if not is_permitted(ratio):
            low, high = SMALLEST_RATIO, LARGEST_RATIO
            reason = f"factor_num / factor_den = {ratio:g} is not within ±{low:g} ... ±{high:g}"
            spindle.refuse("couple", BAD_RATIO, reason, ratio=ratio, low=low, high=high)
        if self.master or self.wanted:
            other = self.master or self.wanted
            reason = f"the spindle is a slave of {other}; decouple it first"
            spindle.refuse("couple", COUPLED_ALREADY, reason, master=other)
        self.wanted, self._wanted_ratio, self.owner = master, ratio, owner

    def do_coupling_answer(self, cycle: int, *, granted: bool, reason: str) -> None:
        """The PLC: the requested coupling starts, or does not and why (24024)."""
        master, self.wanted = self.wanted, ""
        if granted and master:
            self.master, self._ratio = master, self._wanted_ratio
        elif master:
            text = f"spindle {self._spindle.name}: not coupled to {master}: {reason}; nothing was changed"
            self._spindle.report_warning(cycle, COUPLING_CHAIN, text, NO_VALUES)

    def do_decouple(self, cycle: int, *, owner: str = "") -> str | None:
        """The spindle continues unchanged on its own; a channel ends its own couplings only. Refused with 24023."""
        if owner and owner != self.owner:
            return f"spindle {self._spindle.name}: decouple without effect, it was not coupled by '{owner}'"
        if not (self.master or self.wanted):
            if owner:
                return f"spindle {self._spindle.name}: decouple without effect, the spindle is no longer coupled"
            self._spindle.refuse("decouple", NOT_COUPLED, "the spindle is not coupled")
        self.master = self.wanted = ""
        return None

    def of_slave(self, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """Arguments of the master's command, converted for this spindle."""
        return scaled(arguments, self._ratio)


def can_follow(spindle: Spindle) -> bool:
    """False for a slave that is in error or has no power: it carries out no command of its master."""
    return spindle.state not in (S.ERROR_STOP, S.DISABLED)
