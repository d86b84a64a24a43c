"""The command line beside a running machine: status, do, jog, watch; a jog whose client is killed; run --stay."""

import re
import signal
import subprocess
import time

import pytest
from client_support import Client, connected
from graph_support import Running, command, small_machine, verified
from live_support import call, wait_for_machine


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("live")


@pytest.fixture(scope="module")
def machine(folder):
    """A standing mill without Z, all nodes in one process, recorded; its end is checked too."""
    with Running(small_machine(folder), "--stay", "--composed", "--record", folder / "live.mcap") as graph:
        wait_for_machine()
        yield graph
        graph.process.send_signal(signal.SIGINT)
        output = graph.finish(0)
        assert "the machine was ended (SIGINT) with all units at a standstill" in output
        assert "failed" not in output and "stop without effect" not in output
        verified(folder / "live.mcap")


def place(unit):
    """Position or speed that `watch` prints of a unit."""
    done = call("watch", unit, "--time", "0.01")
    assert done.exit_code == 0, done.stderr
    return float(re.search(rf"^{unit}  \w+  (-?[\d.]+) ", done.stdout)[1])


def test_status_shows_all_units(machine):
    done = call("status")
    assert done.exit_code == 0
    (headline, head, *rows) = done.stdout.splitlines()
    assert re.fullmatch(r"ROS domain \d+, cycle \d+", headline)
    assert head.split() == ["unit", "state", "position", "speed", "following", "error", "override", "error", "age"]
    assert [row.split()[:2] for row in rows] == [
        ["channel", "Idle"],
        ["x", "Standstill"],
        ["y", "Standstill"],
        ["s", "Standstill"],
    ]
    assert " mm " in rows[1] and " rpm " in rows[3] and " deg " in rows[3]


def test_commands_are_carried_out_and_waited_for(machine):
    done = call("do", "x", "move_absolute", "target=20", "velocity=100", "--wait")
    assert done.exit_code == 0 and re.match(
        r"x: move_absolute accepted, acts at cycle \d+\nx  Standstill ", done.stdout
    )
    assert place("x") == pytest.approx(20.0, abs=0.5)
    assert call("do", "channel", "mdi", "G1 X5 F6000", "--wait").exit_code == 0
    assert place("x") == pytest.approx(5.0, abs=0.5)
    assert call("do", "s", "start", "direction=ccw", "speed_rpm=300", "--wait").exit_code == 0
    assert "ContinuousMotion" in call("watch", "s", "--time", "0.01").stdout
    assert call("do", "s", "stop", "--wait").exit_code == 0
    assert call("do", "y", "couple", "master=x", "factor=1").exit_code == 0
    assert "SynchronizedMotion" in call("watch", "y", "--time", "0.01").stdout
    assert call("do", "y", "decouple").exit_code == 0


def test_a_warning_is_shown_and_a_refusal_is_status_1(machine):
    done = call("do", "x", "halt")
    assert (done.exit_code, done.stdout.splitlines()[1:]) == (
        0,
        ["warning: P-WARN-23073 axis x: halt without effect in Standstill"],
    )
    done = call("do", "x", "move_absolute", "1e5")
    assert (done.exit_code, done.stdout) == (1, "")
    assert done.stderr == (
        "P-ERR-120002 axis x: move_absolute refused: target 100000.0 mm lies beyond the positive soft limit 300.0 mm "
        "(P-AXIS-00178); nothing was changed\n"
    )


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (
            ["do", "q", "halt"],
            "P-ERR-26111 the machine has no unit 'q'; nothing was sent. Known: channel, x, y, s, plc",
        ),
        (
            ["watch", "plc"],
            "P-ERR-26111 the machine has no channel or axis or spindle 'plc'; nothing was sent. Known: ",
        ),
        (["jog", "s", "+", "--speed", "1"], "P-ERR-26111 the machine has no axis 's'; nothing was sent. Known: x, y"),
        (["do", "x", "move_absolute"], "P-ERR-22001 axis x: move_absolute refused: argument 'target' is missing"),
        (["status", "--namespace", "elsewhere"], "P-ERR-26135 no machine is running on ROS domain "),
        (["status", "--ros-args", "-r", "__ns:=/other"], "P-ERR-26135 no machine is running on ROS domain "),
    ],
)
def test_what_cannot_be_asked_is_status_2(machine, words, text):
    done = call(*words)
    assert done.exit_code == 2 and done.stderr.startswith(text), done.stderr
    assert done.stdout == ""


def test_a_jog_goes_for_a_time_or_a_distance(machine):
    begin = place("y")
    done = call("jog", "y", "+", "--speed", "10", "--time", "0.5")
    assert done.exit_code == 0 and re.fullmatch(r"y: Standstill at -?[\d.]+ mm\n", done.stdout), done.stderr
    assert 2.0 < place("y") - begin < 12.0
    begin = place("y")
    assert call("jog", "y", "-", "--speed", "10", "--distance", "5").exit_code == 0
    assert 2.0 < begin - place("y") < 8.0


