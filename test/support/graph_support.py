"""Runs the command line as users do, finds its node processes, compares recordings."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import yaml

from cnc_ptp.commands.run.replay import replay_blocks
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.verify import verify

ROOT = Path(__file__).parents[2]
MILL = ROOT / "config" / "mill.yaml"
LATHE = ROOT / "config" / "lathe.yaml"
PTP = ROOT / "config" / "ptp.yaml"
TIMEOUT = 150.0
"""Seconds: longer than a run whose nodes are started three times (supervisor.START_TIMEOUTS)."""

LAST_WORDS = 60.0
"""Seconds in which a run that was told to end has ended."""

SHORT_PROGRAM = """%short
N10 G90 G17 T1 D1 G135 G136 Y80 Z0
N20 M3 S3000
N30 G0 X10 Y10 Z5
N40 G1 X40 F3000
N50 G2 X50 Y20 I0 J10 M8 X[COMP OFF FRICT]
N60 G4 0.2
N70 G3 X40 Y30 Z2 R10
N80 G1 X0 Y0 Z0 M9
N90 M5
N100 M30
"""
SHORT_SCENARIO = """
- {at: 0.9, to: channel, do: set_override, percent: 50}
- {at: 1.3, to: channel, do: feed_hold, enabled: true}
- {at: 1.6, to: channel, do: feed_hold, enabled: false}
- {at: 1.65, to: channel, do: set_override, percent: 0}
- {at: 1.85, to: channel, do: set_override, percent: 50}
- {at: 1.9, to: s, do: set_override, percent: 80}
- {at: 2.0, to: channel, do: set_override, percent: 120}
- {at: 2.1, to: x, do: move_absolute, target: 20}
"""
LONG_PROGRAM = "%long\nN10 M3 S2000\n" + "N20 G1 X100 Y50 F2000\nN30 G1 X0 Y0 Z-20\nN40 Z0\n" * 20 + "M30\n"


def small_machine(folder):
    """The mill without its Z axis, to save processes."""
    mill = yaml.load(MILL.read_text(), yaml.BaseLoader)
    mill["/machine"]["ros__parameters"]["axes"] = ["x", "y"]
    group = mill["/channel"]["ros__parameters"]["gruppe"]["0"]
    group["achs_anzahl"] = "2"
    del mill["/z"], group["achse"]["2"]
    text = yaml.dump(mill).replace("'", "").replace("- y\n", '- "y"\n').replace("bezeichnung: Y", 'bezeichnung: "Y"')
    path = folder / "small.yaml"
    path.write_text(text)
    return path


def one_axis_machine(folder):
    """The first axis of ptp.yaml alone: quick to start."""
    ptp = yaml.load(PTP.read_text(), yaml.BaseLoader)
    for axis in ("y", "z", "c"):
        del ptp[f"/{axis}"]
    ptp["/machine"]["ros__parameters"]["axes"] = ["x"]
    path = folder / "one.yaml"
    path.write_text(yaml.dump(ptp).replace("'", ""))
    return path


def verified(path, *, whole=True):
    """The recording, after the kernel was re-run from it and every state compared.

    `whole` = False: nodes may have ended at different cycles; what they computed until then is equal.
    """
    recorded = read_recording(path)
    result = verify(recorded, replay_blocks)
    if whole:
        assert result.equal, result.text()
    for topic in result.topics.values():
        first_missing = topic.missing[0] if topic.missing else 0
        tail = list(range(first_missing, first_missing + len(topic.missing)))
        assert not topic.differences and not topic.surplus and not topic.duplicated, result.text()
        assert topic.missing == tail, result.text()
        known = recorded.states.get(topic.topic)  # none if a channel has ended before it has told of its thread
        assert not tail or known is None or known["cycle"].max() < first_missing
    return recorded


def command(*arguments):
    return [sys.executable, "-m", "cnc_ptp", *map(str, arguments)]


def run(*arguments, expect=0):
    """The finished command; fails when its status is another one than expected or it printed a traceback."""
    done = finished(command(*arguments))
    assert done.returncode == expect, done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr, done.stderr
    assert "number of timers" not in done.stdout, "what rclpy says of its executor is not for the user"
    return done


def finished(words):
    """Fails with what it printed, and where its threads are, when it has not ended after TIMEOUT."""
    environment = os.environ | {"PYTHONFAULTHANDLER": "1"}
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment) as process:
        try:
            output = process.communicate(timeout=TIMEOUT)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGABRT)
            raise AssertionError("\n".join(["it hangs:", *process.communicate(timeout=LAST_WORDS)])) from None
    return subprocess.CompletedProcess(words, process.returncode, *output)


class Running:
    """A graph run in the background; it ends with a `with` block, and an error there tells what it printed."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen(
            command("run", *arguments), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self.children = {}

    def __enter__(self):
        return self

    def __exit__(self, _kind, error, _traceback):
        if error and not self.process.stdout.closed:
            self.process.terminate()
            error.add_note(f"The run printed:\n{self._rest_of_output()}")
        self.end()

    def _rest_of_output(self):
        for patience in (LAST_WORDS, 5.0):
            try:
                return self.process.communicate(timeout=patience)[0]
            except subprocess.TimeoutExpired:
                self.process.kill()
        return "(a process that it has left behind keeps it)"

    def wait_for_nodes(self, count):
        """Waits until `count` node processes live; pid by node."""
        deadline = time.monotonic() + TIMEOUT
        while time.monotonic() < deadline:
            self.children = nodes_of(self.process.pid)
            if len(self.children) >= count:
                return self.children
            assert self.process.poll() is None, self.process.stdout.read()
            time.sleep(0.05)
        raise AssertionError(f"only {list(self.children)} started")

    def wait_until_recorded(self, path, size):
        """Waits until the recording holds `size` bytes: the run is well under way."""
        deadline = time.monotonic() + TIMEOUT
        while time.monotonic() < deadline:
            if Path(path).exists() and Path(path).stat().st_size >= size:
                return
            assert self.process.poll() is None, self.process.stdout.read()
            time.sleep(0.05)
        raise AssertionError("nothing was recorded")

    def finish(self, expect):
        output, _ = self.process.communicate(timeout=TIMEOUT)
        assert self.process.returncode == expect, output
        assert "Traceback" not in output, output
        return output

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()


