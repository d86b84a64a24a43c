"""Feedforward and friction compensation as services: what may be left out, refusals with their texts."""

import math

import pytest
from client_support import beside_composed_run
from graph_support import PTP

from cnc_ptp import srv


@pytest.fixture(scope="module")
def client():
    with beside_composed_run(PTP) as node:
        yield node


def test_what_is_left_out_of_a_call_is_on_and_100_percent():
    request = srv.SetFeedforward.Request()
    assert (request.enabled, request.weight_percent) == (True, 100.0)


def test_feedforward_of_an_axis(client):
    client.done("x", "set_feedforward")
    client.done("x", "set_feedforward", enabled=False, weight_percent=80.0)
    client.done("x", "set_feedforward", enabled=True, weight_percent=math.nan)
    client.spin_until(lambda: len(client.commands("x", "set_feedforward")) == 3, "the records")
    assert client.commands("x", "set_feedforward") == [
        ('{"enabled": true, "weight_percent": 100.0}', True),
        ('{"enabled": false, "weight_percent": 80.0}', True),
        ('{"enabled": true}', True),
    ]
    text = "axis x: set_feedforward refused: weight_percent = -0.5 must be a number of 0 or more (G136); nothing was changed"
    client.refused("x", "set_feedforward", 23060, text, enabled=True, weight_percent=-0.5)


def test_friction_compensation_of_an_axis(client):
    client.done("x", "set_friction_compensation", enabled=False)
    reason = "friction compensation is not activated (P-AXIS-00522 lr_param.frict_comp = 0)"
    text = f"axis x: set_friction_compensation refused: {reason}; nothing was changed"
    client.refused("x", "set_friction_compensation", 70495, text, enabled=True)
