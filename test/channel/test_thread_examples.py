"""The programs of examples/threads and examples/thread.nc run on config/lathe.yaml without a warning."""

from __future__ import annotations

from pathlib import Path

import pytest
from example_support import ExampleRun
from long_support import long
from machine_support import ROOT
from thread_support import Pass, apart, assert_within_limits, texts

EXAMPLES = sorted((ROOT / "examples" / "threads").glob("*.nc"))


def run(path: Path) -> ExampleRun:
    """As `cnc_ptp simulate config/lathe.yaml --program` runs it."""
    return ExampleRun(str(ROOT / "config" / "lathe.yaml"), str(path))


@pytest.mark.parametrize(
    "path", [*EXAMPLES[2:], *long([*EXAMPLES[:2], ROOT / "examples" / "thread.nc"])], ids=lambda path: path.stem
)
def test_it_runs_without_a_warning(path):
    bench = run(path)
    assert_within_limits(bench)
    assert {text.split()[0] for text in texts(bench)} == {"22085"}
    assert bench.events == []
    assert bench.blocks["channel"][-1].blocks_done == bench.blocks["channel"][-1].blocks_total


def test_the_two_starts_of_the_manual():
    bench = run(ROOT / "examples" / "threads" / "two_starts.nc")
    first, second = (Pass(bench, line, 3.0).phase(2.0, 54.0) for line in (7, 11))
    assert apart(180.0, apart(first, second)) == pytest.approx(0.0, abs=0.002)
