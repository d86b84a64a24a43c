"""Jerk-limited profiles: plan -> immutable table of constant-jerk segments -> pure evaluation at a time.

Units: mm, s, mm/s, mm/s², mm/s³ (deg instead of mm for rotary axes).
"""

from cnc_ptp.motion.batch import RestToRestBatch, plan_rest_to_rest_batch
from cnc_ptp.motion.limits import Limits
from cnc_ptp.motion.profile import Profile
from cnc_ptp.motion.ramp import stopping_distance
from cnc_ptp.motion.rest_to_rest import plan_rest_to_rest
from cnc_ptp.motion.sine_profile import sine_from_rest, sine_stopping_distance, sine_to_position, sine_to_rest
from cnc_ptp.motion.step_profile import step_stopping_distance, step_to_position, step_to_velocity
from cnc_ptp.motion.through_position import plan_through_position
from cnc_ptp.motion.to_position import plan_to_position, plan_with_ramp
from cnc_ptp.motion.to_velocity import plan_to_velocity

__all__ = [
    "Limits",
    "Profile",
    "RestToRestBatch",
    "plan_rest_to_rest",
    "plan_rest_to_rest_batch",
    "plan_through_position",
    "plan_to_position",
    "plan_to_velocity",
    "plan_with_ramp",
    "sine_from_rest",
    "sine_stopping_distance",
    "sine_to_position",
    "sine_to_rest",
    "step_stopping_distance",
    "step_to_position",
    "step_to_velocity",
    "stopping_distance",
]
