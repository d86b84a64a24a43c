"""`make setup` shows how many files are compiled, and has the status of what compiles."""

import os
import pty
import re
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "tools" / "build_progress.py"
COMPILER = (
    "import time; [(open(f'{n}.o', 'w').close(), time.sleep(1.0)) for n in range(3)]; print('finished'); exit(%d)"
)


@pytest.mark.parametrize("status", [0, 3])
def test_a_pipe_gets_what_the_command_prints(tmp_path, status):
    done = subprocess.run(
        [sys.executable, SCRIPT, tmp_path, sys.executable, "-c", COMPILER % status],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (status, "finished\n", "")


def test_a_terminal_shows_the_files_of_this_build(tmp_path):
    for number in range(5):
        (tmp_path / f"old{number}.o").touch()
        os.utime(tmp_path / f"old{number}.o", (0, 0))
    own, other = pty.openpty()
    warns = "import sys; print('a warning', file=sys.stderr); "
    command = [sys.executable, SCRIPT, tmp_path, sys.executable, "-c", warns + COMPILER % 0]
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "80"}
    with subprocess.Popen(command, cwd=tmp_path, stderr=other, env=environment, stdout=subprocess.DEVNULL) as building:
        os.close(other)
        seen = output_of(own)
    assert building.returncode == 0
    assert {int(number) for number in re.findall(r"(\d+) files compiled", seen)} <= {0, 1, 2, 3}
    assert "3 files compiled" in seen and re.search(r"(^|\r|\n|K)a warning\r\n", seen)


def test_ctrl_c_ends_the_command_first(tmp_path):
    compiler = "import time\ntry: time.sleep(60)\nexcept KeyboardInterrupt: time.sleep(1); open('swept', 'w')\nexit(9)"
    own, other = pty.openpty()
    command = [sys.executable, SCRIPT, tmp_path, sys.executable, "-c", compiler]
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "80"}
    with subprocess.Popen(command, cwd=tmp_path, stderr=other, env=environment, process_group=0) as building:
        os.close(other)
        time.sleep(2.0)
        os.killpg(building.pid, signal.SIGINT)
        seen = output_of(own)
    assert building.returncode == 9 and (tmp_path / "swept").exists()
    assert "Traceback" not in seen


def output_of(terminal):
    """Until its end."""
    seen = b""
    with suppress(OSError):
        while part := os.read(terminal, 4000):
            seen += part
    os.close(terminal)
    return seen.decode()
