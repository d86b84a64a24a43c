"""ROS in the process of a test."""

from contextlib import contextmanager

import rclpy

from cnc_ptp.nodes import process


@contextmanager
def ros():
    """It ends with the block, however that ends."""
    process.initialise()
    try:
        yield
    finally:
        rclpy.try_shutdown()
