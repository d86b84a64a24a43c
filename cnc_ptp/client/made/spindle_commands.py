"""The commands of a spindle as methods. Made by cnc_ptp/client/make_commands.py; do not edit."""

from __future__ import annotations

from typing import Literal

from cnc_ptp.client.asking import Asking
from cnc_ptp.client.job import Answer, Job


class SpindleCommands(Asking):
    """What a spindle can be told. A refusal raises the error of the unit; nothing has changed then."""

    def power(self, enabled: bool) -> Answer:
        """Enable.

        enabled  on or off
        """
        return self._answer("power", enabled=enabled)

    def start(self, speed_rpm: float, *, direction: Literal["cw", "ccw"] = "cw", source: str | None = None) -> Job:
        """M03, M04: endless rotation.

        speed_rpm [rpm]  speed
        direction  of rotation
        source  `plc` or a channel: for whom the spindle works; left out: nobody; acts immediately
        """
        return self._job("start", speed_rpm=speed_rpm, direction=direction, source=source)

    def set_speed(self, speed_rpm: float, *, source: str | None = None) -> Job:
        """S: new speed in the same direction.

        speed_rpm [rpm]  speed
        source  `plc` or a channel: for whom the spindle works; left out: nobody; acts immediately
        """
        return self._job("set_speed", speed_rpm=speed_rpm, source=source)

    def stop(self, *, source: str | None = None) -> Job:
        """M05.

        source  `plc` or a channel: for whom the spindle works; left out: nobody; acts immediately
        """
        return self._job("stop", source=source)

    def hold_stop(self, enabled: bool) -> Answer:
        """Keeps the spindle in Stopping: what would turn it is refused (22165) until it is off; MC_Stop.

        enabled  on or off
        """
        return self._answer("hold_stop", enabled=enabled)

    def orient(
        self,
        position_deg: float,
        *,
        speed_rpm: float | None = None,
        direction: Literal["cw", "ccw", "shortest"] | None = None,
        source: str | None = None,
    ) -> Job:
        """M19: positioning.

        position_deg [°]  position
        speed_rpm [rpm]  speed of the positioning; left out: P-AXIS-00209
        direction  of rotation; left out: the rules of M19
        source  `plc` or a channel: for whom the spindle works; left out: nobody; acts immediately
        """
        return self._job("orient", position_deg=position_deg, speed_rpm=speed_rpm, direction=direction, source=source)

    def home(self, *, source: str | None = None) -> Job:
        """G74: homing.

        source  `plc` or a channel: for whom the spindle works; left out: nobody; acts immediately
        """
        return self._job("home", source=source)

    def set_override(self, percent: float) -> Answer:
        """Override of speed and positioning.

        percent [%]  override
        """
        return self._answer("set_override", percent=percent)

    def suppress_override(self, enabled: bool) -> Answer:
        """Override without effect (G167).

        enabled  on or off
        """
        return self._answer("suppress_override", enabled=enabled)

    def feed_hold(self, enabled: bool) -> Answer:
        """Stops the spindle on its ramp, and lets it turn again.

        enabled  on or off
        """
        return self._answer("feed_hold", enabled=enabled)

    def select_gear(self, stage: int, *, resume: bool = True, source: str | None = None) -> Answer:
        """M40 … M45: requests a gear change.

        stage  gear 1 … 6
        resume  whether the previous rotation continues
        source  `plc` or a channel: for whom the spindle works; left out: nobody; acts immediately
        """
        return self._answer("select_gear", stage=stage, resume=resume, source=source)

    def gear_changed(self) -> Answer:
        """The PLC has changed the gear."""
        return self._answer("gear_changed")

    def set_limits(
        self,
        *,
        max_speed_rpm: float | None = None,
        min_speed_rpm: float | None = None,
        max_acceleration: float | None = None,
    ) -> Answer:
        """Limits of a tool.

        max_speed_rpm [rpm]  largest speed; left out: not limited
        min_speed_rpm [rpm]  smallest speed in rotation; left out: not limited
        max_acceleration [°/s²]  largest acceleration; left out: not limited
        """
        return self._answer(
            "set_limits",
            max_speed_rpm=max_speed_rpm,
            min_speed_rpm=min_speed_rpm,
            max_acceleration=max_acceleration,
        )

    def reset_limits(self) -> Answer:
        """Ends the limits of the tool."""
        return self._answer("reset_limits")

    def stop_at_program_end(self, enabled: bool) -> Answer:
        """Whether the spindle stops at M30.

        enabled  on or off
        """
        return self._answer("stop_at_program_end", enabled=enabled)

    def couple(self, master: str, *, factor_num: float | None = None, factor_den: float | None = None) -> Answer:
        """Synchronous operation with a master.

        master  name of the master spindle
        factor_num  ratio: numerator, signed; left out: 1
        factor_den  ratio: denominator; left out: 1
        """
        return self._answer("couple", master=master, factor_num=factor_num, factor_den=factor_den)

    def decouple(self) -> Answer:
        """Ends synchronous operation."""
        return self._answer("decouple")

    def set_feedforward(self, *, enabled: bool | None = None, weight_percent: float | None = None) -> Answer:
        """Switches and weights feedforward.

        enabled  on or off; left out: unchanged
        weight_percent [%]  weight of feedforward, 0 … 100; left out: unchanged
        """
        return self._answer("set_feedforward", enabled=enabled, weight_percent=weight_percent)

    def reset_feedforward(self) -> Answer:
        """Feedforward off, weight 100 %."""
        return self._answer("reset_feedforward")

    def reset(self) -> Answer:
        """Leaves ErrorStop at a standstill."""
        return self._answer("reset")
