"""Silent sources: each is reported once, in seconds or in cycles."""

from cnc_ptp.machine.silence import Silence, patience_of


def test_a_source_is_told_once_until_it_is_heard_again():
    silence = Silence(0.2)
    silence.heard("x", 0.0)
    assert silence.fallen_silent(0.2) == [] and silence.is_heard("x", 0.2)
    assert not silence.is_heard("x", 0.25)
    assert [silence.fallen_silent(now) for now in (0.25, 0.3)] == [["x"], []]
    silence.heard("x", 0.4)
    assert silence.fallen_silent(0.7) == ["x"]


def test_a_parameter_of_0_ms_switches_the_watch_off():
    silence = Silence(patience_of(0))
    silence.heard("x", 0.0)
    assert silence.fallen_silent(1e9) == [] and silence.is_heard("x", 1e9)
    assert patience_of(250) == 0.25


def test_what_was_never_heard_or_is_forgotten_is_not_silent():
    silence = Silence(10)
    assert silence.fallen_silent(1000) == [] and not silence.is_heard("x", 0)
    silence.heard("x", 0)
    silence.forget("x")
    assert silence.fallen_silent(1000) == []


def test_a_single_message_is_no_rhythm():
    silence = Silence(0.2, rhythm=True)
    for now in (0.0, 0.2):
        silence.heard("x", now)
    assert silence.fallen_silent(9.0) == []
    silence.heard("x", 0.3)
    assert silence.fallen_silent(0.5) == [] and silence.fallen_silent(0.51) == ["x"]
    silence.heard("x", 9.0)
    assert silence.fallen_silent(20.0) == []


def test_a_rhythm_goes_on_after_a_long_gap_that_nobody_has_looked_at():
    silence = Silence(0.2, rhythm=True)
    for now in (0.0, 0.1, 5.0):
        silence.heard("x", now)
    assert silence.fallen_silent(5.1) == [] and silence.fallen_silent(5.3) == ["x"]


def test_several_sources_come_in_the_order_in_which_they_were_heard_first():
    silence = Silence(1)
    for source in ("y", "x", "y"):
        silence.heard(source, 0)
    assert silence.fallen_silent(2) == ["y", "x"]
