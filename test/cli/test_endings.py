"""Early ends of a run: interrupt, full disk; and the terminal's view of them."""

import os
import pty
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from cnc_ptp import cli
from cnc_ptp.commands.run.replay import replay_blocks
from cnc_ptp.interrupt import EndRequest
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.verify import verify

ROOT = Path(__file__).parents[2]
MILL = ROOT / "config" / "mill.yaml"
BRACKET = ROOT / "examples" / "bracket.nc"


def call(*arguments):
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


def command(*arguments):
    return [sys.executable, "-m", "cnc_ptp", *map(str, arguments)]


def wait_for_size(path, size):
    deadline = time.monotonic() + 60.0
    while not (path.exists() and path.stat().st_size >= size):
        assert time.monotonic() < deadline, "nothing was recorded"
        time.sleep(0.01)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_simulation_stops_on_its_ramps(number, tmp_path):
    recording = tmp_path / "run.mcap"
    job = command("simulate", MILL, "--program", BRACKET, "--duration", 1e6, "--record", recording)
    with subprocess.Popen(job, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as running:
        wait_for_size(recording, 200_000)
        running.send_signal(number)
        output, _ = running.communicate(timeout=60)
    assert running.returncode == 1
    assert f"failed: P-ERR-26106 the run was interrupted ({number.name}); everything stops on its ramps" in output
    assert "Traceback" not in output and "stop without effect" not in output
    recorded = read_recording(recording)
    assert recorded.complete and verify(recorded, replay_blocks).equal
    for axis in ("x", "y", "z"):
        assert recorded.states[f"/{axis}/state"]["set_velocity"][-1] == 0.0
    assert recorded.states["/s/state"]["set_speed_rpm"][-1] == 0.0


def test_end_request():
    before = signal.getsignal(signal.SIGTERM)
    with EndRequest() as end:
        assert not end.given and not end.repeated
        os.kill(os.getpid(), signal.SIGTERM)
        assert end.given and not end.repeated and not end.over(60.0)
        assert end.text("all stops") == "P-ERR-26106 the run was interrupted (SIGTERM); all stops"
        os.kill(os.getpid(), signal.SIGINT)
        assert end.repeated and end.over(60.0)
    assert signal.getsignal(signal.SIGTERM) is before
    with EndRequest() as end:
        assert end.over(-1.0), "patience is at its end"


@pytest.mark.long
def test_recording_that_grows_too_large_ends_and_the_run_continues(tmp_path):
    recording = tmp_path / "run.mcap"
    done = subprocess.run(
        command("simulate", MILL, "--program", BRACKET, "--record", recording),
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, 400_000)),
    )
    assert done.returncode == 1
    assert f"P-ERR-26007 recording {recording}: cannot be written at offset " in done.stderr
    assert "File too large; recording ends here, the chunks before it stay readable" in done.stderr
    assert "program time" in done.stdout and "Traceback" not in done.stderr
    recorded = read_recording(recording)
    assert int(done.stdout.partition("(")[2].partition(" cycles")[0]) > recorded.last_cycle + 1000
    assert not recorded.complete and recorded.last_cycle > 500 and verify(recorded, replay_blocks).equal


@pytest.mark.parametrize("name", ["simulate", "run"])
def test_a_recording_does_not_overwrite_what_the_run_is_made_of(name, tmp_path):
    program, scenario, machine = tmp_path / "p.nc", tmp_path / "s.yaml", tmp_path / "m.yaml"
    program.write_text("%p\nM30\n")
    scenario.write_text("[]")
    machine.write_text(MILL.read_text())
    job = [name, machine, "--program", program, "--scenario", scenario]
    for what, path in (("machine file", machine), ("NC program", program), ("scenario", scenario)):
        before = path.read_bytes()
        result = call(*job, "--record", path)
        assert result.exit_code == 2
        assert result.stderr == (
            f"P-ERR-26117 recording {path} would overwrite the {what} {path}; nothing was started\n"
        )
        assert path.read_bytes() == before


def test_a_recording_takes_the_place_of_no_other_file(tmp_path):
    own, other = tmp_path / "own.mcap", tmp_path / "other.nc"
    other.write_text("G01 X1\n")
    job = [MILL, "--duration", "0.1", "--record"]
    assert call("simulate", *job, own).exit_code == 0
    text = f"P-ERR-26117 recording {other} would overwrite a file that is no recording; nothing was "
    for words, effect in (
        (["simulate", *job, other], "started"),
        (["run", *job, other], "started"),
        (["replay", own, "--override", "50", "-o", other], "started"),
        (["recover", own, "-o", other], "written"),
    ):
        result = call(*words)
        assert (result.exit_code, result.stderr) == (2, f"{text}{effect}\n")
        assert other.read_text() == "G01 X1\n"
    empty = tmp_path / "empty"
    empty.touch()
    for file in (own, empty):
        assert call("simulate", *job, file).exit_code == 0


