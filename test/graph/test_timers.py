"""Timers of nodes, in an executor that lets them stand (as that of the wheels does while the wall clock is set back)."""

from __future__ import annotations

import gc
import time
import warnings
import weakref
from itertools import pairwise

import pytest
from rclpy.node import Node
from ros_support import ros

from cnc_ptp.nodes import process


class Standing(Node):
    """Its executor calls none of its timers in time."""

    def create_timer(self, period, call, clock):
        return super().create_timer(1e6, call, clock=clock)


@pytest.fixture
def node(ros_domain):
    with ros():
        yield Standing("standing")


def test_a_timer_that_stands_is_called_by_the_loop(node):
    called = []
    process.timer(node, 0.02, lambda: called.append(time.monotonic()))
    began = time.monotonic()
    process.spin([node], done=lambda: len(called) >= 5, wait=lambda: 0.005)
    assert all(later - earlier >= 0.02 for earlier, later in pairwise([began, *called]))
    assert called[-1] - began < 5.0


def test_one_that_was_cancelled_is_not(node):
    called = []
    timer = process.timer(node, 0.01, lambda: called.append(timer.cancel()))
    end = time.monotonic() + 0.3
    process.spin([node], done=lambda: time.monotonic() > end, wait=lambda: 0.005)
    assert called == [None]


class Counting(Standing):
    """Its timer calls a method of the node, as all of ours do."""

    called = 0

    def count(self):
        self.called += 1


def run_and_end():
    """A node that has run, of which nobody keeps more than this."""
    node = Counting("counting")
    process.timer(node, 0.01, node.count)
    process.spin([node], done=lambda: node.called > 0, wait=lambda: 0.005)
    return weakref.ref(node)


def test_they_do_not_keep_a_node_that_is_gone(node):
    gone = run_and_end()
    gc.collect()
    assert gone() is None


def test_the_last_node_ends_first(node):
    """In one process that is the recorder."""
    ended = []

    class Noting(Node):
        def destroy_node(self):
            ended.append(self.get_name())
            super().destroy_node()

    process.spin([Noting(name) for name in ("unit", "recorder")], done=lambda: True)
    assert ended == ["recorder", "unit"]


def test_a_response_that_nobody_hears_is_not_for_the_user(node, recwarn):
    """rclpy warns of it with places in its sources; other warnings are told."""
    told = iter(["failed to send response (timeout): client will not receive response, at /a.cpp:1", "another", ""])
    said = []

    def after():
        if text := next(told):
            warnings.warn(text, RuntimeWarning, stacklevel=1)
        said.append(text)

    process.spin([node], done=lambda: len(said) == 3, wait=lambda: 0.0, after=after)
    assert [str(each.message) for each in recwarn] == ["another"]
