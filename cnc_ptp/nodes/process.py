"""What every node process shares: start of ROS, spinning, orderly end."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from cnc_ptp.errors import CncError

WRONG_INPUT = 2
SPIN_TIMEOUT = 0.1
"""Seconds after which a spinning process looks whether it was told to end."""

DEFAULTS = {
    "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",  # discovery does not leave the machine
    "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",  # a killed process can lock the shared memory that the others read
}


def initialise() -> None:
    """Starts ROS with our defaults where the user's environment says nothing; signals stay with the caller."""
    for name, value in DEFAULTS.items():
        os.environ.setdefault(name, value)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)


class EndRequest:
    """SIGINT and SIGTERM as a flag: a callback in work is finished, nothing is torn apart."""

    def __init__(self) -> None:
        self.given = False
        self.deadline = 0.0
        """Monotonic time by which the process ends; 0 = not decided yet."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._handle)

    def _handle(self, number: int, frame: object) -> None:
        self.given = True


def spin(
    nodes: Sequence[Node],
    *,
    done: Callable[[], bool],
    wait: Callable[[], float] = lambda: SPIN_TIMEOUT,
    after: Callable[[], None] = lambda: None,
) -> None:
    """Runs nodes in one executor until `done`; calls `after` after each wait. Ends ROS.

    EventsExecutor.spin() delivers nothing in these wheels, so this loops over spin_once.
    """
    executor = EventsExecutor()
    for node in nodes:
        executor.add_node(node)
    while not done():
        executor.spin_once(timeout_sec=wait())
        after()
    for node in nodes:
        node.destroy_node()
    executor.shutdown()
    rclpy.try_shutdown()


def run_node(
    make: Callable[[], Any],
    *,
    done: Callable[[Any], bool] = lambda node: False,
    wait: Callable[[Any], float] = lambda node: SPIN_TIMEOUT,
    after: Callable[[Any], None] = lambda node: None,
) -> int:
    """Makes a node and spins it until `done(node)` or a signal; a refused start is printed and gives status 2."""
    end = EndRequest()
    initialise()
    try:
        node = make()
    except CncError as error:
        print(error, file=sys.stderr)
        rclpy.try_shutdown()
        return WRONG_INPUT
    spin([node], done=lambda: end.given or done(node), wait=lambda: wait(node), after=lambda: after(node))
    return 0
