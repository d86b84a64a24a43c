"""ROS nodes, and what their processes need."""

from cnc_ptp import one_thread  # noqa: F401 - takes effect when it is imported
