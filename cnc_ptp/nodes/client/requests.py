"""Arguments of commands as requests of their services; what comes back is in nodes/unit/requests.py."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.unit.requests import NOT_GIVEN
from cnc_ptp.protocol.commands import BAD_ARGUMENT


def request_of(service: Any, arguments: Mapping[str, Any]) -> Any:
    """A request with these arguments; what is left out is so there too, whatever the default of its field is."""
    request = service.Request()
    for name, kind in service.Request.get_fields_and_field_types().items():
        if name in arguments:
            value = arguments[name]
            setattr(request, name, [ROW_MESSAGES[name](row) for row in value] if name in ROW_MESSAGES else value)
        elif name.startswith("has_"):
            setattr(request, name, name.removeprefix("has_") in arguments)
        elif kind == "double" and getattr(request, name) != NOT_GIVEN:
            setattr(request, name, math.nan)
    if "files" in arguments:
        request.file_names, request.file_texts = [*arguments["files"]], [*arguments["files"].values()]
    if "table" in arguments:
        request.master_points = [float(master) for master, _ in arguments["table"]]
        request.slave_points = [float(slave) for _, slave in arguments["table"]]
    return request


def setpoint_of(row: Sequence[float]) -> msg.ExternalSetpoint:
    """The message of a row that read_setpoint takes."""
    cycle, position, velocity, acceleration, direction = row
    return msg.ExternalSetpoint(
        valid=True,
        cycle=int(cycle),
        position=float(position),
        velocity=float(velocity),
        acceleration=float(acceleration),
        direction=int(direction),
    )


def point_of(row: Sequence[Any]) -> msg.TrajectoryPoint:
    """The message of a point of a trajectory: time, positions, velocities, accelerations. Raises CncError 22001."""
    try:
        time, *lists = row
        values = [[float(value) for value in each] for each in lists]
        positions, velocities, accelerations = [*values, [], []][:3]
        return msg.TrajectoryPoint(
            time=float(time), positions=positions, velocities=velocities, accelerations=accelerations
        )
    except (TypeError, ValueError):
        reason = f"point {row!r} is not time, positions, velocities and accelerations"
        raise CncError(BAD_ARGUMENT, reason, "nothing was sent", where="plc: follow_trajectory") from None


ROW_MESSAGES = {"setpoints": setpoint_of, "points": point_of}
"""Arguments whose rows are messages."""
