"""Error numbers of position control, for axes and spindles."""

FOLLOWING_ERROR = 0x4550
TARGET_MISSED = 70082
"""The position window was not reached in time."""
