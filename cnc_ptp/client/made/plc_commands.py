"""The commands of the PLC as methods. Made by cnc_ptp/client/make_commands.py; do not edit."""

from __future__ import annotations

from cnc_ptp.client.asking import Asking
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

    def stop_all(self) -> Answer:
        """Stops everything on its ramp."""
        return self._answer("stop_all")
