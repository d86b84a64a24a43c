"""Graph, free run, composed and offline run give the same numbers to the bit; each recording can be verified."""

import re
import struct
from pathlib import Path

import numpy as np
import pytest
from graph_support import MILL, PTP, SHORT_PROGRAM, SHORT_SCENARIO, run, states_equal, verified
from long_support import long
from mcap.reader import make_reader
from mcap.writer import Writer

from cnc_ptp.recording.reader import read_recording

PTP_SCENARIO = """
- {at: 0.0, to: x, do: move_absolute, target: 1000.0, velocity: 2000.0, acceleration: 5000.0, jerk: 50000.0}
- {at: 0.0, to: "y", do: move_relative, distance: -300.0, velocity: 800.0}
- {at: 0.25, to: x, do: set_override, percent: 75.0}
- {at: 0.3, to: x, do: compensation_start, length: 300, difference: 20, process_velocity: 1500, velocity_increase: 300}
- {at: 0.4, to: "y", do: stop}
- {at: 0.45, to: "y", do: new_target, target: -50}
- {at: 0.5, to: z, do: move_absolute, target: 1.0e9}
- {at: 0.5, to: z, do: external_enable, mode: absolute, target: 2}
- {at: 0.5, to: z, do: external_setpoints, file: setpoints.csv}
- {at: 0.0, to: c, do: move_modulo, position: -450}
- {at: 0.3, to: c, do: new_velocity_and_target, velocity: 200, target: -500, activation_position: -300}
- {at: 1.0, to: x, do: new_target, target: 800}
"""
SETPOINTS = "cycle,position,velocity,acceleration,direction\n" + "".join(
    f"{n},{0.5 * 400.0 * (0.001 * n) ** 2},{0.4 * n},400,{1 if n < 100 else 0}\n" for n in range(101)
)

SLAVE_SCENARIO = """
- {at: 0.0, to: z, do: couple, master: "y", factor: 0.8}
- {at: 0.0, to: "y", do: couple, master: x, factor: -0.5}
- {at: 0.0, to: c, do: couple_cyclic, master: x, acc_bound: 4000}
- {at: 0.0, to: x, do: move_absolute, target: 3000.0, velocity: 2000.0, acceleration: 5000.0, jerk: 50000.0}
- {at: 0.2, to: c, do: set_cyclic_factor, factor: 0.4}
- {at: 0.3, to: z, do: compensation_start, length: 200, difference: 20, process_velocity: 800, velocity_increase: 300}
- {at: 0.6, to: "y", do: set_coupling_factor, factor: -0.6}
- {at: 0.8, to: "y", do: decouple}
- {at: 1.2, to: "y", do: stop}
- {at: 1.4, to: x, do: stop}
"""

PROBE = MILL.parents[1] / "examples" / "probe.yaml"
Z_IN_CHANNEL = '          "2": {bezeichnung: Z, log_achs_nr: 3}\n'
ON_A_PATH = """%CIRCLE
N10 G01 X20 Y0 F6000
N20 G04 X1
N30 G02 X20 Y0 I-20 J0 F3000
N40 G01 X0 Y0 F6000
N50 M30
"""
ON_A_PATH_SCENARIO = """
- {at: 0.0, to: z, do: jog, velocity: 8}
- {at: 0.4, to: x, do: couple_flying_saw, master: z, factor: 1, master_position: 8, slave_position: 3}
- {at: 2.0, to: x, do: decouple}
- {at: 2.2, to: x, do: external_enable, mode: relative}
- {at: 2.3, to: x, do: external_setpoints, file: setpoints.csv}
- {at: 2.35, to: x, do: external_disable}
- {at: 3.0, to: z, do: stop}
"""


