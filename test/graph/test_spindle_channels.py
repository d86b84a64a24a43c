"""Channels that wait for their spindles in the graph: gear, coupling, PLC, late synchronisation; as in the offline run."""

from copy import deepcopy

import numpy as np
import pytest
import yaml
from graph_support import MILL, run, states_equal, verified
from long_support import long

PROGRAM = """%channels
N10 M41 S600 M3
N20 #SET AX LINK[1, S2=S]
N30 #ENABLE AX LINK[1]
N40 M3 S500
N50 G01 X5 F3000
N60 #DISABLE AX LINK
N70 S3[M3 REV300]
N80 G01 X8
N90 S2[M4 REV900]
N100 G01 X10
N110 #EXPL SYN
N120 G01 X0
N130 M5 S2[M5]
M30
"""
SCENARIO = """
- {at: 0.0, to: plc, do: auto_acknowledge, enabled: off}
- {at: 0.1, to: second, do: mdi, text: "M19 S60 S.POS=90\\nG01 Y5 F3000"}
- {at: 1.0, to: s, do: gear_changed}
- {at: 1.0, to: plc, do: acknowledge, id: 1}
- {at: 2.5, to: plc, do: acknowledge, id: 3}
- {at: 4.0, to: plc, do: acknowledge, id: 5}
- {at: 4.5, to: channel, do: mdi, text: "S3[M3 REV100]"}
- {at: 4.7, to: channel, do: reset}
"""
TYPES = ("m3_synch", "m4_synch", "m5_synch", "m19_synch")


def machine_of(folder):
    """The mill with X and Y in channels of their own; spindles: `s` with two gears, `t`, and one of the PLC in `channel`."""
    mill = {name: node["ros__parameters"] for name, node in yaml.load(MILL.read_text(), yaml.BaseLoader).items()}
    gear = mill["/s"]["getriebe"]["0"]
    t = {**mill["/s"], "kopf": {"achs_nr": "5"}, "getriebe": {"0": {**gear, "wegaufz": "0"}}}
    spindles = {
        "0": {"bezeichnung": "S1", "log_achs_nr": "4", **dict.fromkeys(TYPES, "MVS_SVS")},
        "1": {"bezeichnung": "S2", "log_achs_nr": "5", **dict.fromkeys(TYPES, "MVS_SVS")},
    }
    ranges = {"0": {"min_speed": "50", "max_speed": "560"}, "1": {"min_speed": "400", "max_speed": "800"}}
    first = {
        "0": {**spindles["0"], "range_table": ranges},
        "1": {**spindles["1"], "m4_synch": "MVS_SLP | PLC_INFO"},
        "2": {"bezeichnung": "S3", "log_achs_nr": "9", "plc_control": "1", "m3_synch": "MVS_SVS"},
    }
    second = {**mill["/channel"], "gruppe": path_axis("Y", "2"), "spdl_anzahl": "2", "spindel": spindles}
    units = {
        "/machine": {**mill["/machine"], "channels": ["channel", "second"], "axes": ["x", "y"], "spindles": ["s", "t"]},
        "/channel": {
            **mill["/channel"],
            "gruppe": path_axis("X", "1"),
            "spdl_anzahl": "3",
            "main_spindle_gear_change": "1",
            "spindel": first,
        },
        "/second": {**second, "main_spindle_ax_nr": "5"},
        "/x": mill["/x"],
        "/y": mill["/y"],
        "/s": {**mill["/s"], "getriebe": {"0": gear, "1": {**gear, "getr_schalt_pos": "450000"}}},
        "/t": t,
    }
    text = yaml.dump({name: {"ros__parameters": deepcopy(part)} for name, part in units.items()}, Dumper=Plain)
    path = folder / "channels.yaml"
    path.write_text(text.replace("'", "").replace("- y\n", '- "y"\n').replace("bezeichnung: Y", 'bezeichnung: "Y"'))
    return path


def path_axis(name, number):
    return {"0": {"achs_anzahl": "1", "achse": {"0": {"bezeichnung": name, "log_achs_nr": number}}}}


class Plain(yaml.SafeDumper):
    """Without anchors."""

    def ignore_aliases(self, data):
        return True


@pytest.mark.parametrize("options", [*long([[]]), ["--composed", "--free-run"]], ids=str)
def test_channels_with_spindles_in_the_graph_equal_the_offline_run(tmp_path, options):
    machine = machine_of(tmp_path)
    (tmp_path / "p.nc").write_text(PROGRAM)
    (tmp_path / "job.yaml").write_text(SCENARIO)
    job = (machine, "--program", tmp_path / "p.nc", "--scenario", tmp_path / "job.yaml")
    offline = run("simulate", *job, "--record", tmp_path / "a.mcap").stdout
    output = run("run", *job, *options, "--record", tmp_path / "b.mcap").stdout
    assert "lost 0, computed twice 0" in output
    notices = [line for line in output.splitlines() if line.startswith("warning: P-WARN-110386")]
    assert notices == [line for line in offline.splitlines() if line.startswith("warning: P-WARN-110386")]
    assert [notice.partition(" of ")[2] for notice in notices] == ["/t: value 0 is corrected to 1"]
    assert states_equal(tmp_path / "a.mcap", tmp_path / "b.mcap") == []
    recorded = verified(tmp_path / "b.mcap")
    assert [record.message for record in recorded.commands if not record.accepted] == []
    check_waits(recorded.states)


def check_waits(states):
    """What the spindles did when the motions of X and Y began, and when those were."""
    x, y, s, t = (states[f"/{name}/state"] for name in ("x", "y", "s", "t"))
    begins = [
        np.flatnonzero((unit["set_velocity"][:-1] == 0.0) & (unit["set_velocity"][1:] != 0.0)) + 1 for unit in (x, y)
    ]
    linked, after_plc, last = begins[0]
    assert t["in_position"][begins[1][0] - 1] and linked > 1000 and np.unique(s["gear"]).tolist() == [1, 2]
    assert [abs(unit["actual_speed_rpm"][linked] - 500.0) < 50.0 for unit in (s, t)] == [True, True]
    assert (after_plc, last) == (2501, 4001)
    assert abs(t["actual_speed_rpm"][last] + 900.0) < 90.0 and s["set_speed_rpm"][-1] == t["set_speed_rpm"][-1] == 0.0
