"""A node with subscriptions that wake nobody.

What has come is taken when the node looks: a process that is woken for the last message of a block alone, instead of
for each one, saves most of what a block costs it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

from cnc_ptp.errors import CncError
from cnc_ptp.wire.unreadable import UNREADABLE_MESSAGE

Received = Callable[[bytes], None]
UNWRITTEN_PERIOD = 0.05
"""Seconds between two looks at inputs that nobody writes."""
KNOWN_TYPES = {of.value for of in Parameter.Type}


class PollingNode(Node):
    """A node that keeps some subscriptions from its executor."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self._polled: dict[Subscription[Any], Received] = {}
        self._inputs_polled: dict[Subscription[Any], Received] = {}
        self._inputs_due = 0.0
        self._written: dict[Subscription[Any], Received] = {}
        """Of the inputs, those that had a publisher lately."""
        self._all_inputs_due = 0.0
        self.input_period = 0.0
        """Seconds between two looks for inputs; 0: at each look, infinite: only with `take_inputs`."""
        self._unreadable: set[str] = set()
        """Topics of which a message could not be read."""
        super().__init__(*arguments, **options)

    def poll(self, message_type: Any, topic: str, received: Received, quality: QoSProfile) -> Subscription[Any]:
        """A subscription whose messages come as bytes when `take_polled` is called."""
        received = self.readable(topic, received)
        subscription = self.create_subscription(message_type, topic, received, quality, raw=True)
        self._polled[subscription] = received
        return subscription

    def poll_input(self, message_type: Any, topic: str, received: Received, quality: QoSProfile) -> None:
        """As `poll`, for what is not needed at each look; what people write comes slower than looks in free run."""
        received = self.readable(topic, received)
        subscription = self.create_subscription(message_type, topic, received, quality, raw=True)
        self._inputs_polled[subscription] = received

    def readable(self, topic: str, received: Received) -> Received:
        """Takes messages as `received`; one that cannot be read (26184) is left out, and the first of a topic told."""

        def take(data: bytes) -> None:
            try:
                received(data)
            except CncError as error:
                if error.number != UNREADABLE_MESSAGE:
                    raise
                self.leave_out(topic, error)

        return take

    def leave_out(self, topic: str, error: CncError) -> None:
        """Says that a topic has a message that cannot be read, once."""
        if topic not in self._unreadable:
            self._unreadable.add(topic)
            self.tell_unreadable(f"{self.get_name()}: topic {topic}: {error.message}")

    def create_service(self, srv_type: Any, srv_name: str, callback: Any, **options: Any) -> Any:
        """As Node. Those of rclpy for parameters would end the node with a value whose type there is not."""
        if srv_type in (SetParameters, SetParametersAtomically):
            callback = partial(of_known_types, callback)
        return super().create_service(srv_type, srv_name, callback, **options)

    def tell_unreadable(self, text: str) -> None:
        """To those that look at the node's log; units make an event of it."""
        self.get_logger().warning(f"P-WARN-{UNREADABLE_MESSAGE} {text}")

    @property
    def subscriptions(self) -> Iterator[Subscription[Any]]:
        """As Node has it, for executors: those that wake the node."""
        polled = self._polled, self._inputs_polled
        return (each for each in super().subscriptions if not any(each in of_kind for of_kind in polled))

    def take_polled(self) -> None:
        """Calls back for every message that has come, topic by topic, oldest first."""
        take_all(self._polled)
        if self._inputs_polled and (now := time.monotonic()) >= self._inputs_due:
            self._inputs_due = now + self.input_period
            self.take_written_inputs()

    def take_inputs(self) -> None:
        """The same for those of `poll_input`, now."""
        take_all(self._inputs_polled)

    def take_written_inputs(self) -> None:
        """As `take_inputs`; topics without a publisher, most of a machine's, are looked at every UNWRITTEN_PERIOD."""
        if (now := time.monotonic()) < self._all_inputs_due:
            take_all(self._written)
            return
        self._all_inputs_due = now + UNWRITTEN_PERIOD
        self.take_inputs()
        self._written = {each: take for each, take in self._inputs_polled.items() if each.get_publisher_count()}


def of_known_types(set_parameters: Callable[[Any, Any], Any], request: Any, response: Any) -> Any:
    """A value of another type than rclpy knows is one that is not set."""
    for each in request.parameters:
        if each.value.type not in KNOWN_TYPES:
            each.value.type = ParameterType.PARAMETER_NOT_SET
    return set_parameters(request, response)


def take_all(polled: Mapping[Subscription[Any], Received]) -> None:
    for subscription, received in polled.items():
        handle: Any = subscription.handle
        while True:
            with handle:
                taken = handle.take_message(subscription.msg_type, True)
            if taken is None:
                break
            received(taken[0])


def chain(decode: Callable[[bytes], Any], take: Callable[[Any], None]) -> Callable[[bytes], None]:
    """Takes what bytes stand for."""
    return lambda data: take(decode(data))