LANGUAGE = """#VAR
V.P.STEP = 4
#ENDVAR
T1 D11
G00 X3 Z-90
G04 0.3
P1 = V.A.ACT_POS.X
#MSG ["it is at %f", P1]
#ROTATION ON [ANGLE=30]
$FOR P2 = 0, 400000, 1
$ENDFOR
$WHILE P1 < 12
P1 = P1 + V.P.STEP
G01 X=P1 F6000 L CYCLE [NAME=side.nc @P1=P1]
$ENDWHILE
M30
"""
TOOLS = "1: {type: mill, wear: {length: -0.02}, d: {11: {length: 75.2, offsets: {X: 0.25}}}}"
FILES = "    werkz_data: tools.yaml\n    nullp_data: zero.yaml\n"
SIDE = """G91 G00 Y[@P1 / 10]
X[V.A.ACT_POS.Y / 100]
M29
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("equality")
    (folder / "short.nc").write_text(SHORT_PROGRAM)
    (folder / "short.yaml").write_text(SHORT_SCENARIO)
    (folder / "ptp.yaml").write_text(PTP_SCENARIO)
    (folder / "setpoints.csv").write_text(SETPOINTS)
    (folder / "slaves.yaml").write_text(SLAVE_SCENARIO)
    (folder / "circle.nc").write_text(ON_A_PATH)
    (folder / "language.nc").write_text(LANGUAGE)
    (folder / "side.nc").write_text(SIDE)
    (folder / "tools.yaml").write_text(TOOLS)
    (folder / "zero.yaml").write_text("{default: G54, G54: {Z: 1.5}}")
    mill = Path(MILL).read_text().replace("    spdl_anzahl: 1\n", "    spdl_anzahl: 1\n" + FILES)
    (folder / "mill.yaml").write_text(mill)
    (folder / "circle.yaml").write_text(ON_A_PATH_SCENARIO)
    return folder


@pytest.fixture(scope="module")
def offline(folder):
    job = (MILL, "--program", folder / "short.nc", "--scenario", folder / "short.yaml")
    run("simulate", *job, "--record", folder / "offline.mcap")
    return folder / "offline.mcap"


@pytest.mark.parametrize("options", [[], *long([["--free-run"]]), ["--composed"]], ids=str)
def test_graph_equals_the_offline_run(folder, offline, options):
    recording = folder / "graph.mcap"
    job = (MILL, "--program", folder / "short.nc", "--scenario", folder / "short.yaml", "--record", recording)
    output = run("run", *job, *options).stdout
    assert "lost 0, computed twice 0" in output
    assert states_equal(offline, recording) == []
    assert len(verified(recording).states) == 5
    assert held_by_override(recording) == held_by_override(offline) != []


def held_by_override(recording):
    """Cycle and text of each warning that a program waits because of override 0."""
    return [(event.cycle, event.text) for event in read_recording(recording).events if event.error_id == 22024]


def test_ptp_graph_equals_the_offline_run(folder):
    job = (PTP, "--scenario", folder / "ptp.yaml")
    run("simulate", *job, "--record", folder / "a.mcap")
    output = run("run", *job, "--composed", "--free-run", "--record", folder / "b.mcap").stdout
    assert "axis z: move_absolute refused: target 1000000000.0 mm lies beyond the positive soft limit" in output
    assert states_equal(folder / "a.mcap", folder / "b.mcap") == []
    assert len(verified(folder / "b.mcap").states) == 4


graphs = pytest.mark.parametrize("options", [["--free-run"], *long([["--composed", "--free-run"]])], ids=" ".join)
"""Real time only where the clock has a part in it: test_graph_equals_the_offline_run."""


@graphs
def test_slaves_in_the_graph_equal_the_offline_run(folder, options):
    """Couplings over processes: the same numbers, and no cycle of delay."""
    job = (PTP, "--scenario", folder / "slaves.yaml")
    run("simulate", *job, "--record", folder / "c.mcap")
    output = run("run", *job, *options, "--record", folder / "d.mcap").stdout
    assert "lost 0, computed twice 0" in output and "refused" not in output
    assert states_equal(folder / "c.mcap", folder / "d.mcap") == []
    states = verified(folder / "d.mcap").states
    coupled = slice(0, 600)
    x, y = (states[f"/{axis}/state"]["set_position"][coupled] for axis in ("x", "y"))
    assert np.abs(y + 0.5 * x).max() <= 1e-9 and x[-1] > 500.0


@pytest.mark.long
@graphs
def test_programs_that_are_interpreted_while_they_run_equal_the_offline_run(folder, options):
    """Actual positions, a cycle, tools and offsets in files of their own, a computation of many cycles, a message."""
    job = (folder / "mill.yaml", "--program", folder / "language.nc")
    told = run("simulate", *job, "--record", folder / "g.mcap").stdout
    output = run("run", *job, *options, "--record", folder / "h.mcap").stdout
    assert "lost 0, computed twice 0" in output and "refused" not in output
    assert "message: it is at " in told and "message: it is at " in output
    assert states_equal(folder / "g.mcap", folder / "h.mcap") == []
    states = verified(folder / "h.mcap").states
    assert states["/z/state"]["set_position"][-1] == pytest.approx(-90.0 + 1.5 + 75.2 - 0.02, abs=1e-12)


MEASURING = """%P
N10 G60 G100 X60 F1200 M97
N20 P1 = V.A.MEAS.PCS.VALUE.X
N30 G91 G01 X-1 F3000
N40 G90 X[P1 - 5]
N50 G100 Y40 Z-60 F900
N60 G00 Z[V.A.MESS.Y / 10]
N70 G100 Z-60 F600
N80 $IF V.A.MERF.Z
N90 #MSG ["Y %f, Z %f", V.A.MESS.Y, V.A.MOFFS.Z]
N100 $ENDIF
M30
"""
MEASURING_SCENARIO = (
    "- {at: 4.5, to: channel, do: measuring_event}\n- {at: 2.5, to: channel, do: set_override, percent: 70}\n"
)


@pytest.mark.long
@graphs
def test_measuring_in_the_graph_equals_the_offline_run(folder, options):
    """Signals of simulated probes and of the PLC: the same instants, positions and stops."""
    (folder / "measuring.nc").write_text(MEASURING)
    (folder / "measuring.yaml").write_text(MEASURING_SCENARIO)
    job = (PROBE, "--program", folder / "measuring.nc", "--scenario", folder / "measuring.yaml")
    told = run("simulate", *job, "--record", folder / "m.mcap").stdout
    output = run("run", *job, *options, "--record", folder / "n.mcap").stdout
    assert "lost 0, computed twice 0" in output and "refused" not in told
    messages = [line for line in told.splitlines() if line.startswith("message: ")]
    assert len(messages) == 4 and [line for line in output.splitlines() if line.startswith("message: ")] == messages
    assert states_equal(folder / "m.mcap", folder / "n.mcap") == []
    assert len(verified(folder / "n.mcap").states) == 4


CONTROLLED = """%P
N10 M3 S1000 T3
N20 G00 X10 Y10
/2 N30 Z5
N40 $FOR P1 = 1, 3, 1
N50 G01 X[20+P1] F3000
N60 L side.nc
N70 $ENDFOR
N80 G00 X0 Y0
M30
"""
CONTROLLED_SCENARIO = """
- {at: 0.0, to: channel, do: single_block, enabled: on, mode: motion}
- {at: 1.0, to: channel, do: single_block, enabled: off}
- {at: 1.0, to: channel, do: start}
- {at: 4.0, to: channel, do: block_skip, enabled: on, level: 2}
- {at: 4.0, to: channel, do: mdi, text: "G00 X1\\n/2 Z9\\nL side.nc"}
- {at: 5.0, to: channel, do: start, line: 2, in_program: side.nc, pass_number: 3}
- {at: 6.0, to: channel, do: start, line: 77}
"""


@graphs
def test_program_control_in_the_graph_equals_the_offline_run(folder, options):
    """A start at a block, stops behind motions, manual blocks with a file, skip levels, a second start in a file."""
    (folder / "side.nc").write_text("G91 Y1\nG90 M8\nM29\n")
    (folder / "controlled.nc").write_text(CONTROLLED)
    (folder / "controlled.yaml").write_text(CONTROLLED_SCENARIO)
    job = (MILL, "--program", folder / "controlled.nc", "--scenario", folder / "controlled.yaml")
    start = ("--start-block", 50, "--start-pass", 2)
    told = run("simulate", *job, *start, "--record", folder / "i.mcap").stdout
    output = run("run", *job, *start, *options, "--record", folder / "j.mcap").stdout
    assert "lost 0, computed twice 0" in output
    for text in (told, output):
        steps = re.findall(r"^message: (.*)$", text, re.MULTILINE)
        assert steps[:4] == [
            "line 2: T3 S[M3 REV1000]",
            "line 2 of side.nc: M8",
            "G00: Z 0 to 5",
            "G00: X 0 to 21, Y 0 to 11",
        ]
        assert "message: continues with line 6 'N50 G01 X[20+P1] F3000'" in text
        assert "continues with line 2 'G90 M8'" in text
        assert text.count("refused: ") == 1 and "there is no line 77: the last one is 10; nothing was started" in text
    assert states_equal(folder / "i.mcap", folder / "j.mcap") == []
    verified(folder / "j.mcap")


CHORDS = "\n".join(f"G01 X{0.05 * n:.2f} Y{30 + (0.05 * n) ** 2 / 40:.3f}" for n in range(300))
LINKED = f"""G00 X0 Y0
#CONTOUR MODE [DEV PATH_DEV=0.05]
G261 F6000
G01 X30
Y20
M8
G03 X20 Y30 I-10 J0
G01 X0
#HSC ON [BSPLINE PATH_DEV=0.005]
{CHORDS}
#HSC OFF
G60 X40
M30
"""
LINKED_SCENARIO = """
- {at: 0.35, to: channel, do: set_override, percent: 40}
- {at: 0.7, to: channel, do: feed_hold, enabled: true}
- {at: 1.0, to: channel, do: feed_hold, enabled: false}
- {at: 1.2, to: channel, do: set_override, percent: 110}
"""


@pytest.mark.long
@graphs
def test_linked_blocks_in_the_graph_equal_the_offline_run(folder, options):
    """Corners, arcs and short blocks that the path runs through, with override and feed hold."""
    (folder / "linked.nc").write_text(LINKED)
    (folder / "linked.yaml").write_text(LINKED_SCENARIO)
    job = (MILL, "--program", folder / "linked.nc", "--scenario", folder / "linked.yaml")
    run("simulate", *job, "--record", folder / "k.mcap")
    output = run("run", *job, *options, "--record", folder / "l.mcap").stdout
    assert "lost 0, computed twice 0" in output
    assert states_equal(folder / "k.mcap", folder / "l.mcap") == []
    verified(folder / "l.mcap")


STREAMED = "    interpreter: {checked_text: 1000, blocks_per_cycle: 1}\n"
"""Blocks of 0.02 mm: 20 mm/s."""
CALLS = """%L UP
G91 Y0.5
G90
M29
"""
SHORT = "G359 F6000\n" + "\n".join(f"G01 X{0.02 * n:.2f}" for n in range(600))
BEHIND = """LL UP
$FOR P1 = 0, 3, 1
G01 X[40 - P1]
$ENDFOR
P2 = V.A.ACT_POS.X
G01 X[P2 / 100]
M8
M30
"""


@pytest.mark.parametrize("bad", [*long([False]), True], ids=["good", "bad"])
@graphs
def test_a_program_that_is_read_while_it_runs_equals_the_offline_run(folder, options, bad):
    """Too few blocks for the feed, override and feed hold, a subroutine, a loop, an actual position; or a fault."""
    machine = folder / "streamed.yaml"
    machine.write_text(MILL.read_text().replace("    spdl_anzahl: 1\n", "    spdl_anzahl: 1\n" + STREAMED))
    fault = "M9\nG01 X0 Y1000\n" if bad else ""
    (folder / "streamed.nc").write_text(f"{CALLS}%MAIN\n{SHORT}\n{LINKED.replace('M30', fault + BEHIND)}")
    (folder / "linked.yaml").write_text(LINKED_SCENARIO)
    job = (machine, "--program", folder / "streamed.nc", "--scenario", folder / "linked.yaml")
    expect = 1 if bad else 0
    told = run("simulate", *job, "--record", folder / "m.mcap", expect=expect)
    output = run("run", *job, *options, "--record", folder / "n.mcap", expect=expect)
    assert "lost 0, computed twice 0" in output.stdout
    for text in (told.stdout, output.stdout):
        assert "more than 1000 characters (P-CHAN-90005): it is checked while it runs" in text
        assert text.count("P-WARN-22036 channel channel: the path is slower in line ") == 1
    assert states_equal(folder / "m.mcap", folder / "n.mcap") == []
    verified(folder / "n.mcap")
    reason = "'G01 X0 Y1000': axis Y: 1000 mm lies beyond the positive soft limit"
    for result in (told, output):
        assert (reason in result.stdout + result.stderr) == bad


@pytest.mark.long
@graphs
def test_superpositions_on_a_path_equal_the_offline_run(folder, options):
    """The flying saw and external setpoints on top of a circle, with z as the conveyor."""
    machine = without_z_in_the_channel(folder)
    job = (machine, "--program", folder / "circle.nc", "--scenario", folder / "circle.yaml")
    run("simulate", *job, "--record", folder / "e.mcap")
    output = run("run", *job, *options, "--record", folder / "f.mcap").stdout
    assert "lost 0, computed twice 0" in output and "refused" not in output
    assert states_equal(folder / "e.mcap", folder / "f.mcap") == []
    states = verified(folder / "f.mcap").states
    on_workpiece = slice(1500, 2000)
    x, y, z = (states[f"/{axis}/state"]["set_position"][on_workpiece] for axis in ("x", "y", "z"))
    assert np.abs(np.hypot(x - 3.0 - (z - 8.0), y) - 20.0).max() <= 1e-9


def test_offline_run_is_verified_and_a_refused_move_is_recorded(offline):
    assert "equal to the bit" in run("replay", offline).stdout
    refused = [record for record in read_recording(offline).commands if not record.accepted]
    assert [(record.target, record.command, record.cycle) for record in refused] == [("x", "move_absolute", 2100)]


def test_one_altered_sample_is_found(folder, offline, tmp_path):
    """A recording in which one bit of one setpoint differs: topic, cycle and field are named."""
    rows = read_recording(offline).states["/y/state"]
    cycle = int(np.flatnonzero(np.abs(rows["set_velocity"]) > 1.0)[50])
    exact = struct.pack("<d", rows["set_velocity"][cycle])
    altered = alter(offline, tmp_path, "/y/state", cycle, lambda data: flip_bit(data, data.index(exact)))
    output = run("replay", altered, expect=1).stderr
    assert "1 differences" in output
    assert f"/y/state cycle {cycle} set_velocity: recorded" in output


def test_an_absurd_cycle_number_neither_hangs_nor_passes(offline, tmp_path):
    altered = alter(
        offline, tmp_path, "/y/state", 700, lambda data: flip_bit(data, data.index(struct.pack("<Q", 700)) + 5)
    )
    output = run("replay", altered, expect=1).stderr
    assert "/y/state: 1 cycles missing: 700" in output
    assert f"/y/state: 1 cycles not computed: {700 + 2**40}" in output


def without_z_in_the_channel(folder):
    mill = MILL.read_text()
    path = folder / "conveyor.yaml"
    path.write_text(mill.replace("achs_anzahl: 3", "achs_anzahl: 2").replace(Z_IN_CHANNEL, ""))
    return path


def flip_bit(data, place):
    return data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]


def alter(source_path, folder, topic, number, change):
    """A copy of a recording, written by the library alone, in which message `number` of a topic is changed."""
    path = folder / "altered.mcap"
    with source_path.open("rb") as source, path.open("wb") as target:
        reader, writer = make_reader(source), Writer(target)
        writer.start("ros2", "test")
        for attachment in reader.iter_attachments():
            writer.add_attachment(0, 0, attachment.name, attachment.media_type, attachment.data)
        for metadata in reader.iter_metadata():
            writer.add_metadata(metadata.name, metadata.metadata)
        channels = {}
        seen = 0
        for schema, channel, message in reader.iter_messages():
            if channel.id not in channels:
                known = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, channel.message_encoding, known)
            data = message.data
            if channel.topic == topic:
                data = change(data) if seen == number else data
                seen += 1
            writer.add_message(channels[channel.id], message.log_time, data, message.publish_time)
        writer.finish()
    return path


TAPPING = """N10 M19 S.POS=90 S300
N20 G63 Z-6 F2500 S2000
N30 Z2 S-2000
N40 G331 Z-3 K1 S1500
N50 G332 Z2 K1
N60 G01 X5 F2000
N70 M30
"""
TAPPING_SCENARIO = """
- {at: 0.9, to: channel, do: set_override, percent: 60}
- {at: 1.1, to: s, do: set_override, percent: 80}
- {at: 1.3, to: channel, do: feed_hold, enabled: true}
- {at: 1.6, to: channel, do: feed_hold, enabled: false}
"""


@graphs
def test_tapping_in_the_graph_equals_the_offline_run(folder, options):
    """The spindle turns with the path in another process."""
    (folder / "tapping.nc").write_text(TAPPING)
    (folder / "tapping.yaml").write_text(TAPPING_SCENARIO)
    job = (MILL, "--program", folder / "tapping.nc", "--scenario", folder / "tapping.yaml")
    told = run("simulate", *job, "--record", folder / "t.mcap").stdout
    output = run("run", *job, *options, "--record", folder / "u.mcap").stdout
    assert "lost 0, computed twice 0" in output and "refused" not in told
    assert states_equal(folder / "t.mcap", folder / "u.mcap") == []
    assert len(verified(folder / "u.mcap").states) == 5


LATHE = MILL.parent / "lathe.yaml"
THREAD = "N10 M3 S600\nN20 G00 X20 Z10\nN30 G33 Z4 K1.5\nN40 Z0 K2\nN50 G00 X30\nN60 M5\nN70 M30\n"
TURNING = "G51 G00 X60 Z2\nG196 S2000\nG96 S120 M3\nG95 G01 X40 F0.2\nG97 M5\nM30\n"
C_AXIS = "G00 X30 Z5\n#CAX\n#FACE [X, C]\nG01 X20 C0 F3000\nX10 C8\n#FACE OFF\nG01 C90 F9000\n#CAX OFF\nM30\n"
WITH_SPINDLE = {"thread": THREAD, "turning": TURNING, "c_axis": C_AXIS}


@graphs
@pytest.mark.parametrize("motion", ["turning", *long(["thread", "c_axis"])])
def test_path_with_a_spindle_in_the_graph_equals_the_offline_run(folder, motion, options):
    """The path follows the reports of a spindle in another process, or moves it as its C axis."""
    (folder / "spindle.nc").write_text(WITH_SPINDLE[motion])
    job = (LATHE, "--program", folder / "spindle.nc")
    told = run("simulate", *job, "--record", folder / "v.mcap").stdout
    output = run("run", *job, *options, "--record", folder / "w.mcap").stdout
    assert "lost 0, computed twice 0" in output and "refused" not in told
    assert states_equal(folder / "v.mcap", folder / "w.mcap") == []
    assert len(verified(folder / "w.mcap").states) == 5
