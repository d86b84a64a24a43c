"""Frame of every node process: start of ROS, spinning, orderly end."""

from __future__ import annotations

import hashlib
import os
import socket
import sys
import time
import warnings
from collections.abc import Callable, Iterable, MutableMapping, Sequence, Set
from contextlib import redirect_stdout, suppress
from io import StringIO
from math import inf
from pathlib import Path
from typing import Any

import rclpy
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import get_rmw_implementation_identifier

from cnc_ptp.errors import WRONG_INPUT, CncError
from cnc_ptp.interrupt import EndRequest
from cnc_ptp.nodes.unit.parameters import BARE_WORDS, require_known_parameters
from cnc_ptp.ros_arguments import ros_arguments

FAILED = 1
SIGNALLED = 128
"""Exit status of a node that a signal has ended: this plus the signal's number, as shells have it."""
DOMAIN_TAKEN = 26107
NO_ROS = 26108
HIGHEST_DOMAIN = 232
"""The UDP port numbers of DDS end there."""
PRIORITY = 5
"""Of 1 ... 99: above all ordinary programs, below the threads that the kernel runs at 50."""
SPIN_TIMEOUT = 0.1
"""Seconds after which a spinning process checks for a signal to end."""
START_PATIENCE = 2.0
"""Seconds that a node may take for its first block, if the watchdog time is shorter: processes are still busy with each
other's start, and nothing has moved yet."""
LATE_PERIODS = 1.25
"""A timer is late after these. After two, a watchdog takes the computer for suspended."""
READY_PERIOD = 0.05
"""Seconds between two checks of a node that waits for all others."""
UNHEARD_RESPONSE = "failed to send response"
"""rclpy warns so when the client of a service is suspended or gone; the client says itself that it got no answer."""
PATIENCE = 3.0
"""Seconds that a process may take to finish its work after a signal to end."""

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PROFILE = "FASTDDS_DEFAULT_PROFILES_FILE"
OWN_SETTINGS = (PROFILE, "FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS", "ROS_LOCALHOST_ONLY")
"""If the user sets one of these, the choice of transport is theirs."""
ROS_HINTS = {
    "Value type 'bool'": BARE_WORDS,
    "Expecting token or wildcard": "a name with a number in it, like getriebe.0.kv, goes into a --params-file only",
    "lexeme type 19, got 18": "a namespace begins with /",
}
"""Part of what rcl says -> what it means."""


def set_environment(environment: MutableMapping[str, str], rmw: str) -> None:
    """Keeps ROS on this machine, without shared memory (localhost.xml says why), unless the user wants it otherwise."""
    own = any(name in environment for name in OWN_SETTINGS) or environment.get(RANGE, "LOCALHOST") != "LOCALHOST"
    if own or not rmw.startswith("rmw_fastrtps"):
        environment.setdefault(RANGE, "LOCALHOST")
        return
    environment[RANGE] = "SYSTEM_DEFAULT"  # LOCALHOST itself would add shared memory, whatever a profile says
    environment[PROFILE] = str(Path(__file__).with_name("localhost.xml"))


def take_priority(threads: Iterable[int | str] | None = None) -> None:
    """Real-time scheduling for threads of this process, None = all, where the system allows it.

    Root may, and users to whom limits.conf gives rtprio; a node then keeps its time besides other busy programs. Later
    threads and processes do not inherit it.
    """
    for thread in os.listdir("/proc/self/task") if threads is None else threads:
        with suppress(PermissionError, ProcessLookupError):
            os.sched_setscheduler(int(thread), os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(PRIORITY))


