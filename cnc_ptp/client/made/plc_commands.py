"""The commands of the PLC as methods. Made by cnc_ptp/client/make_commands.py; do not edit."""

from __future__ import annotations

from cnc_ptp.client.asking import Asking, Rows
from cnc_ptp.client.job import Answer


class PlcCommands(Asking):
    """What the PLC can be told. A refusal raises the error of the unit; nothing has changed then."""

    def acknowledge(self, id: int) -> Answer:
        """Acknowledges a handshake request of any channel.

        id  number of the request
        """
        return self._answer("acknowledge", id=id)

    def auto_acknowledge(self, enabled: bool) -> Answer:
        """Whether requests are acknowledged with the next cycle block.

        enabled  on or off
        """
        return self._answer("auto_acknowledge", enabled=enabled)

    def set_life_sign(self, enabled: bool) -> Answer:
        """Life sign of the PLC; without it all units stop.

        enabled  on or off
        """
        return self._answer("set_life_sign", enabled=enabled)

    def set_input(self, name: str, value: float) -> Answer:
        """A value from outside for a [PLC in a file](plc.md#inputs).

        name  of the input
        value  a number; 1 is on, 0 is off
        """
        return self._answer("set_input", name=name, value=value)

    def follow_trajectory(
        self,
        axes: Rows,
        points: Rows,
        *,
        path_tolerance: Rows | None = None,
        goal_tolerance: Rows | None = None,
        goal_time: float | None = None,
    ) -> Answer:
        """Axes follow a [trajectory](ptp.md#trajectories) together.

        axes  names of the axes
        points [s, mm, °]  rows time, positions, velocities, accelerations; each a list of all axes
        path_tolerance [mm, °]  of each axis while it moves; 0: none; left out: none
        goal_tolerance [mm, °]  of each axis at the end; 0: none; left out: none
        goal_time [s]  to come into the goal tolerance; left out: 0
        """
        return self._answer(
            "follow_trajectory",
            axes=axes,
            points=points,
            path_tolerance=path_tolerance,
            goal_tolerance=goal_tolerance,
            goal_time=goal_time,
        )

    def emergency_stop(self, enabled: bool) -> Answer:
        """Everything stops at once and is locked until this is off and each unit was reset.

        enabled  on or off
        """
        return self._answer("emergency_stop", enabled=enabled)

    def reset(self) -> Answer:
        """Resets each unit that is in error."""
        return self._answer("reset")

    def stop_all(self) -> Answer:
        """Stops everything on its ramp."""
        return self._answer("stop_all")
