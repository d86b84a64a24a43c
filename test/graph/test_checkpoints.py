"""A graph keeps no checkpoints: computed once, they lie beside its recording, and a replay begins at them."""

from __future__ import annotations

import pytest
from click.testing import CliRunner, Result
from graph_support import MILL, run
from long_support import long

from cnc_ptp import cli

PROGRAM = "G01 X50 Y20 F2400\nM8\nX0\nX50 Y0\nX0\nM30\n"


def call(*arguments: object) -> Result:
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


@pytest.mark.parametrize("options", [["--free-run"], *long([["--composed"]])], ids=str)
def test_a_replay_of_a_graph_begins_at_a_checkpoint(options, tmp_path):
    (tmp_path / "lines.nc").write_text(PROGRAM)
    path = tmp_path / "graph.mcap"
    run("run", MILL, "--program", tmp_path / "lines.nc", "--record", path, *options)
    result = call("replay", path, "--from", 3.2)
    assert "computed from 0 s: the recording has no checkpoints; cnc_ptp replay --checkpoints makes them, once" in (
        result.output
    )
    assert "both runs are equal to the bit" in result.output
    result = call("replay", path, "--verify", "--checkpoints", 1)
    assert "are equal to the bit" in result.output
    assert result.output.endswith(f"{path}.checkpoints: 5 checkpoints, 1 s from one to the next\n")
    result = call("replay", path, "--from", 3.2)
    assert "note: computed from the checkpoint at 3 s" in result.output
    assert "both runs are equal to the bit" in result.output
