"""What every node process shares: spinning, orderly end, the machine file."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.node import Node

from cnc_ptp.errors import CncError

WRONG_INPUT = 2
SPIN_TIMEOUT = 0.5


def stay_on_this_machine() -> None:
    """Unless the user says otherwise, DDS discovery does not leave the machine."""
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")


def spin(
    nodes: Sequence[Node],
    *,
    done: Callable[[], bool] = lambda: False,
    wait: Callable[[], float] = lambda: SPIN_TIMEOUT,
    after: Callable[[], None] = lambda: None,
) -> None:
    """Runs nodes in one executor until `done`, or until the process is told to end; calls `after` after each wait.

    EventsExecutor.spin() delivers nothing in these wheels, so this loops over spin_once.
    """
    executor = EventsExecutor()
    for node in nodes:
        executor.add_node(node)
    with contextlib.suppress(ExternalShutdownException, KeyboardInterrupt):
        while rclpy.ok() and not done():
            executor.spin_once(timeout_sec=wait())
            after()
    with contextlib.suppress(KeyboardInterrupt):
        for node in nodes:
            node.destroy_node()
        executor.shutdown()
        rclpy.try_shutdown()


def run_node(make: Callable[[], Any], **callbacks: Callable[[Any], Any]) -> int:
    """Makes a node and spins it (callbacks as for `spin`, given the node); a refused start is printed and gives status 2."""
    stay_on_this_machine()
    rclpy.init()
    try:
        node = make()
    except CncError as error:
        print(error, file=sys.stderr)
        rclpy.try_shutdown()
        return WRONG_INPUT
    spin([node], **{name: (lambda call=callback: call(node)) for name, callback in callbacks.items()})
    return 0
