"""A CNC and axis kernel as a ROS 2 node graph."""

from cnc_ptp.compiled.finder import Kernel

KERNEL = Kernel()
"""Compiled or interpreted; chosen before any module of it is imported."""
KERNEL.choose()
