"""Offsets of the machine in programs: default, inactive axes, G53, clamp position, software limits, the report of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nc_support import run

from cnc_ptp.nc.canonical import CanonicalBlock, OffsetReport
from cnc_ptp.nc.canonical_text import format_block
from cnc_ptp.parameters import OffsetTables

TABLES = OffsetTables(
    zero={0: (1.0, 2.0, 3.0), 1: (10.0, 20.0, 30.0), 2: (100.0, 200.0, 300.0)},
    inactive={2: frozenset({1})},
    default=1,
    clamp={0: (0.5, 0.0, -0.5)},
)


def targets(text: str, **options: object) -> list[tuple[float, ...]]:
    return [block.motion.target for block in run(text, **options) if block.motion]


def reports(blocks: list[CanonicalBlock]) -> list[tuple[int, OffsetReport]]:
    return [(block.source.line, block.offsets) for block in blocks if block.offsets is not None]


def test_a_program_starts_with_the_default_offset_and_the_clamp_position():
    assert targets("G00 X0 Y0 Z0", offsets=TABLES) == [(10.5, 20.0, 29.5)]
    assert targets("G53 G00 X0 Y0 Z0", offsets=TABLES) == [(0.5, 0.0, -0.5)]


def test_inactive_axes_have_no_offset():
    assert targets("G55 G00 X0 Y0 Z0", offsets=TABLES) == [(100.5, 0.0, 299.5)]
    assert targets("G55\nG160=2 Y0 X1\nG00 X0 Y0 Z0\nG55 X0 Y0 Z0", offsets=TABLES) == [
        (100.5, 0.0, 299.5),
        (0.5, 200.0, 299.5),
    ]


def test_g53_selects_an_offset_where_the_machine_has_one():
    available = TABLES._replace(g53=True)
    assert targets("G53 G00 X0 Y0 Z0", offsets=available) == [(1.5, 2.0, 2.5)]
    assert targets("G159=0 G00 X0 Y0 Z0", offsets=available) == [(1.5, 2.0, 2.5)]


def test_a_parameter_may_name_the_offset():
    text = "P1 = 2\nG159=P1 G00 X0 Y0 Z0\nG160=P1 X1\nG159=[P1 - 1] X0 Y0 Z0\nG159=[P1] X0"
    assert targets(text, offsets=TABLES._replace(clamp={})) == [
        (100.0, 0.0, 300.0),
        (10.0, 20.0, 30.0),
        (0.0, 20.0, 30.0),
    ]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("V.A.PZV.Z", -0.5),
        ("V.G.NP_DEFAULT", 1.0),
        ("V.G.NP_AKT.IDX", 1.0),
        ("V.G.NP_AKT.V.Y", 20.0),
        ("V.G.NP[2].V.Y", 200.0),
        ("V.A.-SWE.X", -300.0),
        ("V.A.+SWE.X", 250.0),
        ("V.A.-SWE_MDS.X", -300.0),
        ("V.A.+SWE_MDS.X", 250.0),
    ],
)
def test_state_that_programs_read(name, value):
    limits = ((-300.0, 250.0),) * 3
    text = f"P1 = {name}\n#MCS ON\nG00 Y[P1]"
    assert targets(text, offsets=TABLES, soft_limits=limits) == [(0.0, value, 0.0)]


def test_the_software_limit_in_effect_is_the_narrower_one():
    text = "G98 X-400\nG99 X20\nP1 = V.A.-SWE.X P2 = V.A.+SWE.X\nG98 X-50\nP3 = V.A.-SWE.X\nG00 X[P2] Y[P1] Z[P3]"
    assert targets(text, soft_limits=((-300.0, 250.0),) * 3) == [(20.0, -300.0, -50.0)]
    assert targets("G70\nP1 = V.A.+SWE_MDS.X\nG71 G00 Y[P1]", soft_limits=((-254.0, 254.0),) * 3) == [(0.0, 10.0, 0.0)]


def test_a_report_comes_with_the_next_block_and_only_after_a_change():
    text = "G00 X1\nX2\nG54\nX3\nX4\nG92 Y5\nG54 Z1\nM30"
    blocks = run(text, offsets=TABLES._replace(default=0, clamp={}))
    found = reports(blocks)
    assert [line for line, _ in found] == [4, 7]
    assert found[0][1].zero_index == 1 and found[0][1].zero == (10.0, 20.0, 30.0)
    assert found[1][1].added == (0.0, 5.0, 0.0)
    assert found[1][1].shift == (10.0, 25.0, 30.0)


def test_a_change_at_the_end_has_a_block_of_its_own():
    blocks = run("G00 X1\nG54", offsets=TABLES)
    assert blocks[-1][:4] == (blocks[-1].source, (), None, "")
    assert blocks[-1].source.line == 2 and blocks[-1].offsets.zero_index == 1
    assert run("G90") == []
    assert format_block(blocks[-1]) == "2:N0 | offsets (10.5, 20, 29.5)"


def test_a_report_names_all_that_counts():
    text = "#ACS ON [1, 2, 3]\nG54\n#CS ON [4, 5, 6, 0, 0, 90]\nG55 G92 X7\n#PSET Y8\nG22\n#SCALE ON X2\n#ROTATION ON [ANGLE=30]\nG00 Z1"
    (report,) = (report for _, report in reports(run(text, offsets=TABLES)))
    assert report.systems == ("#ACS", "#CS")
    assert (report.zero_index, report.zero, report.added) == (2, (100.0, 0.0, 300.0), (7.0, 0.0, 0.0))
    assert (report.scale, report.mirrored, report.angle) == ((2.0, 1.0, 1.0), (False, True, False), 30.0)
    assert report.clamp_index == 0 and report.clamp == (0.5, 0.0, -0.5) and not report.machine


def test_machine_coordinates_are_reported_as_such():
    (_, on), (_, off) = reports(run("#MCS ON\nG00 X1\n#MCS OFF\nX2", offsets=TABLES))
    assert on.machine and on.shift == (0.0, 0.0, 0.0) and on.zero_index == 0 and on.clamp == (0.0, 0.0, 0.0)
    assert not off.machine and off.shift == (10.5, 20.0, 29.5)


lengths = st.integers(-9999, 9999).map(lambda n: n / 100.0)
points = st.tuples(lengths, lengths, lengths)


@given(points, points, lengths, st.integers(-360, 360), st.sampled_from(["G20", "G21", "G22", "G23"]))
def test_matrix_and_shift_of_a_report_give_the_machine_position(point, shift, added, angle, mirror):
    x, y, z = shift
    text = f"G55 G92 Z{added}\n#CS ON [{x}, {y}, {z}, {angle}, 10, 20]\n{mirror}\n#ROTATION ON [ANGLE={angle}]"
    x, y, z = point
    blocks = run(f"{text}\nG00 X{x} Y{y} Z{z}", offsets=TABLES)
    report = blocks[-1].offsets
    machine = np.array(report.matrix).reshape(3, 3) @ point + report.shift
    assert np.allclose(blocks[-1].motion.target if blocks[-1].motion else (0.0, 0.0, 0.0), machine, atol=1e-8)
