"""`python -m bench.big_program BLOCKS`: a program file of many blocks, read and interpreted line by line.

Prints the largest resident size in MiB beyond that of the idle process, and the time per block in µs.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_text
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program_text import ProgramFile

KIB = 1024.0


def write_program(path: Path, blocks: int) -> None:
    with path.open("w", encoding="ascii") as stream:
        for n in range(blocks):
            stream.write(f"N{n + 1} G1 X{n % 997 / 10} Y{n % 499 / 10} Z{n % 7} F1000\n")
        stream.write("M30\n")


def largest() -> float:
    """Of this program alone: getrusage counts the process that has started it, too."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return float(status.split("VmHWM:")[1].split()[0]) / KIB


def main(blocks: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "big.nc"
        write_program(path, blocks)
        begin = time.perf_counter()
        with path.open("rb") as stream:
            program, errors = parse_text(ProgramFile(stream), path.name)
            assert not errors
            count = sum(1 for _ in interpret(program, (0.5, 0.0, 0.0), plain_channel("XYZ")))
        assert count == blocks + 1
        print(largest(), 1e6 * (time.perf_counter() - begin) / blocks)


if __name__ == "__main__":
    main(int(sys.argv[1]))
