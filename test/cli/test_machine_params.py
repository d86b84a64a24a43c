"""`cnc_ptp params --changed`, `diff` and `check`: parameters of machine files; lists and topics of the reference."""

from __future__ import annotations

from pathlib import Path

import pytest
from commands_support import call

from cnc_ptp.parameters.declare.declarations import catalogue

ROOT = Path(__file__).parents[2]
MILL, LATHE = ROOT / "config" / "mill.yaml", ROOT / "config" / "lathe.yaml"
FIRST = """\
/machine: {ros__parameters: {axes: [x, z]}}
/x: {ros__parameters: {getriebe: {"0": {kv: 2500}}, kenngr.swe_pos: 5000000, vorsteuer.vorsteuerung: VEL | ACC}}
"""
SECOND = """\
/machine: {ros__parameters: {axes: [x], spindles: [s]}}
/x: {ros__parameters: {getriebe: {"0": {kv: 2500}, "1": {kv: 3000}}, kenngr.swe_pos: 100000000}}
"""
BAD = """\
/machine: {ros__parameters: {axes: [x, "y"], channels: [c]}}
/x:
  ros__parameters:
    getriebe: {"0": {kv: 0, wegaufz: 0}}
    vorsteuer.velocity_delay_time: 20000
/y:
  ros__parameters:
    antr.torque_scale_denom: 0
    kenngr.swe_toleranz: 5
/c: {ros__parameters: {spdl_anzahl: 2}}
/zz: {}
"""


def written(folder: Path, name: str, text: str) -> str:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return str(path)


def rows(output: str) -> list[list[str]]:
    """The cells of a table, split at the gaps between its columns."""
    return [[cell.strip() for cell in line.split("  ") if cell.strip()] for line in output.splitlines()]


def test_what_a_machine_changes(tmp_path: Path) -> None:
    done = call("params", "--changed", written(tmp_path, "a.yaml", FIRST))
    assert done.exit_code == 0
    assert rows(done.output) == [
        ["node", "id", "name", "value", "default", "unit"],
        ["/machine", "P-MACH-00005", "axes", "[x, z]", "[]"],
        ["/x", "P-AXIS-00099", "getriebe[0].kv", "2500", "1000", "0.01/s"],
        ["/x", "P-AXIS-00178", "kenngr.swe_pos", "5000000", "100000000", "0.1 µm"],
        ["/x", "P-AXIS-00223", "vorsteuer.vorsteuerung", "VEL | ACC", "NONE"],
    ]


def test_a_value_that_is_the_default_is_not_changed(tmp_path: Path) -> None:
    text = "/machine: {ros__parameters: {axes: [x]}}\n/x: {ros__parameters: {kenngr.swe_pos: 100000000}}\n"
    done = call("params", "--changed", written(tmp_path, "a.yaml", text), "P-AXIS")
    assert (done.exit_code, done.output) == (0, "nothing differs from the defaults\n")


def test_words_narrow_what_is_changed(tmp_path: Path) -> None:
    done = call("params", "--changed", written(tmp_path, "a.yaml", FIRST), "kv")
    assert [row[1] for row in rows(done.output)[1:]] == ["P-AXIS-00099"]


def test_two_machines_differ(tmp_path: Path) -> None:
    first, second = written(tmp_path, "a.yaml", FIRST), written(tmp_path, "b.yaml", SECOND)
    done = call("params", "diff", first, second)
    assert done.exit_code == 1
    found = rows(done.output)
    assert found[0] == ["node", "id", "name", "first", "second", "unit"]
    assert ["/x", "P-AXIS-00178", "kenngr.swe_pos", "5000000", "100000000", "0.1 µm"] in found
    assert ["/x", "P-AXIS-00223", "vorsteuer.vorsteuerung", "VEL | ACC", "NONE"] in found
    assert ["/x", "P-AXIS-00099", "getriebe[1].kv", "-", "3000", "0.01/s"] in found
    assert ["/z", "-", "the node itself", "axis", "-"] in found
    assert ["/s", "-", "the node itself", "-", "spindle"] in found
    assert not [row for row in found if row[2] == "getriebe[0].kv"]


def test_the_same_machine_does_not_differ() -> None:
    done = call("params", "diff", str(MILL), str(MILL))
    assert (done.exit_code, done.output) == (0, "no parameter differs\n")


