"""Units of measurement by the names of fields and arguments: `set_velocity` of an axis in mm is in mm/s."""

from __future__ import annotations

DISTANCES = (
    "position",
    "target",
    "distance",
    "length",
    "difference",
    "difference_limit",
    "activation_position",
    "slave_position",
    "slave_offset",
    "following_error",
    "pitch_error",
    "lead",
    "travel",
    "path_tolerance",
    "goal_tolerance",
)
"""`master_position` and `master_offset` have none: their axis is the master, and may be of the other kind."""
VELOCITIES = (
    "velocity",
    "process_velocity",
    "velocity_increase",
    "velocity_difference",
    "command_velocity",
    "feedforward_velocity",
    "additive_velocity",
)
ACCELERATIONS = ("acceleration", "deceleration", "acc_bound")
BY_NAME = {
    **dict.fromkeys(DISTANCES, "{distance}"),
    **dict.fromkeys(VELOCITIES, "{distance}/s"),
    **dict.fromkeys(ACCELERATIONS, "{distance}/s²"),
    "jerk": "{distance}/s³",
    "max_acceleration": "deg/s²",
    "percent": "%",
    "additive_torque": "{torque}",
    "torque": "{torque}",
    "torque_digits": "digits of the drive",
    "friction_current": "digits of the drive",
    "path_velocity": "mm/s",
    "programmed_feed": "mm/s",
    "distance_to_go": "mm",
    "goal_time": "s",
    "delay": "s",
}
BY_SUFFIX = {
    "_rpm": "rpm",
    "_deg_s2": "deg/s²",
    "_deg": "deg",
    "_percent": "%",
}
"""Names that end in their unit; the longer endings come first."""
ROLES = ("set_", "actual_")
MODULO = "_modulo"


def unit_of(name: str, distance: str = "", torque: str = "") -> str:
    """The unit of a field or an argument, empty if there is none.

    `distance`: mm or deg, empty if unknown; `torque`: Nm or N.
    """
    suffix = next((suffix for suffix in BY_SUFFIX if name.endswith(suffix)), "")
    unit = BY_SUFFIX.get(suffix, "") or BY_NAME.get(without_role(name).removesuffix(MODULO), "")
    return "" if "{distance}" in unit and not distance else unit.format(distance=distance, torque=torque)


def without_unit(name: str) -> str:
    """`set_speed_rpm` becomes `set_speed`."""
    return name.removesuffix(next((suffix for suffix in BY_SUFFIX if name.endswith(suffix)), ""))


def without_role(name: str) -> str:
    """`set_velocity` and `actual_velocity` become `velocity`."""
    return name.removeprefix(next((role for role in ROLES if name.startswith(role)), ""))
