"""`python -m bench.paths [COUNT] [SEED] [KIND]`: random programs against the independent checker of test/support.

KIND is run (default), override, hold, ramp, reset or "single block"; the last five disturb the runs at random moments.
Prints the seeds that fail and what was found, then the numbers.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "test" / "support"))

from path_moments import MOMENTS, disturbed
from random_paths import RandomProgram

from bench.figures import Effort, Figure, ShowProgress

PROGRAMS = 1000
DISTURBED = 20


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Programs of which any sample breaks a limit, leaves the path or misses a corner or an end."""
    for kind, full, what in (
        ("run", PROGRAMS, "random programs"),
        ("override", DISTURBED, f"programs with {MOMENTS} overrides to 0 and back each"),
    ):
        count = effort.scaled(full)
        show(f"{count} {what}")
        failed = sum(1 for _ in failures(count, 0, kind, tell=show))
        yield Figure(f"{count} {what}: failed", failed, "", goal=0.0, at_most=True)


def texts_of(seed: int, kind: str) -> list[str]:
    if kind == "run":
        return RandomProgram(seed).check().texts
    return disturbed(seed, kind).texts


def failures(count: int, seed: int, kind: str, *, tell: Callable[[str], None]) -> Iterator[tuple[int, list[str]]]:
    """Seeds with what was found, exceptions too."""
    for number in range(seed, seed + count):
        try:
            found = texts_of(number, kind)
        except Exception as error:
            found = [repr(error)]
        if number % 50 == 49:
            tell(f"up to seed {number}")
        if found:
            yield number, found


def main(count: int = 1000, seed: int = 0, kind: str = "run") -> None:
    begin, failed = time.monotonic(), 0
    for number, found in failures(count, seed, kind, tell=print):
        failed += 1
        print(f"seed {number}: {'; '.join(found)}", flush=True)
    seconds = time.monotonic() - begin
    print(f"{count} programs ({kind}) from seed {seed}, {failed} failed, {seconds:.0f} s")


if __name__ == "__main__":
    main(*[int(word) for word in sys.argv[1:3]], *sys.argv[3:4])
