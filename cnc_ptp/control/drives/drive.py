"""The interface between position controller and drive."""

from __future__ import annotations

from abc import ABC, abstractmethod

from mypy_extensions import mypyc_attr

from cnc_ptp.control.drives.sercos.service_channel import ServiceChannel


@mypyc_attr(allow_interpreted_subclasses=True)
class Drive(ABC):
    """A drive of one axis or spindle; a real one would exchange its process data in `step`.

    Axis units: mm, mm/s (deg, deg/s). Torques are Nm at the motor shaft, or N if a linear axis has no feed constant.
    """

    __slots__ = ("has_torque", "position", "service", "torque", "velocity")

    def __init__(
        self, *, position: float = 0.0, has_torque: bool = False, service: ServiceChannel | None = None
    ) -> None:
        """At a standstill at `position`. `has_torque`: the drive reports its torque."""
        self.position = position
        """Actual position as the telegram gives it, mm or deg."""
        self.velocity = 0.0
        """Actual velocity, mm/s or deg/s."""
        self.torque = 0.0
        """Actual torque, Nm or N; 0.0 if the drive does not report one."""
        self.has_torque = has_torque
        """True if the drive reports its torque."""
        self.service = service
        """Its parameters; None for a drive without a service channel."""

    @abstractmethod
    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """Holds the command for one cycle and takes over the new actual values.

        `command` is the quantity of the drive's interface: velocity in mm/s (deg/s), position or lag in mm (deg),
        torque in Nm (N).
        """
