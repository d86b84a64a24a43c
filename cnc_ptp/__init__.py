"""A CNC and axis kernel as a ROS 2 node graph."""

from cnc_ptp.compiled.finder import choose_kernel

INTERPRETED_BECAUSE = choose_kernel()
"""Why the kernel runs interpreted; empty when it is compiled."""
