"""`python -m bench.fuzz [KIND]... [--count N] [--seed S] [--minutes M]`: mutated inputs of every kind.

None but documented refusals may come, none may hang, write outside of its folder or let memory grow.
"""

from __future__ import annotations

import faulthandler
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import click

from bench.fuzzing.engine import Verdict, run
from bench.fuzzing.kinds import KINDS

HEAD = (
    f"{'kind':<15} {'seed':>6} {'count':>10} {'refused':>10} {'undocumented':>12} {'slowest, s':>10} {'number':>8} "
    f"{'growth, KiB':>11} {'s':>6}"
)


def row(verdict: Verdict) -> str:
    counts = f"{verdict.count:>10,} {verdict.refused:>10,} {verdict.undocumented:>12}"
    slowest = f"{verdict.slowest:>10.2f} {verdict.slowest_number:>8}"
    return f"{verdict.kind:<15} {verdict.seed:>6} {counts} {slowest} {verdict.growth:>11,} {verdict.seconds:>6.0f}"


@click.command()
@click.argument("kinds", nargs=-1, type=click.Choice([*KINDS]), metavar="[KIND]...")
@click.option("--count", type=click.IntRange(1), default=1000, show_default=True, help="Inputs of each kind.")
@click.option("--seed", type=int, default=1, show_default=True, help="Of all random numbers.")
@click.option("--first", type=click.IntRange(0), default=0, help="Number of the first input, as a finding names it.")
@click.option("--minutes", type=float, default=0.0, help="End each kind after so many minutes, whatever --count says.")
def main(kinds: Sequence[str], count: int, seed: int, first: int, minutes: float) -> None:
    """Tries mutated inputs of each KIND, all without one. Status 1 where one was not taken as documented."""
    print(HEAD, flush=True)
    failed = False
    for name in kinds or KINDS:
        with tempfile.TemporaryDirectory(prefix="fuzz_") as folder:
            verdict = run(KINDS[name], seed, count, Path(folder), first=first, seconds=minutes * 60.0)
        print(row(verdict), flush=True)
        for finding in verdict.findings:
            print(finding, file=sys.stderr, flush=True)
        failed = failed or bool(verdict.findings)
    sys.exit(int(failed))


if __name__ == "__main__":
    faulthandler.enable()
    sys.dont_write_bytecode = True
    main()
