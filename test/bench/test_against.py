"""The comparison with another commit: its ratios, and a command that fails."""

import sys
from pathlib import Path

import click
import pytest

from bench import against
from bench.against import Run, call, compared, offline, paced, rate


def test_ratios_of_medians():
    figure = compared("memory", [100.0, 300.0, 110.0], [220.0, 10.0, 230.0], 2.0, unit="MB")
    assert figure.name == "memory (110 and 220 MB)" and figure.value == 2.0 and figure.met


def test_less_processor_time_is_faster():
    [figure] = offline([Run(cpu=6.0)], [Run(cpu=1.0)])
    assert figure.value == pytest.approx(6.0) and figure.met


def test_figures_of_a_real_time_run():
    before = Run(cores=1.5, startup=9.0, pss_mb=800.0, output="block lateness p50 3.0 ms, p99 20.0 ms, largest 30.0 ms")
    after = Run(cores=0.5, startup=3.0, pss_mb=500.0, output="block lateness p50 3.0 ms, p99 4.5 ms, largest 9.0 ms")
    cores, block, late, startup, memory = paced([before], [after])
    assert (cores.value, block.value, late.value, startup.value, memory.value) == (3.0, 5.0, 4.5, 3.0, 1.6)
    assert [figure.met for figure in (cores, block, late, startup, memory)] == [True, True, True, True, False]


def test_the_end_of_a_run_is_no_machine_time():
    [figure] = rate("free run", 10.0, 5.0, [Run(wall=10.5)], [Run(wall=2.5)])
    assert figure.name == "free run (1000 and 5000 cycles/s)" and figure.value == 5.0


def test_a_command_that_fails_is_no_measurement(tmp_path, monkeypatch):
    program = tmp_path / ".venv" / "bin" / "cnc_ptp"
    program.parent.mkdir(parents=True)
    program.write_text(f"#!{sys.executable}\nprint('no such machine'); raise SystemExit(2)\n")
    program.chmod(0o755)
    with pytest.raises(click.ClickException) as failed:
        call(Path(tmp_path), "run", "m.yaml", record=tmp_path / "r.mcap")
    assert failed.value.message == f"{tmp_path}: cnc_ptp run m.yaml ended with 2:\nno such machine\n"
    assert against.BASELINE == "147e025"