def test_a_given_default_does_not_differ_from_none(tmp_path: Path) -> None:
    plain = "/machine: {ros__parameters: {axes: [x]}}\n"
    given = plain + "/x: {ros__parameters: {kenngr.swe_pos: 100000000}}\n"
    assert call("params", "diff", written(tmp_path, "a", plain), written(tmp_path, "b", given)).exit_code == 0


def test_all_findings_at_once(tmp_path: Path) -> None:
    file = written(tmp_path, "bad.yaml", BAD)
    done = call("params", "check", file)
    assert done.exit_code == 2
    assert done.output.splitlines() == [
        f"{file}:4:26: error 25008: axis list, P-AXIS-00099 getriebe[0].kv of /x: value 0 is not above 0 (0.01/s)",
        f"{file}:4:38: warning 110386: P-AXIS-00234 getriebe[0].wegaufz of /x: value 0 is corrected to 1",
        f"{file}:5:36: warning 70349: P-AXIS-00389 vorsteuer.velocity_delay_time of /x: delay 20000 µs is not below 6 interpolator cycles (6000 µs), 0 is used",
        f"{file}:8:30: warning 110465: P-AXIS-00326 antr.torque_scale_denom of /y: value 0 is not a valid denominator, no additive torque is output",
        f"{file}:9:26: warning 26120: P-AXIS-00179 kenngr.swe_toleranz of /y: accepted, but without effect in this version",
        f"{file}:10:37: error 25012: channel list, P-CHAN-00082 spdl_anzahl of /c: value 2, but 0 spindles are listed (spindel[i])",
        f"{file}:11:1: error 25004: section /zz has no unit in /machine (units: /c, /x, /y)",
        "3 errors, 4 warnings: the machine does not start",
    ]


@pytest.mark.parametrize("machine", sorted((ROOT / "config").glob("*.yaml")), ids=lambda path: path.stem)
def test_machines_that_are_shipped_start(machine: Path) -> None:
    done = call("params", "check", str(machine))
    assert done.exit_code == 0
    assert done.output.splitlines()[-1].endswith(": the machine starts")


@pytest.mark.parametrize("command", [["check"], ["diff"], ["diff", str(MILL)], ["search", "--changed"]])
def test_missing_files(command: list[str]) -> None:
    assert call("params", *command).exit_code == 2


@pytest.mark.parametrize(
    ("text", "error"),
    [
        (
            "",
            "P-ERR-25003 {}:1:1: section /machine is missing, it says which channels, axes and spindles exist; no parameters were read",
        ),
        ("- a", "P-ERR-25001 {}:1:1: a machine file is a mapping of node names; no parameters were read"),
    ],
)
def test_a_file_that_is_no_machine(tmp_path: Path, text: str, error: str) -> None:
    file = written(tmp_path, "m.yaml", text)
    for words in (["check", file], ["--changed", file], ["diff", file, str(MILL)]):
        done = call("params", *words)
        assert (done.exit_code, done.stderr) == (2, error.format(file) + "\n")


def test_lists_and_topics() -> None:
    for list_name in ("compensation", "P-COMP", "p-comp"):
        found = rows(call("params", "--list", list_name).output)[1:]
        assert [row[0] for row in found] == [n for n, e in catalogue().by_id.items() if e.list_name == "compensation"]
    found = rows(call("params", "--topic", "feedforward").output)[1:]
    assert {row[0] for row in found} == {n for n, e in catalogue().by_id.items() if e.topic == "feedforward"}
    assert call("params", "--list", "axis", "--topic", "spindle", "a_max").output.startswith("P-AXIS-00240")


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (
            ["--list", "nix"],
            "P-ERR-25018 no list is called 'nix', there are axis, channel, startup, zero, clamp, compensation, tool, simulation, machine, p-axis, p-mach, p-chan, p-stup, p-zero, p-clmp, p-comp, p-tool, p-sim",
        ),
        (["--list", "tool", "--topic", "homing"], "P-ERR-25018 no parameter matches all of this together"),
    ],
)
def test_what_there_is_not(words: list[str], error: str) -> None:
    done = call("params", *words)
    assert (done.exit_code, done.stderr) == (2, error + "\n")


def test_an_unknown_topic_names_those_that_there_are() -> None:
    done = call("params", "--topic", "nix")
    assert done.exit_code == 2
    assert done.stderr.startswith("P-ERR-25018 no topic is called 'nix', there are identification, travel range, ")
