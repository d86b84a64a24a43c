"""`python -m bench.paths [COUNT] [SEED] [KIND]`: random programs against the independent checker of test/support.

KIND is run (default), override, hold, ramp, reset or "single block"; the last five disturb the runs at random moments.
Prints the seeds that fail and what was found, then the numbers.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "test" / "support"))

from path_moments import disturbed
from random_paths import RandomProgram


def texts_of(seed: int, kind: str) -> list[str]:
    if kind == "run":
        return RandomProgram(seed).check().texts
    return disturbed(seed, kind).texts


def failures(count: int, seed: int, kind: str) -> Iterator[tuple[int, list[str]]]:
    """Seeds with what was found, exceptions too."""
    for number in range(seed, seed + count):
        try:
            found = texts_of(number, kind)
        except Exception as error:
            found = [repr(error)]
        if number % 50 == 49:
            print(f"up to seed {number}", flush=True)
        if found:
            yield number, found


def main(count: int = 1000, seed: int = 0, kind: str = "run") -> None:
    begin, failed = time.monotonic(), 0
    for number, found in failures(count, seed, kind):
        failed += 1
        print(f"seed {number}: {'; '.join(found)}", flush=True)
    seconds = time.monotonic() - begin
    print(f"{count} programs ({kind}) from seed {seed}, {failed} failed, {seconds:.0f} s")


if __name__ == "__main__":
    main(*[int(word) for word in sys.argv[1:3]], *sys.argv[3:4])
