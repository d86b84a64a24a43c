"""Mutated programs raise nothing but ProgramError. `python -m bench.fuzz 10000000` tries ten million bytes."""

import pytest

from bench import fuzz


@pytest.mark.parametrize("seed", range(4))
def test_mutated_programs_raise_nothing_but_program_errors(seed):
    *_, done = fuzz.run(100_000, seed)
    assert done >= 100_000