def parent_of(pid):
    return int(Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[1])


def nodes_of(parent):
    """Node processes of a supervisor, forked by a server of its own: module (and unit) -> pid."""
    found = {}
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            words = (entry / "cmdline").read_bytes().decode().replace("\0", " ").split()
            ppid = parent_of(parent_of(int(entry.name)))
        except (OSError, ValueError):
            continue
        modules = [word.removeprefix("cnc_ptp.nodes.") for word in words if word.startswith("cnc_ptp.nodes.")]
        if ppid == parent and modules:
            has_unit = modules[0] in ("axis", "spindle", "nc_channel")
            name = words[words.index(f"cnc_ptp.nodes.{modules[0]}") + 2] if has_unit else modules[0]
            found["plc" if name == "plc_bridge" else name] = int(entry.name)
    return found


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    return state != "Z"


def wait_until_gone(pids):
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline and any(alive(pid) for pid in pids):
        time.sleep(0.05)
    return [pid for pid in pids if alive(pid)]


def wait_for_handler(pid, number):
    """Waits until a process handles a signal on its own."""
    deadline = time.monotonic() + TIMEOUT
    while time.monotonic() < deadline:
        caught = re.search(r"SigCgt:\s*(\w+)", Path(f"/proc/{pid}/status").read_text())[1]
        if int(caught, 16) >> (number - 1) & 1:
            return
        time.sleep(0.05)
    raise AssertionError(f"{signal.Signals(number).name} is not handled")


def kill(pid):
    os.kill(pid, signal.SIGKILL)


def states_equal(first, second):
    """Topics and fields in which two recordings differ, header stamps (wall time) left out."""
    a, b = read_recording(first), read_recording(second)
    assert a.complete and b.complete
    first_rows, second_rows = ({**each.states, **each.threads} for each in (a, b))
    assert first_rows.keys() == second_rows.keys()
    differing = []
    for topic, rows in first_rows.items():
        other = second_rows[topic]
        assert len(rows) == len(other), f"{topic}: {len(rows)} and {len(other)} cycles"
        for name in rows.dtype.names:
            if not name.startswith("header") and rows[name].tobytes() != other[name].tobytes():
                cycle = int(rows["cycle"][np.flatnonzero(rows[name] != other[name])[0]])
                differing.append(f"{topic} {name} from cycle {cycle}")
    return differing
