"""What the PLC makes of jog messages: a command for each change, an end for each silence."""

import math

import pytest

from cnc_ptp.nodes.jog_topics import PATIENCE, JogTopics


def test_only_changes_are_commands():
    jogs = JogTopics()
    asked = [0.0, 5.0, 5.0, -5.0, 0.0, 0.0, 5.0]
    assert [jogs.heard("x", velocity, 0.1 * n) for n, velocity in enumerate(asked)] == [
        None,
        5.0,
        None,
        -5.0,
        0.0,
        None,
        5.0,
    ]
    assert jogs.heard("c", 5.0, 0.7) == 5.0


@pytest.mark.parametrize("nonsense", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_ends_the_jog(nonsense):
    jogs = JogTopics()
    assert jogs.heard("x", nonsense, 0.0) is None
    jogs.heard("x", 5.0, 0.1)
    assert jogs.heard("x", nonsense, 0.2) == 0.0


def test_silence_ends_a_jog_once_and_the_next_message_begins_a_new_one():
    jogs = JogTopics()
    jogs.heard("x", 5.0, 0.0)
    jogs.heard("y", 0.0, 0.0)
    assert jogs.fallen_silent(PATIENCE) == []
    jogs.heard("x", 5.0, 0.15)
    assert jogs.fallen_silent(PATIENCE + 0.1) == []
    assert jogs.fallen_silent(PATIENCE + 0.16) == ["x"]
    assert jogs.fallen_silent(9.0) == []
    assert jogs.heard("x", 5.0, 9.1) == 5.0


def test_a_second_client_is_foreign_while_the_first_one_jogs():
    jogs = JogTopics()
    assert not jogs.is_foreign("x", "a", 0.0)
    jogs.heard("x", 5.0, 0.0)
    assert jogs.is_foreign("x", "b", 0.1) and jogs.is_foreign("x", "", 0.1)
    assert not jogs.is_foreign("x", "a", 0.1) and not jogs.is_foreign("y", "b", 0.1)
    jogs.heard("x", 0.0, 0.1)
    assert not jogs.is_foreign("x", "b", 0.15)
    jogs.heard("x", -5.0, 0.15)
    assert jogs.is_foreign("x", "a", 0.16)
    assert not jogs.is_foreign("x", "a", 0.16 + 2 * PATIENCE)
