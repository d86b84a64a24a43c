"""Every example and every figure runs offline without a violation of the motion invariants."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest
from machine_support import ROOT
from state_support import Run

from bench.random_commands import inputs_of
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.plc_file import read_plc
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.unit import Unit
from cnc_ptp.recording.motion_check.check import check_motion
from figures.scenario_head import read_head

SPINDLES, EXAMPLES = "examples/spindles", "examples"
RUNS = [
    Run("config/mill.yaml", "examples/bracket.nc"),
    Run("config/mill.yaml", "examples/bracket.nc", "examples/bracket_overrides.yaml"),
    Run("config/mill.yaml", "examples/pocket.nc"),
    Run("config/mill.yaml", "examples/cover.nc"),
    Run("config/mill.yaml", "examples/tuning.nc"),
    Run("config/mill.yaml", "examples/tapping.nc"),
    Run("config/mill.yaml", "examples/plate.ngc", dialect="iso"),
    Run(
        "config/mill.yaml",
        "examples/plc_tool_changer.nc",
        "examples/plc_tool_changer.yaml",
        plc="examples/plc_tool_changer.py",
    ),
    Run("config/lathe.yaml", "examples/lathe.nc"),
    Run("config/lathe.yaml", "examples/caxis.nc"),
    Run("config/lathe.yaml", "examples/thread.nc"),
    Run("config/lathe.yaml", "examples/turning.nc"),
    Run("config/lathe.yaml", "examples/turned_part.nc"),
    *(
        Run("config/lathe.yaml", f"examples/threads/{name}.nc")
        for name in ("longitudinal", "two_starts", "taper", "chain")
    ),
    Run("config/ptp.yaml", scenario="examples/trajectory.yaml"),
    *(
        Run("config/ptp.yaml", plc=f"examples/{name}.py")
        for name in ("plc_move_axis", "plc_setpoint_generator", "plc_homing")
    ),
    Run("examples/homing.yaml", "examples/homing.nc"),
    Run("examples/homing.yaml", scenario="examples/homing_by_plc.yaml"),
    Run("examples/probe.yaml", "examples/probe.nc"),
    Run("examples/sercos.yaml", scenario="examples/sercos_homing.yaml"),
    Run("examples/sercos.yaml", plc="examples/plc_sercos_homing.py"),
    *(
        Run(f"{SPINDLES}/{machine}.yaml", f"{SPINDLES}/{program}.nc", f"{SPINDLES}/{scenario}.yaml" if scenario else "")
        for machine, program, scenario in (
            ("nc_spindle", "din", ""),
            ("plc_spindle", "din", "plc"),
            ("three_spindles", "three_spindles", ""),
            ("two_channels", "channel1", "two_channels_start"),
            ("gears", "gears", "gears_plc"),
            ("gears_programmed", "gears_programmed", ""),
            ("tools", "tools", ""),
            ("sensorless", "open_loop", ""),
            ("synchronous", "override", "override"),
            ("synchronous", "synchronous", ""),
            ("synchronisation", "synchronised", ""),
            ("synchronisation", "not_synchronised", ""),
            ("curves", "curves", ""),
        )
    ),
]
FIGURES = sorted((ROOT / "examples" / "figures").glob("*.yaml"))


def of_figure(path: Any) -> Run:
    """The run of a figure as its head says."""
    head = read_head(path)
    program, plc = (str(file.relative_to(ROOT)) if file else "" for file in (head.program_path, head.plc_path))
    return Run(head.machine, program, str(path.relative_to(ROOT)), plc=plc)


def units_of(run: Run, machine: MachineParameters) -> Mapping[str, Unit]:
    """The scenario of a figure may be its head alone."""
    program, scenario = (str(ROOT / name) if name else None for name in (run.program, run.scenario))
    entries = read_entries(machine, program=program, scenario=scenario, dialect=run.dialect, may_be_empty=True)
    return build_units(machine, scenario=entries, plc_file=read_plc(str(ROOT / run.plc)) if run.plc else None)


@pytest.mark.long
@pytest.mark.parametrize("run", [*RUNS, *map(of_figure, FIGURES)], ids=lambda run: run.name)
def test_an_example_has_no_violation(run: Run) -> None:
    machine = run.parameters()
    blocks: dict[str, list[Any]] = {}
    records = []
    for outputs in OfflineMachine(machine, units_of(run, machine)).run():
        for name, output in outputs.items():
            blocks.setdefault(name, []).append(output.block)
            records += output.records
    result = check_motion(inputs_of(machine, blocks, records))
    assert result.violations == []
    assert result.cycles > 100