@pytest.mark.parametrize("name", ["simulate", "run"])
def test_a_recording_does_not_overwrite_files_that_the_machine_file_names(name, tmp_path):
    machine = tmp_path / "m.yaml"
    files = {"werkz_data": "t.yaml", "nullp_data": "o.yaml", "pzv_data": "c.yaml"}
    named = ", ".join(f"{key}: {file}" for key, file in files.items())
    nodes = "/machine: {ros__parameters: {channels: [ch], axes: [x]}}"
    machine.write_text(f"{nodes}\n/ch: {{ros__parameters: {{{named}}}}}\n")
    for file in files.values():
        path = tmp_path / file
        path.write_text("1: {}\n")
        result = call(name, machine, "--duration", "0", "--record", path)
        text = f"recording {path} would overwrite the file {path} of the machine file {machine}"
        assert (result.exit_code, result.stderr) == (2, f"P-ERR-26117 {text}; nothing was started\n")
        assert path.read_text() == "1: {}\n"


def test_a_run_without_cycles(tmp_path):
    result = call("simulate", MILL, "--duration", "0", "--record", tmp_path / "a.mcap")
    assert result.exit_code == 0 and "machine time 0.000 s (0 cycles)" in result.stdout
    result = call("replay", tmp_path / "a.mcap")
    assert result.exit_code == 1
    assert result.stderr == f"{tmp_path}/a.mcap: holds no per-cycle states, nothing could be compared\n"


def test_a_terminal_sees_block_position_and_feed():
    terminal, other_end = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "160"}
    job = command("simulate", MILL, "--program", BRACKET)
    running = subprocess.Popen(job, stdout=subprocess.DEVNULL, stderr=other_end, env=environment)
    os.close(other_end)
    shown = b""
    while True:
        try:
            part = os.read(terminal, 65536)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        shown += part
    os.close(terminal)
    assert running.wait(60) == 0
    text = shown.decode()
    assert "block " in text and "/" in text and " line " in text
    assert " X" in text and " Y" in text and " Z" in text and " F" in text


@pytest.mark.parametrize(
    "words",
    [
        ["recover", "{name}", "-o", "r.mcap"],
        ["verify", "--motion", "{name}"],
        ["lists", "import", "m.yaml", "-o", "{name}"],
    ],
    ids=lambda words: words[0],
)
def test_a_file_name_that_is_too_long(words, tmp_path, monkeypatch):
    """bench.fuzz command-line seed 420 numbers 383, 3690, 3836."""
    monkeypatch.chdir(tmp_path)
    name = "1" * 5000
    result = call(*(word.format(name=name) for word in words))
    assert (result.exit_code, result.output) == (
        2,
        f"P-ERR-26209 '{name[:40]}...' has {len(name)} characters: File name too long; nothing was done\n",
    )


@pytest.mark.parametrize("words", [["plot", "."], ["plot", "/"], ["replay", ".", "--from", "1"], ["replay", "."]])
def test_a_folder_without_a_name_is_no_recording(words, tmp_path, monkeypatch):
    """bench.fuzz command-line seed 420 numbers 740 and 4265."""
    monkeypatch.chdir(tmp_path)
    result = call(*words)
    assert result.exit_code == 2 and result.output.startswith("P-ERR-26014 "), result.output


def test_a_folder_without_a_name_is_no_program(tmp_path, monkeypatch):
    """bench.fuzz command-line seed 420 number 6377."""
    monkeypatch.chdir(tmp_path)
    result = call("plot", ".", "--machine", MILL)
    assert result.exit_code == 2 and result.output.startswith("P-ERR-26110 "), result.output


def test_standard_output_on_a_full_disk_is_no_traceback(tmp_path):
    recording, program = tmp_path / "run.mcap", tmp_path / "line.nc"
    program.write_text("G01 X10 F3000\nM30\n")
    job = command("simulate", MILL, "--program", program, "--record", recording)
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(job, stdout=full, stderr=subprocess.PIPE, text=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (
        1,
        "P-ERR-26208 standard output cannot be written: No space left on device; what the command has printed is "
        "incomplete\n",
    )
    assert call("verify", recording).exit_code == 0
