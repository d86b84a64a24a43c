"""Drive time constant and dead time of responses that SciPy's continuous-time simulation made."""

import numpy as np
import pytest
from commissioning_support import T, trace_of
from long_support import long
from scipy.signal import lsim

from cnc_ptp.commissioning.dynamics import fit_drive
from cnc_ptp.errors import CncError


def ramps(seconds=1.0, top=200.0):
    """Trapezoids of velocity forth and back with rests: 0.1 s ramps, as a jerk-free motion has them."""
    corners = np.array([0.0, 0.1, 0.2, 0.35, 0.45, 0.55, 0.65, 0.8, 0.9, 1.0]) * seconds
    values = np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0]) * top
    return np.interp(np.arange(round(seconds / T)) * T, corners, values)


def response(command, time_constant, dead=0, gain=1.0):
    """Velocity of a continuous first-order lag whose command is held for a cycle, `dead` cycles late."""
    late = np.concatenate([np.zeros(dead), command[: len(command) - dead]])
    if time_constant == 0.0:
        return gain * np.concatenate([[0.0], late[:-1]])
    system = ([gain], [time_constant, 1.0])
    return lsim(system, late, np.arange(len(command)) * T, interp=False)[1]


def recording(time_constant, dead=0, gain=1.0, noise=0.0, command=None, **columns):
    command = ramps() if command is None else command
    actual = response(command, time_constant, dead, gain)
    actual = actual + noise * np.random.default_rng(5).standard_normal(len(actual))
    return trace_of(set_velocity=command, command_velocity=command, actual_velocity=actual, **columns)


@pytest.mark.parametrize("time_constant", [0.0, 0.003, 0.05, *long([0.0003, 0.001, 0.0077])])
@pytest.mark.parametrize("dead", [0, 1, 3, 20])
def test_time_constant_and_dead_time_come_back(time_constant, dead):
    fit = fit_drive(recording(time_constant, dead))
    assert fit.dead_cycles == dead
    assert fit.time_constant == pytest.approx(time_constant, rel=1e-4, abs=2e-5)
    assert fit.gain == pytest.approx(1.0, rel=1e-6)
    assert fit.misfit < 1e-5
    assert fit.alternatives == ((fit.time_constant, dead),)
    assert fit.delay == pytest.approx(time_constant + dead * T, rel=1e-4, abs=2e-5)


def way_of_a_cycle(command, time_constant, dead=0):
    """Mean velocities of the cycles before, from the positions of the continuous lag before an integrator."""
    late = np.concatenate([np.zeros(dead), command[: len(command) - dead]])
    system = ([1.0], [time_constant, 1.0, 0.0] if time_constant else [1.0, 0.0])
    position = lsim(system, late, np.arange(len(command)) * T, interp=False)[1]
    return np.diff(position, prepend=0.0) / T


@pytest.mark.parametrize("time_constant", [0.0, 0.003, 0.05, *long([0.0003, 0.001, 0.0077])])
@pytest.mark.parametrize("dead", [0, 20, *long([1])])
def test_a_velocity_that_is_the_way_of_the_last_cycle_gives_the_same(time_constant, dead):
    """A telegram without actual velocity. Taken as momentary, 3 ms would be 3.5 ms."""
    command = ramps()
    actual = way_of_a_cycle(command, time_constant, dead)
    fit = fit_drive(trace_of(set_velocity=command, actual_velocity=actual, mean_velocity=True))
    assert fit.dead_cycles == dead
    assert fit.time_constant == pytest.approx(time_constant, rel=1e-4, abs=2e-5)
    assert (fit.gain, fit.misfit) == (pytest.approx(1.0, rel=1e-6), pytest.approx(0.0, abs=1e-5))


@pytest.mark.parametrize("mean_velocity", [True, *long([False])])
def test_a_recording_that_begins_in_motion(mean_velocity):
    """The velocity at its beginning is unknown, and found with the lag."""
    command = np.tile(ramps(), 2)
    actual = (way_of_a_cycle if mean_velocity else response)(command, 0.004)
    for first in (130, 410, 460):
        trace = trace_of(set_velocity=command[first:], actual_velocity=actual[first:], mean_velocity=mean_velocity)
        assert fit_drive(trace).time_constant == pytest.approx(0.004, rel=1e-4)


def test_a_wrong_velocity_scaling_shows_as_gain():
    fit = fit_drive(recording(0.003, gain=0.95))
    assert (fit.gain, fit.time_constant) == (pytest.approx(0.95), pytest.approx(0.003, rel=1e-4))


@pytest.mark.parametrize("noise", [5.0, *long([0.1, 1.0])])
def test_noise_on_the_velocity_does_not_bend_the_result(noise):
    """A regression of v[k+1] on v[k] would find a Ta far too short; 5 mm/s of noise are 2.5 % of the top speed."""
    fit = fit_drive(recording(0.010, noise=noise, command=np.tile(ramps(), 4)))
    assert fit.delay == pytest.approx(0.010, abs=0.1e-3 * noise)


