"""The vocabulary of a channel: of its machine file, of a load, of manual blocks; in a replay."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner
from machine_support import MILL, MachineBench, UnitBench
from replay_support import replay, text_of

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.cli import main
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_unit, build_units
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.parameters import MachineParameters, load_machine

ROOT = Path(__file__).parents[2]
PLATE = ROOT / "examples" / "plate.ngc"
INCH = "G20 G0 X1.\nM30"


def iso_mill() -> MachineParameters:
    return replace(MILL, channels={name: replace(each, dialect="iso") for name, each in MILL.channels.items()})


def bench(machine: MachineParameters = MILL) -> UnitBench:
    return UnitBench(build_unit(machine, "channel"))


def test_a_machine_file_names_the_vocabulary() -> None:
    text = (
        (ROOT / "config" / "mill.yaml")
        .read_text()
        .replace("    m_synch:", "    interpreter: {dialect: iso}\n    m_synch:")
    )
    assert load_machine(text, "mill.yaml").channels["channel"].dialect == "iso"
    assert MILL.channels["channel"].dialect == "twincat"


def test_an_unknown_vocabulary_is_refused() -> None:
    text = (
        (ROOT / "config" / "mill.yaml")
        .read_text()
        .replace("    m_synch:", "    interpreter: {dialect: din}\n    m_synch:")
    )
    with pytest.raises(Exception, match=r"P-CHAN-90010.*din"):
        load_machine(text, "mill.yaml")


def test_a_load_may_name_another_one() -> None:
    channel = bench()
    assert channel.refused("load", program="a.nc", text="G59.1\nM30").startswith("P-ERR-20131 a.nc line 1 column 1")
    channel.accepted("load", program="a.nc", text="G59.1\nM30", dialect="iso")
    channel = bench(iso_mill())
    channel.accepted("load", program="a.nc", text="G59.1\nM30")
    assert channel.refused("load", program="a.nc", text="G59.1\nM30", dialect="twincat").startswith("P-ERR-20131")
    assert channel.refused("load", program="a.nc", text="M30", dialect="din").startswith("P-ERR-")


def test_manual_blocks_are_read_as_the_last_load_was() -> None:
    channel = bench()
    channel.accepted("load", program="a.nc", text=INCH, dialect="iso")
    channel.accepted("mdi", text="G20")
    channel.run(100)
    channel.accepted("mdi", text="G59.1 G98 F100")
    channel.run(100)
    assert channel.refused("mdi", text="L X").startswith("P-ERR-21820")
    channel.accepted("load", program="a.nc", text="M30")
    channel.accepted("mdi", text="G01 F100")


def test_what_was_prepared_counts_for_its_vocabulary_only() -> None:
    unit = build_unit(MILL, "channel")
    unit.prepare("a.nc", "G20\nM30", dialect="iso")
    channel = UnitBench(unit)
    channel.accepted("load", program="a.nc", text="G20\nM30")
    assert unit._programs.loaded.vocabulary.name == "twincat"
    channel.accepted("load", program="a.nc", text="G20\nM30", dialect="iso")
    assert unit._programs.loaded.vocabulary is ISO


def test_a_run_with_a_dialect_is_the_same_in_a_replay() -> None:
    entries = read_entries(MILL, program=str(PLATE), scenario=None, dialect="iso")
    assert entries[0].command.arguments["dialect"] == "iso"
    offline = OfflineMachine(MILL, build_units(MILL, scenario=entries))
    blocks: list[dict[str, str]] = []
    records = []
    for _ in range(150):
        outputs = offline.tick()
        blocks.append({name: text_of(output.block) for name, output in outputs.items()})
        records += [record for output in outputs.values() for record in output.records]
    again = replay(MILL, records, len(blocks))
    for name in blocks[0].keys() - {"plc"}:
        assert again[name] == [block[name] for block in blocks]
    assert any(record.command == "load" and '"iso"' in record.arguments_json for record in records)


def test_a_free_m_function_must_be_in_the_machine_file() -> None:
    check = ProgramCheck.of_first_channel(MILL, "a.nc")
    errors = check.errors("T1 M6\nM8\nM66\nM30", "a.nc", vocabulary=ISO)
    assert [str(error).split(": ", 1)[1] for error in errors] == [
        "M66 does not exist on this machine (P-CHAN-00041). Known: M0, M1, M2, M3, M4, M5, M6, M7, M8, M9, M17, M19, M29, M30"
    ]


def test_soft_limits_hold_for_every_motion_of_a_cycle() -> None:
    check = ProgramCheck.of_first_channel(MILL, "a.nc")
    program = parse_program("G0 Z0\nG81 X1 Z-5000 R0 F100\nM30", "a.nc", vocabulary=ISO)
    with pytest.raises(
        Exception, match=r"P-ERR-120003 a.nc line 2 .* axis Z: -5000 mm lies beyond the negative soft limit"
    ):
        check.blocks(program, check.start)


def call(*words: str) -> tuple[int, str]:
    result = CliRunner().invoke(main, list(words))
    return result.exit_code, result.output


def test_the_commands(tmp_path: Path) -> None:
    assert call("check", str(PLATE))[0] == 2
    status, text = call("check", str(PLATE), "--dialect", "iso", "--machine", str(ROOT / "config" / "mill.yaml"))
    assert status == 0
    assert "plate.ngc: no errors in 48 lines" in text
    status, text = call("check", str(PLATE), "--dialect", "iso", "--canonical")
    assert status == 0 and "rapid (10, 10, 20)" in text
    assert call("format", str(PLATE), "--dialect", "iso")[0] == 0
    assert call("format", str(PLATE))[0] == 2
    assert "iso" in call("explain", "--dialect", "din", "G1")[1]
    small = tmp_path / "a.ngc"
    small.write_text("(G64 in a comment)\nG21 G0 X1\nM30\n")
    assert "exact stop" not in call("check", str(small), "--dialect", "iso")[1]
    assert call("simulate", str(ROOT / "config" / "mill.yaml"), "--program", str(small), "--dialect", "iso")[0] == 0


def test_g28_reads_the_reference_point_of_the_axis_list() -> None:
    """P-AXIS-00152."""
    axes = dict(MILL.axes)
    axes["x"] = replace(axes["x"], homing=replace(axes["x"].homing, reference_position=12.5))
    bench = MachineBench(machine=replace(MILL, axes=axes), end_when_idle=False).run(0.1)
    assert bench.give("channel", "load", program="a.nc", text="G0 X5 Y5\nG28 X6 Y6\nM30", dialect="iso").accepted
    assert bench.give("channel", "start").accepted
    bench.run(3.0)
    assert (bench.position("x"), bench.position("y")) == (12.5, 0.0)


def test_the_mill_with_the_shipped_tools_takes_their_lengths(tmp_path: Path) -> None:
    """As docs/program.md says: `werkz_data` in place of `wz`. Without it, G43 says what is missing."""
    text = (ROOT / "config" / "mill.yaml").read_text()
    begin, end = text.index("    wz:"), text.index("    m_synch:")
    machine, program = tmp_path / "mill.yaml", tmp_path / "a.ngc"
    machine.write_text(f"{text[:begin]}    werkz_data: tools/mill.yaml\n{text[end:]}")
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools" / "mill.yaml").write_text((ROOT / "config" / "tools" / "mill.yaml").read_text())
    program.write_text("G21 G90 G54 G49\nT2 M6\nG43 H2 Z50.\nM30\n")
    status, shown = call("check", str(program), "--machine", str(machine), "--dialect", "iso", "--canonical")
    assert (status, "rapid (0, 0, 90)" in shown) == (0, True)
    shipped = str(ROOT / "config" / "mill.yaml")
    status, shown = call("check", str(program), "--machine", shipped, "--dialect", "iso")
    reason = "no tool of the machine has a length; they are in a tool file (werkz_data) or in wz[2].laenge"
    assert (status, f"column 5 'G43 H2 Z50.': G43 H2: {reason}" in shown) == (2, True)
