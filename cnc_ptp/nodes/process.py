"""What every node process shares: start of ROS, spinning, orderly end."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Callable, Iterator, MutableMapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import get_rmw_implementation_identifier

from cnc_ptp.errors import CncError
from cnc_ptp.interrupt import EndRequest

FAILED = 1
WRONG_INPUT = 2
SIGNALLED = 128
"""Exit status of a node that a signal has ended: this plus the signal's number, as shells have it."""
DOMAIN_TAKEN = 26107
NO_ROS = 26108
HIGHEST_DOMAIN = 232
"""The UDP port numbers of DDS end there."""
PRIORITY = 5
"""Of 1 ... 99: above all ordinary programs, below what the kernel runs at 50."""
SPIN_TIMEOUT = 0.1
"""Seconds after which a spinning process looks whether it was told to end."""
PATIENCE = 3.0
"""Seconds that a process which was told to end may take to bring its work to an end."""

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PROFILE = "FASTDDS_DEFAULT_PROFILES_FILE"
OWN_SETTINGS = (PROFILE, "FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS", "ROS_LOCALHOST_ONLY")
"""Who sets one of these has decided how messages travel."""


def set_environment(environment: MutableMapping[str, str], rmw: str) -> None:
    """Keeps ROS on this machine, without shared memory (localhost.xml says why), unless the user wants it otherwise."""
    own = any(name in environment for name in OWN_SETTINGS) or environment.get(RANGE, "LOCALHOST") != "LOCALHOST"
    if own or not rmw.startswith("rmw_fastrtps"):
        environment.setdefault(RANGE, "LOCALHOST")
        return
    environment[RANGE] = "SYSTEM_DEFAULT"  # LOCALHOST itself would add shared memory, whatever a profile says
    environment[PROFILE] = str(Path(__file__).with_name("localhost.xml"))


@contextmanager
def priority(real_time: bool) -> Iterator[None]:
    """Real-time scheduling for what this thread does and for the threads that it starts, where the system allows it.

    Root may, and users to whom limits.conf gives rtprio; nodes then keep their time beside other busy programs.
    """
    if not real_time:
        yield
        return
    before, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    with suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(PRIORITY))
    try:
        yield
    finally:
        with suppress(PermissionError):
            os.sched_setscheduler(0, before, parameters)


def initialise() -> None:
    """Starts ROS; signals stay with the caller. Raises CncError 26108 when it does not start."""
    set_environment(os.environ, get_rmw_implementation_identifier())
    try:
        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:
        raise CncError(NO_ROS, f"ROS does not start: {error}; nothing was started") from None
    domain = rclpy.get_default_context().get_domain_id()
    if domain > HIGHEST_DOMAIN:
        rclpy.try_shutdown()
        reason = f"ROS_DOMAIN_ID = {domain} is not within 0 ... {HIGHEST_DOMAIN}"
        raise CncError(NO_ROS, f"ROS does not start: {reason}; nothing was started")


def claim_domain() -> socket.socket:
    """Holds the ROS domain of this machine for one run, until the process ends. Raises CncError 26107 when it is taken.

    The nodes of two runs on one domain would hear each other.
    """
    domain = rclpy.get_default_context().get_domain_id()
    claim = socket.socket(socket.AF_UNIX)
    try:
        claim.bind(f"\0cnc_ptp/domain/{domain}")
    except OSError:
        claim.close()
        raise CncError(
            DOMAIN_TAKEN,
            f"a run is under way on ROS domain {domain} of this machine; nothing was started. "
            "Wait for its end, or set ROS_DOMAIN_ID to another number",
        ) from None
    return claim


def spin(
    nodes: Sequence[Node],
    *,
    done: Callable[[], bool],
    wait: Callable[[], float] = lambda: SPIN_TIMEOUT,
    after: Callable[[], None] = lambda: None,
) -> None:
    """Runs nodes in one executor until `done`; calls `after` after each wait. Ends ROS.

    A CncError that a node keeps in `failure` is raised here: out of a callback the executor would print a traceback.
    EventsExecutor.spin() delivers nothing in these wheels, so this loops over spin_once.
    """
    executor = EventsExecutor()
    try:
        for node in nodes:
            executor.add_node(node)
        while not done():
            executor.spin_once(timeout_sec=wait())
            after()
            for node in nodes:
                if failure := getattr(node, "failure", None):
                    raise failure
        for node in nodes:
            node.destroy_node()
    finally:
        executor.shutdown()
        rclpy.try_shutdown()


def run_node(
    make: Callable[[], Any],
    *,
    done: Callable[[Any], bool] = lambda node: False,
    settled: Callable[[Any], bool] = lambda node: True,
    wait: Callable[[Any], float] = lambda node: SPIN_TIMEOUT,
    after: Callable[[Any], None] = lambda node: None,
    real_time: bool = False,
) -> int:
    """Makes a node and spins it until `done(node)`, or until a signal came and the node has `settled`.

    `real_time`: with the priority of a node that keeps time.
    Returns the exit status: 0 done, 1 an error during the work, 2 refused start, 128 + n ended by signal n.
    """
    end = EndRequest()
    with priority(real_time):
        try:
            initialise()
            node = make()
        except CncError as error:
            print(error, file=sys.stderr)
            rclpy.try_shutdown()
            return WRONG_INPUT

        def is_over() -> bool:
            return done(node) or (end.given and (settled(node) or end.over(PATIENCE)))

        try:
            spin([node], done=is_over, wait=lambda: wait(node), after=lambda: after(node))
        except CncError as error:
            print(error, file=sys.stderr)
            return FAILED
    return SIGNALLED + end.number if end.given else 0