def test_the_deviation_is_twice_the_least_that_noise_allows():
    """Cramér-Rao: the standard deviation of Ta under white noise s is s / |dv/dTa|, the norm over all cycles."""
    noise, command = 2.0, np.tile(ramps(), 4)
    fit = fit_drive(recording(0.010, noise=noise, command=command))
    slope = (response(command, 0.0101) - response(command, 0.0099)) / 0.0002
    assert fit.deviation == pytest.approx(2.0 * noise / np.linalg.norm(slope), rel=0.3)


@pytest.mark.long
def test_nineteen_of_twenty_results_are_within_their_deviation():
    command, inside = np.tile(ramps(), 2), 0
    actual = response(command, 0.010)
    for seed in range(20):
        noise = np.random.default_rng(seed).standard_normal(len(command))
        fit = fit_drive(trace_of(set_velocity=command, actual_velocity=actual + noise))
        inside += abs(fit.delay - 0.010) <= fit.deviation + 1e-9
    assert inside >= 18


@pytest.mark.parametrize("time_constant", [0.0003, *long([0.0, 0.02])])
def test_a_perfect_fit_has_no_deviation(time_constant):
    assert fit_drive(recording(time_constant)).deviation < 1e-5


def test_the_additive_velocity_is_part_of_the_command():
    command = ramps()
    actual = response(command, 0.004)
    trace = trace_of(
        set_velocity=command, command_velocity=0.2 * command, additive_velocity=0.8 * command, actual_velocity=actual
    )
    assert fit_drive(trace).time_constant == pytest.approx(0.004, rel=1e-4)


def test_gaps_split_the_recording():
    whole = recording(0.004, command=np.tile(ramps(), 2))
    kept = np.r_[0:700, 900:2000]
    columns = {name: getattr(whole, name)[kept] for name in ("set_velocity", "command_velocity", "actual_velocity")}
    fit = fit_drive(trace_of(cycle=kept, **columns))
    assert (fit.dead_cycles, fit.time_constant) == (0, pytest.approx(0.004, rel=1e-4))


def test_an_axis_held_by_friction_at_rest_does_not_count():
    """Between the motions 3 mm/s are commanded in vain."""
    command = ramps()
    actual = response(command, 0.004)
    rest = command == 0.0
    stuck = np.where(rest & (np.arange(len(command)) > 560), 3.0, command)
    trace = trace_of(set_velocity=command, command_velocity=np.tile(command, 1), actual_velocity=actual)
    held = trace_of(set_velocity=command, command_velocity=stuck, actual_velocity=actual)
    assert fit_drive(trace).time_constant == pytest.approx(0.004, rel=1e-4)
    assert fit_drive(held).time_constant == pytest.approx(0.004, rel=0.1)


@pytest.mark.long
def test_a_long_recording_is_cut():
    fit = fit_drive(recording(0.004, command=np.tile(ramps(), 30)))
    assert fit.cycles == 20_000
    assert fit.time_constant == pytest.approx(0.004, rel=1e-4)


def test_a_cycle_time_of_4_ms():
    command = ramps()
    actual = lsim(([1.0], [0.012, 1.0]), command, np.arange(len(command)) * 0.004, interp=False)[1]
    fit = fit_drive(trace_of(cycle_time=0.004, set_velocity=command, actual_velocity=actual))
    assert fit.time_constant == pytest.approx(0.012, rel=1e-4)


@pytest.mark.parametrize(
    ("trace", "text"),
    [
        (
            trace_of(set_velocity=np.ones(50)),
            "P-ERR-27003 axis x: 0.05 s were recorded, at least 0.1 s without a gap are needed; nothing was made",
        ),
        (
            trace_of(set_velocity=np.zeros(500)),
            "P-ERR-27004 axis x: does not move in the recorded 0.5 s; nothing was made",
        ),
        (
            trace_of(set_velocity=ramps(), command_velocity=np.zeros(1000)),
            "P-ERR-27014 axis x: the recording holds no command velocity; nothing was made",
        ),
        (
            trace_of(set_velocity=np.full(500, 30.0)),
            "P-ERR-27012 axis x: the velocity hardly changes in the recording, which says nothing about the drive; nothing "
            "was made, record starts and stops",
        ),
        (
            trace_of(set_velocity=ramps(), actual_velocity=np.random.default_rng(1).standard_normal(1000)),
            "P-ERR-27013 axis x: the actual velocity does not follow the command velocity like a first-order lag (misfit "
            "100 %, at most 20 %); nothing was made, look for errors and the torque limit in the recording",
        ),
    ],
)
def test_recordings_that_say_nothing_are_refused(trace, text):
    with pytest.raises(CncError) as refusal:
        fit_drive(trace)
    assert str(refusal.value) == text