def initialise(
    context: Context | None = None, *, words: Sequence[str] | None = None, domain: int | None = None
) -> None:
    """Starts ROS; signals stay with the caller.

    `context`: None = the default one. `words`: ROS arguments, None = those of the command. `domain`: None =
    ROS_DOMAIN_ID. Raises CncError 26108 when it does not start.
    """
    set_environment(os.environ, get_rmw_implementation_identifier())
    words = ros_arguments().words if words is None else [*words]
    try:
        rclpy.init(args=words, context=context, domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:
        reason, _, _place_in_its_source = str(error).partition(", at /")
        hints = "".join(f" ({text})" for part, text in ROS_HINTS.items() if part in reason)
        raise CncError(NO_ROS, f"ROS does not start: {reason}{hints}", "nothing was started") from None
    domain = (context or rclpy.get_default_context()).get_domain_id()
    if domain > HIGHEST_DOMAIN:
        rclpy.try_shutdown(context=context)
        reason = f"ROS_DOMAIN_ID = {domain} is not within 0 ... {HIGHEST_DOMAIN}"
        raise CncError(NO_ROS, f"ROS does not start: {reason}", "nothing was started")


def claim_domain() -> socket.socket:
    """Holds the ROS domain of this machine, or one namespace of it, for one run, until the process ends.

    The nodes of two runs there would receive each other's messages. Raises CncError 26107 when it is taken.
    """
    domain = rclpy.get_default_context().get_domain_id()
    namespace = ros_arguments().namespace
    place = hashlib.sha256(namespace.encode()).hexdigest() if namespace else ""  # names of sockets are short
    claim = socket.socket(socket.AF_UNIX)
    try:
        claim.bind(f"\0cnc_ptp/domain/{domain}{place}")
    except OSError:
        claim.close()
        raise CncError(
            DOMAIN_TAKEN,
            f"a run is under way on ROS domain {domain}{f' in namespace {namespace}' if namespace else ''} "
            "of this machine",
            "nothing was started. Wait for its end, choose another --namespace, or set ROS_DOMAIN_ID to another number",
        ) from None
    return claim


class SteadyTimer:
    """A timer by a clock that cannot be set; `spin` calls for it where the executor does not.

    The executor of these wheels lets its timers stand while the wall clock is set back, whichever clock they have.
    """

    def __init__(self, node: Node, period: float, call: Callable[[], None]) -> None:
        self._late, self._call = LATE_PERIODS * period, call
        self.late_at = time.monotonic() + self._late
        """By the clock that cannot be set; infinite once it is cancelled."""
        self._timer = node.create_timer(period, self.on_time, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def on_time(self) -> None:
        if self.late_at < inf:
            self.late_at = time.monotonic() + self._late
            self._call()

    def cancel(self) -> None:
        self.late_at = inf
        self._timer.cancel()


def timer(node: Node, period: float, call: Callable[[], None]) -> SteadyTimer:
    """Calls each `period` (s), whatever becomes of the wall clock."""
    made = SteadyTimer(node, period, call)
    timers_of(node).append(made)
    return made


def timers_of(node: Node) -> list[SteadyTimer]:
    """The node holds its timers; elsewhere they would keep it alive, because they call it."""
    timers: list[SteadyTimer] = node.__dict__.setdefault("steady_timers", [])
    return timers


def is_read(node: Node, publisher: Publisher[Any], names: Set[str]) -> bool:
    """True when `publisher` of `node` has found readers of all nodes `names` of its namespace.

    Their number alone would take a foreign reader (ros2 topic echo) for one of ours.
    """
    found = node.get_subscriptions_info_by_topic(publisher.topic_name)
    readers = {reader.node_name for reader in found if reader.node_namespace == node.get_namespace()}
    return names <= readers and publisher.get_subscription_count() >= len(names)


def take_nodes(executor: Executor, nodes: Sequence[Node]) -> None:
    """Adds nodes. Each action has a timer, and rclpy prints that eight timers are many: that is not for the user."""
    with redirect_stdout(StringIO()):
        for node in nodes:
            executor.add_node(node)
        executor.spin_once(timeout_sec=0.0)  # it meets the timers there


def spin(
    nodes: Sequence[Node],
    *,
    done: Callable[[], bool],
    wait: Callable[[], float] = lambda: SPIN_TIMEOUT,
    after: Callable[[], None] = lambda: None,
) -> None:
    """Spins nodes in one executor until `done`; calls `after` after each wait. Ends ROS.

    A CncError that a node keeps in `failure` is raised here: out of a callback the executor would print a traceback.
    EventsExecutor.spin() delivers nothing in these wheels, so this loops over spin_once.
    """
    executor = EventsExecutor()
    try:
        take_nodes(executor, nodes)
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", UNHEARD_RESPONSE, RuntimeWarning)
            timers = [timers_of(node) for node in nodes]  # these lists take later ones
            while not done():
                late_at = min([each.late_at for of_node in timers for each in of_node], default=inf)
                executor.spin_once(timeout_sec=max(0.0, min(wait(), late_at - time.monotonic())))
                after()
                if late_at < time.monotonic():
                    call_late(timers)
                raise_failure(nodes)
    finally:
        executor.shutdown()  # before the nodes: messages that arrive meanwhile would call what is destroyed
        for node in reversed(nodes):  # a recorder first: it closes its file before DDS can hold up the end
            node.destroy_node()
        rclpy.try_shutdown()
    raise_failure(nodes)  # of their ends


def call_late(timers: Iterable[Iterable[SteadyTimer]]) -> None:
    """Calls for the executor where it does not."""
    for of_node in timers:
        for each in tuple(of_node):
            if each.late_at < time.monotonic():
                each.on_time()


def raise_failure(nodes: Sequence[Node]) -> None:
    """Raises the CncError of the first node that has one."""
    for node in nodes:
        if failure := getattr(node, "failure", None):
            raise failure


def run_unit(make: Callable[[], Any], *, name: str) -> int:
    """As run_node, for the node of a unit."""
    return run_node(make, name=name, wait=lambda node: node.wait_time(), after=lambda node: node.after_wait())


def run_node(
    make: Callable[[], Any],
    *,
    name: str | None = None,
    done: Callable[[Any], bool] = lambda node: False,
    settled: Callable[[Any], bool] = lambda node: True,
    wait: Callable[[Any], float] = lambda node: SPIN_TIMEOUT,
    after: Callable[[Any], None] = lambda node: None,
) -> int:
    """Makes a node and spins it until `done(node)`, or until a signal came and the node has `settled`.

    `name`: the name that the node must have, because others know it by that; None = any.
    Returns the exit status: 0 done, 1 an error during the work, 2 refused start, 128 + n ended by signal n.
    """
    end = EndRequest()
    try:
        if name is not None:
            ros_arguments().require_name(name)
        initialise()
        node = make()
        require_known_parameters(node)
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
