"""A node with subscriptions that wake nobody.

What has come is taken when the node looks: a process that is woken for the last message of a block alone, instead of
for each one, saves most of what a block costs it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription


class PollingNode(Node):
    """A node that keeps some subscriptions from its executor."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self._polled: dict[Subscription[Any], Callable[[bytes], None]] = {}
        super().__init__(*arguments, **options)

    def poll(
        self, message_type: Any, topic: str, received: Callable[[bytes], None], quality: QoSProfile
    ) -> Subscription[Any]:
        """A subscription whose messages come as bytes when `take_polled` is called."""
        subscription = self.create_subscription(message_type, topic, received, quality, raw=True)
        self._polled[subscription] = received
        return subscription

    @property
    def subscriptions(self) -> Iterator[Subscription[Any]]:
        """As Node has it, for executors: those that wake the node."""
        return (subscription for subscription in super().subscriptions if subscription not in self._polled)

    def take_polled(self) -> None:
        """Calls back for every message that has come, topic by topic, oldest first."""
        for subscription, received in self._polled.items():
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
