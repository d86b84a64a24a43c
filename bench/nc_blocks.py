"""NC blocks a second: 100,000 `G1 X Y Z F` lines parsed and modally resolved; prints one line, the best of n passes."""

import random
import sys
import time

from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_program

BLOCKS = 100_000


def program_text(blocks: int = BLOCKS) -> str:
    """A program of random straight moves, three axes and a feed in every block."""
    draw = random.Random(1)
    lines = []
    for n in range(1, blocks + 1):
        x, y, z = (draw.uniform(-99, 99) for _ in range(3))
        lines.append(f"N{10 * n} G1 X{x:.3f} Y{y:.3f} Z{z:.3f} F{draw.randint(100, 9000)}")
    return "\n".join([*lines, "M30"])


def measure(text: str) -> tuple[float, float]:
    """Seconds for parsing and for interpreting the text."""
    begin = time.perf_counter()
    program = parse_program(text, "bench.nc")
    parsed = time.perf_counter()
    count = sum(1 for _ in interpret(program, (0.0, 0.0, 0.0), ("X", "Y", "Z")))
    end = time.perf_counter()
    assert count == BLOCKS + 1
    return parsed - begin, end - parsed


def main() -> None:
    """Measures and prints."""
    passes = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    text = program_text()
    parse, resolve = min((measure(text) for _ in range(passes)), key=sum)
    rate, parse_us, modal_us = BLOCKS / (parse + resolve), 1e6 * parse / BLOCKS, 1e6 * resolve / BLOCKS
    print(f"nc blocks: {rate:,.0f} a second ({parse_us:.2f} us parse, {modal_us:.2f} us modal)")


if __name__ == "__main__":
    main()
