"""`python -m bench.peak_memory MACHINE PROGRAM SECONDS RECORDING`: an offline run; prints its largest resident size."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from bench.offline import run_offline


def peak_mb() -> float:
    """Largest resident size of this process so far, MB."""
    found = re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())
    return int(found[1]) / 1000.0 if found else 0.0


if __name__ == "__main__":
    machine, program, seconds, recording = sys.argv[1:]
    run_offline(machine, program=program, seconds=float(seconds), record=recording)
    print(peak_mb())
