"""When a node looks for messages that do not wake it."""

from __future__ import annotations

from math import inf
from types import SimpleNamespace

import pytest

from cnc_ptp.machine.gate import BlockGate
from cnc_ptp.machine.wiring import Inputs
from cnc_ptp.nodes import process
from cnc_ptp.nodes.unit import unit_node
from cnc_ptp.nodes.unit.unit_node import EARLY, SOON, UnitNode
from cnc_ptp.protocol.blocks import CycleTick, PlcBlock


@pytest.fixture
def time(monkeypatch):
    clock = SimpleNamespace(now=100.0)
    monkeypatch.setattr(unit_node, "time", SimpleNamespace(monotonic=lambda: clock.now))
    return clock


@pytest.fixture
def node():
    """A channel with one axis before its second block, as far as it waits."""
    found = UnitNode.__new__(UnitNode)
    found._gate, found._waking = BlockGate(Inputs(("plc",), ("x",))), {"plc"}
    found._handover, found._early_at, found.looks = None, inf, 0

    def look():
        found.looks += 1

    found.look = look
    found._gate.add_tick(CycleTick(0, 10))
    found._gate.add_block("plc", PlcBlock(0, 10))
    assert found._gate.begin() and found._gate.complete()
    return found


def test_it_waits_to_be_woken_however_many_ticks_there_are(node, time):
    for first in (10, 20, 30):
        node._gate.add_tick(CycleTick(first, 10))
    assert node.wait_time() == process.SPIN_TIMEOUT
    node.after_wait()
    assert node.looks == 0


def test_it_looks_soon_again_for_what_is_missing_behind_that(node, time):
    node._gate.add_tick(CycleTick(10, 10))
    node._gate.add_block("plc", PlcBlock(10, 10))
    for looks in (1, 2):
        assert node.wait_time() == SOON
        node.after_wait()
        assert node.looks == looks
    node._gate.add_block("x", PlcBlock(0, 10))
    node.after_wait()
    assert node.looks == 2 and node.wait_time() == process.SPIN_TIMEOUT


def test_it_looks_once_before_it_is_woken(node, time):
    node._early_at = 100.0 + EARLY * 0.01
    assert node.wait_time() == pytest.approx(EARLY * 0.01)
    node.after_wait()
    assert node.looks == 0
    time.now = 100.0 + EARLY * 0.01
    assert node.wait_time() == 0.0
    for _ in range(2):
        node.after_wait()
    assert node.looks == 1 and node.wait_time() == process.SPIN_TIMEOUT


def test_in_one_process_it_is_told(node, time):
    node._handover = object()
    node._gate.add_tick(CycleTick(10, 10))
    node._gate.add_block("plc", PlcBlock(10, 10))
    assert node.wait_time() == process.SPIN_TIMEOUT