def test_a_jog_that_is_refused_or_ends_at_the_limit_says_so(machine):
    done = call("jog", "x", "+", "--speed", "5000")
    assert done.exit_code == 1
    assert "jog refused: velocity 5000.0 mm/s is above the maximum 500.0 mm/s (P-AXIS-00212)" in done.stderr
    assert call("do", "x", "move_absolute", "290", "--wait").exit_code == 0
    done = call("jog", "x", "+", "--speed", "100")
    assert done.exit_code == 0 and "x: Standstill at " in done.stdout
    assert "P-ERR-23070 axis x: the jog has reached the positive soft limit 300.0 mm (P-AXIS-00178)" in done.stderr
    assert place("x") == pytest.approx(300.0, abs=0.1)


def test_watch_prints_lines_until_it_is_told_to_end(machine):
    done = subprocess.Popen(command("watch", "x", "s", "--rate", "20"), stdout=subprocess.PIPE, text=True)
    lines = [done.stdout.readline() for _ in range(6)]
    done.send_signal(signal.SIGINT)
    assert done.wait(timeout=30.0) == 0
    assert [line.split()[0] for line in lines] == ["x", "s"] * 3


def test_an_interrupt_ends_the_waiting_and_not_the_motion(machine):
    words = command("do", "y", "move_relative", "distance=30", "velocity=0.5", "--wait")
    waiting = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert "accepted" in waiting.stdout.readline()
    time.sleep(1.0)  # the signal counts for the waiting from a moment after this line on
    waiting.send_signal(signal.SIGINT)
    told, _ = waiting.communicate(timeout=30.0)
    assert (waiting.returncode, told) == (130, "y: no longer waited for (SIGINT); it continues\n")
    first, second = place("y"), place("y")
    assert second > first
    assert call("do", "y", "stop", "--wait").exit_code == 0


def test_a_motion_that_is_stopped_on_its_way_is_status_1(machine):
    words = command("do", "y", "move_relative", "distance=30", "velocity=0.5", "--wait")
    waiting = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert "accepted" in waiting.stdout.readline()
    assert call("do", "y", "halt", "--wait").exit_code == 0
    _, errors = waiting.communicate(timeout=30.0)
    assert (waiting.returncode, errors) == (1, "y: stopped before its end\n")
    assert call("do", "y", "set_override", "100", "--wait").exit_code == 0  # which begins nothing


def test_a_second_jog_is_told_that_it_is_ignored(machine):
    """Up to four times: a busy machine may suspend the first jog for longer than 0.2 s, which ends it."""
    assert any(is_ignored_beside_a_jog() for _ in range(4))


def is_ignored_beside_a_jog() -> bool:
    """Whether a second jog is ignored; False if the first one has ended automatically, so that the second moves."""
    first = subprocess.Popen(command("jog", "y", "+", "--speed", "0.5"), stdout=subprocess.PIPE, text=True)
    second = None
    while first.poll() is None and second is None:
        if re.search(r"y +ContinuousMotion", call("status").stdout):
            second = call("jog", "y", "-", "--speed", "8", "--time", "5")
    first.send_signal(signal.SIGINT)
    if first.wait(timeout=30.0) != 0 or second is None or second.exit_code == 0:
        return False
    assert (second.exit_code, second.stdout) == (1, "")
    assert "y: the jog is ignored: another client jogs the axis, or the machine is in free run" in second.stderr
    return True


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_an_axis_halts_on_its_ramp_when_the_client_is_gone(machine, number, folder):
    """Killed, or stalled, which no one but the watcher of the messages could notice."""
    path = folder / "small.yaml"
    with connected(Client, path) as client:
        client.wait_blocks("plc", 3)
        watch_a_jog_end(client, number)


def watch_a_jog_end(client, number):
    jog = subprocess.Popen(command("jog", "y", "+", "--speed", "20"), stdout=subprocess.DEVNULL)
    try:
        client.wait_last("y", lambda block: block.set_velocity[-1] == pytest.approx(20.0), "the jog")
        seen = len(client.blocks["y"])
        jog.send_signal(number)
        client.wait_last("y", lambda block: block.state[-1] == 1 and block.set_velocity[-1] == 0.0, "the halt")
        blocks = [client.blocks["y"][n] for n in range(seen, len(client.blocks["y"]))]
        velocity = [v for block in blocks for v in block.set_velocity]
        falling = velocity[next(n for n, v in enumerate(velocity) if v < 20.0 - 1e-9) :]
        assert falling == sorted(falling, reverse=True) and falling[-1] == 0.0
        assert len([v for v in falling if v > 0.0]) > 5, "it has stopped without a ramp"
        assert len(velocity) - len(falling) < 1500, "it continued for more than a second"
        told = "plc: no message on /y/jog for 200 ms; the jog of y ends"
        client.spin_until(lambda: any(event.text == told and event.error_id == 26134 for event in client.events), told)
        if number == signal.SIGSTOP:
            seen = len(client.blocks["y"])
            jog.send_signal(signal.SIGCONT)
            assert jog.wait(timeout=30.0) == 1
            moved = [v for n in range(seen, len(client.blocks["y"])) for v in client.blocks["y"][n].set_velocity]
            assert not any(moved), "it has started again on its own"
    finally:
        jog.kill()
        jog.wait()
