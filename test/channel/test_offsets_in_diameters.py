"""P-CHAN-00091: zero offsets and G92 of the facing axis are diameters; where the axes go, and what programs read."""

from __future__ import annotations

from dataclasses import replace

import pytest
from machine_support import ROOT, MachineBench, machine

from cnc_ptp.parameters import MachineParameters, OffsetTables, load_machine, machine_text, read_machine

PATH = ROOT / "config" / "lathe.yaml"
LATHE = read_machine(PATH)
TABLES = OffsetTables(zero={1: (40.0, 30.0, 0.0)})


def lathe(on: bool) -> MachineParameters:
    return machine(LATHE, channel={"offsets_in_diameters": on, "offsets": TABLES})


def place(program: str, *, on: bool = True) -> tuple[float, float]:
    bench = MachineBench(f"%P\nG18 G90\n{program}\nM30\n", machine=lathe(on)).run()
    assert bench.errors() == []
    return bench.position("x"), bench.position("z")


@pytest.mark.parametrize("code", ["G51", "G52"])
@pytest.mark.parametrize(
    ("program", "radius", "diameter"),
    [
        ("G54 {} G00 X0 Z5", (40.0, 35.0), (20.0, 35.0)),
        ("G92 X40 Z3 {} G00 X0 Z5", (40.0, 8.0), (20.0, 8.0)),
        ("G92 X40\nG91 G92 X10\nG90 {} G00 X0 Z5", (50.0, 5.0), (25.0, 5.0)),
        ("G54\nG92 X10\n{} G00 X0 Z5", (50.0, 35.0), (25.0, 35.0)),
        ("V.G.NP[2].V.X = 50\nG55 {} G00 X0 Z5", (50.0, 5.0), (25.0, 5.0)),
        ("G54\nV.G.NP_AKT.V.X = 60\n{} G00 X0 Z5", (60.0, 35.0), (30.0, 35.0)),
    ],
)
def test_offsets_of_the_facing_axis_are_halved(program, code, radius, diameter):
    """With G51 and G52 alike: a list has one meaning."""
    if "\n" in program:
        program = program.replace("{}", f"{code}\n")
    else:
        head, _, rest = program.partition("{}")
        program = f"{head}\n{code}\n{rest}"
    assert place(program, on=False) == radius
    assert place(program) == diameter


@pytest.mark.parametrize("on", [False, True])
def test_programs_read_offsets_as_they_are_given(on):
    """40 of the list, 12 that the program has written, 7 of the active one; Z has its own."""
    lines = "V.G.NP[2].V.X = 12\nG54\nP1 = V.G.NP[1].V.X\nP2 = V.G.NP[2].V.X\nP3 = V.G.NP_AKT.V.X + V.G.NP_AKT.V.Z"
    program = f"{lines}\nV.G.NP_AKT.V.X = 7\nP4 = V.G.NP_AKT.V.X\nG53 G52\nG00 X[P1 + P2 + P3 + P4] Z0"
    assert place(program, on=on)[0] == 40.0 + 12.0 + 70.0 + 7.0


def test_a_whole_turned_diameter():
    """The offset 40 and G51: X60 is 30 mm beside the zero point, which is 20 mm from that of the machine."""
    assert place("G54 G51\nG00 X60 Z0") == (50.0, 30.0)


def test_commands():
    """set_zero_offset gives a diameter; teach-in takes a position of the axis, which is a radius."""
    bench = MachineBench(machine=lathe(True), end_when_idle=False).run(0.1)
    assert bench.give("channel", "set_zero_offset", index=3, axis="X", value=30.0).accepted
    bench.give("channel", "mdi", text="G18 G56 G00 X0 Z1")
    bench.run(2.0)
    assert bench.position("x") == 15.0
    bench.give("channel", "mdi", text="G53 X62 Z1")
    bench.run(2.0)
    assert bench.give("channel", "teach_zero_offset", index=4, axis="X", value=2.0).accepted
    bench.give("channel", "mdi", text="P1 = V.G.NP[4].V.X\nG57 X0\nG53 Z[P1]")
    bench.run(3.0)
    assert (bench.position("x"), bench.position("z")) == (60.0, 120.0)


def test_iso_zero_offsets_of_g10():
    settings = replace(lathe(True).channels["channel"], dialect="iso")
    machine_ = replace(lathe(True), channels={"channel": settings})
    bench = MachineBench("G18 G90\nG10 L2 P2 X30\nG55 G00 X0 Z5\nM30\n", machine=machine_).run()
    assert bench.errors() == []
    assert bench.position("x") == 15.0


def test_a_channel_without_a_facing_axis_is_told():
    text = machine_text(PATH).replace(" | ACHSMODE_PLANDREHEN", "").replace("durchm_prog_abs: 1", "durchm_prog_abs: 0")
    text = text.replace("    spdl_anzahl: 2", "    versch_im_durchm: 1\n    spdl_anzahl: 2")
    assert [str(notice).partition(": ")[2] for notice in load_machine(text, "m.yaml").warnings] == [
        "P-CHAN-00091 versch_im_durchm of /channel: without effect, the channel has no facing axis (P-AXIS-00015 0x40)"
    ]
    assert load_machine(text.replace("ACHSMODE_LINEAR", "ACHSMODE_PLANDREHEN"), "m.yaml").warnings == ()
