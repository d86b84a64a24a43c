"""`make setup` shows how many files are compiled, and has the status of what compiles."""

import os
import pty
import subprocess
import sys
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
    (tmp_path / "old.o").touch()
    os.utime(tmp_path / "old.o", (0, 0))
    own, other = pty.openpty()
    command = [sys.executable, SCRIPT, tmp_path, sys.executable, "-c", COMPILER % 0]
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "80"}
    with subprocess.Popen(command, cwd=tmp_path, stderr=other, env=environment, stdout=subprocess.DEVNULL) as building:
        os.close(other)
        seen = b""
        while b"3 files compiled" not in seen:
            seen += os.read(own, 4000)
        os.set_blocking(own, False)
    os.close(own)
    assert building.returncode == 0
    assert b"2 files compiled" in seen and b"4 files compiled" not in seen
