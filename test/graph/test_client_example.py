"""The example of the client that has a graph says there what it says offline."""

from __future__ import annotations

import re
import subprocess
import sys

from graph_support import ROOT


def test_a_tool_changer_in_the_graph(ros_domain):
    lines = {}
    for where in ((), ("graph",)):
        command = [sys.executable, "examples/client_handshake.py", *where]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=240, check=False)
        assert done.returncode == 0, done.stderr
        lines[where] = [re.sub(r"^ *[0-9.]+ s  ", "", line) for line in done.stdout.splitlines()]
    assert lines[("graph",)] == lines[()] and len(lines[()]) == 3
