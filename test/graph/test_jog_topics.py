"""Jog messages at the PLC: a command for each change, an end for each silence."""

import math
from itertools import count

import pytest

from cnc_ptp import msg
from cnc_ptp.nodes.bridge.jog_topics import KNOWN_CLIENTS, PATIENCE, JogTopics

SILENT = (26134, "plc: no message on /x/jog for 200 ms; the jog of x ends")
SECOND = (26144, "plc: /x/jog has a second client '{}'; it is ignored while the first one jogs x")
FREE_RUN = (26145, "plc: /x/jog has no effect in free run, where 200 ms may be a long motion")


class Jogs:
    """Jog topics, and clients that number their messages."""

    def __init__(self):
        self.warnings = []
        self.topics = JogTopics(lambda number, text: self.warnings.append((number, text)))
        self._numbers = {}

    def heard(self, axis, velocity, now, *, client="a", paced=True, sequence=None, valid=True):
        numbers = self._numbers.setdefault(client, count(1))
        message = msg.Jog(sequence=sequence or next(numbers), valid=valid, velocity=velocity)
        message.header.frame_id = client
        return self.topics.heard(axis, message, now, paced=paced)


@pytest.fixture
def jogs():
    return Jogs()


def test_only_changes_are_commands(jogs):
    asked = [0.0, 5.0, 5.0, -5.0, 0.0, 0.0, 5.0]
    commanded = [None, 5.0, None, -5.0, 0.0, None, 5.0]
    assert [jogs.heard("x", velocity, 0.1 * n) for n, velocity in enumerate(asked)] == commanded
    assert jogs.heard("c", 5.0, 0.7) == 5.0
    assert jogs.warnings == []


@pytest.mark.parametrize("nonsense", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_ends_the_jog(jogs, nonsense):
    assert jogs.heard("x", nonsense, 0.0) is None
    jogs.heard("x", 5.0, 0.1)
    assert jogs.heard("x", nonsense, 0.2) == 0.0


def test_a_message_that_is_not_valid_ends_the_jog(jogs):
    jogs.heard("x", 5.0, 0.1)
    assert jogs.heard("x", 5.0, 0.2, valid=False) == 0.0


def test_silence_ends_a_jog_once_and_the_next_message_begins_a_new_one(jogs):
    jogs.heard("x", 5.0, 0.0)
    jogs.heard("y", 0.0, 0.0)
    assert jogs.topics.fallen_silent(PATIENCE) == []
    jogs.heard("x", 5.0, 0.15)
    assert jogs.topics.fallen_silent(PATIENCE + 0.1) == []
    assert jogs.topics.fallen_silent(PATIENCE + 0.16) == ["x"]
    assert jogs.topics.fallen_silent(9.0) == []
    assert jogs.heard("x", 5.0, 9.1) == 5.0
    assert jogs.warnings == [SILENT]


def test_a_second_client_is_ignored_while_the_first_one_jogs(jogs):
    assert jogs.heard("x", 5.0, 0.0) == 5.0
    for client in ("b", "", "b"):
        assert jogs.heard("x", -9.0, 0.1, client=client) is None
    assert jogs.warnings == [(SECOND[0], SECOND[1].format(client)) for client in ("b", "")]
    assert jogs.heard("x", 6.0, 0.1) == 6.0 and jogs.heard("y", 1.0, 0.1, client="b") == 1.0
    assert jogs.heard("x", 0.0, 0.1) == 0.0
    assert jogs.heard("x", -5.0, 0.15, client="b") == -5.0
    assert jogs.heard("x", 5.0, 0.16) is None
    assert jogs.heard("x", 5.0, 0.16 + 2 * PATIENCE) == 5.0


def test_each_client_numbers_its_own_messages(jogs):
    """After a client that has sent 1200 the other one continues with 31."""
    assert jogs.heard("x", 5.0, 0.0, sequence=30) == 5.0 and jogs.heard("x", 0.0, 0.1, sequence=31) == 0.0
    assert jogs.heard("x", 5.0, 0.2, client="b", sequence=1199) == 5.0
    assert jogs.heard("x", 0.0, 0.3, client="b", sequence=1200) == 0.0
    assert jogs.heard("x", 8.0, 0.4, sequence=32) == 8.0
    assert jogs.heard("x", 9.0, 0.5, sequence=32) is None  # repeated


def test_nothing_is_jogged_in_free_run(jogs):
    assert [jogs.heard("x", velocity, 0.0, paced=False) for velocity in (5.0, -5.0)] == [None, None]
    assert jogs.warnings == [FREE_RUN]
    assert jogs.topics.fallen_silent(9.0) == []
    assert jogs.heard("x", 5.0, 10.0) == 5.0


def test_clients_with_ever_new_names_take_no_more_room(jogs):
    for n in range(KNOWN_CLIENTS + 100):
        assert jogs.heard("x", 5.0, n, client=f"made up {n}") == 5.0
        assert jogs.heard("x", 0.0, n, client=f"made up {n}") == 0.0
    jogs.heard("x", 5.0, 2000.0)
    for n in range(KNOWN_CLIENTS + 100):
        jogs.heard("x", 9.0, 2000.1, client=f"made up {n}")
    assert len(jogs.warnings) == len(jogs.topics._sequence) == KNOWN_CLIENTS
    assert jogs.heard("x", 0.0, 2000.1) == 0.0, "the client that jogs is known"


def test_made_up_names_on_an_axis_silence_no_warning_of_another_one(jogs):
    for axis, names in (("x", KNOWN_CLIENTS + 100), ("y", 1)):
        jogs.heard(axis, 5.0, 1.0)
        for n in range(names):
            jogs.heard(axis, 9.0, 1.1, client=f"made up {n}")
    assert len(jogs.warnings) == KNOWN_CLIENTS + 1 and "/y/jog" in jogs.warnings[-1][1]
