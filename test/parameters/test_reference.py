"""The parameter reference."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import load_machine
from cnc_ptp.parameters.declare import where
from cnc_ptp.parameters.declare.declarations import catalogue
from cnc_ptp.parameters.declare.reference import change_text, entry_text, find, reference_markdown

ROOT = Path(__file__).parents[2]
KV = """\
P-AXIS-00099  getriebe[i].kv
  Gain of the proportional position controller.
  list     axis, position controller; axis types TRS
  type     UNS32 (int)
  range    0 < … ≤ 4294967295
  unit     0.01/s
  default  1000
  in 1/s   0 < … ≤ 42949672.95; default 10
  change   CHANGE
  source   spindle p.74""".replace("CHANGE", change_text(catalogue().by_id["P-AXIS-00099"]))


def describe(wanted: str) -> str:
    return "\n\n".join(map(entry_text, find(wanted)))


def test_document_is_up_to_date() -> None:
    """Otherwise: python -m cnc_ptp.parameters.declare.reference > docs/parameters.md"""
    assert (ROOT / "docs" / "parameters.md").read_text(encoding="utf-8") == reference_markdown()


def test_module_prints_the_document() -> None:
    command = [sys.executable, "-m", "cnc_ptp.parameters.declare.reference"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    output = subprocess.run(command, check=True, capture_output=True, env=environment).stdout
    assert output.decode("utf-8") == reference_markdown()


def test_readers_do_not_depend_on_the_folder_of_the_checkout(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    expected = where.readers()
    checkout = tmp_path / "check" / "declare" / "view"
    checkout.mkdir(parents=True)
    (checkout / "cnc_ptp").symlink_to(where.PACKAGE)
    monkeypatch.setattr(where, "PACKAGE", checkout / "cnc_ptp")
    where.readers.cache_clear()
    request.addfinalizer(where.readers.cache_clear)
    assert where.readers() == expected


@pytest.mark.parametrize(
    "name",
    [
        "P-AXIS-00099",
        "p-axis-00099",
        "getriebe[i].kv",
        "getriebe[0].kv",
        "getriebe.0.kv",
        "getriebe.*.kv",
        "kv",
        " kv ",
    ],
)
def test_one_parameter_by_id_or_name(name: str) -> None:
    assert describe(name) == KV


def test_zeros_of_an_id_may_be_left_out() -> None:
    assert describe("p-axis-99") == describe("P-AXIS-099") == describe("P-AXIS-00099")


def test_a_last_part_that_several_have() -> None:
    headlines = [block.splitlines()[0] for block in describe("a_max").split("\n\n")]
    assert headlines == [
        "P-AXIS-00008  getriebe[i].dynamik.a_max",
        "P-AXIS-00240  getriebe[i].beschl_kennlinie.a_max",
        "P-TOOL-00015  wz[i].a_max",
    ]


def test_forms_of_ranges() -> None:
    ranges = {
        "P-AXIS-00209": "range    1 ≤ … ≤ P-AXIS-00212",
        "P-AXIS-00177": "range    -2147483648 ≤ … < P-AXIS-00178",
        "P-CHAN-00008": "range    1 lathe, 2 milling machine; 0 not configured",
        "P-AXIS-00018": "range    ACHSTYP_TRANSLATOR, ACHSTYP_ROTATOR, ACHSTYP_SPINDEL",
        "P-AXIS-00223": "range    flags NONE 0x0, VEL 0x1, ACC 0x2, JERK 0x4, ADD_VEL 0x101, ADD_ACC 0x202, "
        "ADD_JERK 0x804",
        "P-CHAN-00005": "range    at most 16 characters",
        "P-MACH-00022": 'range    S_0_ and four digits; "" not configured',
        "P-CHAN-00053": "range    at most 16 characters, a capital S, then capital letters, digits and _; "
        '"" not configured',
    }
    for number, text in ranges.items():
        assert f"  {text}" in describe(number).splitlines()
    assert "unit     0.1 µm / 0.0001°" in describe("P-AXIS-00177")
    assert "range" not in describe("P-MACH-00005")
    assert "default  []" in describe("P-MACH-00005")
    assert "  Accepted and checked, but without effect in this version." in describe("P-AXIS-00179").splitlines()


@pytest.mark.parametrize(
    ("number", "lines"),
    [
        (
            "P-AXIS-00209",
            [
                "in mm/s  0.001 ≤ … ≤ P-AXIS-00212; default 166.666",
                "in °/s   0.001 ≤ … ≤ P-AXIS-00212; default 166.666",
            ],
        ),
        ("P-AXIS-00217", ["in %     0 ≤ … ≤ 100; default 10"]),
        ("P-AXIS-00389", ["in s     0 ≤ … ≤ 0.065535; default 0"]),
        (
            "P-AXIS-00178",
            [
                "in mm    P-AXIS-00177 < … ≤ 214748.3647; default 10000",
                "in °     P-AXIS-00177 < … ≤ 214748.3647; default 10000",
            ],
        ),
        ("P-AXIS-00001", []),
        ("P-AXIS-00223", []),
    ],
)
def test_ranges_in_the_units_of_people(number: str, lines: list[str]) -> None:
    found = [line.strip() for line in describe(number).splitlines() if line.startswith("  in ")]
    assert found == lines


def test_drive_types_versions_and_times_of_change_are_lines_of_their_own() -> None:
    assert "  drives   SERCOS, CANopen" in describe("P-AXIS-00522").splitlines()
    assert "  since    V3.1.3079.06" in describe("P-COMP-00062").splitlines()
    assert "  change   at start-up only (as the manual has it)" in describe("P-COMP-00062").splitlines()


def test_drive_types_are_as_the_control_document_has_them() -> None:
    """Each decides telegram and formats, none is warned about."""
    text = "which decides the cyclic telegram and its formats; the drive behind it is simulated."
    assert text in " ".join(describe("P-AXIS-00020").split())
    for kind in catalogue().by_id["P-AXIS-00020"].choices:
        machine = f"/machine: {{ros__parameters: {{axes: [x]}}}}\n/x: {{ros__parameters: {{kenngr.antr_typ: {kind}}}}}"
        assert not [line for line in load_machine(machine, "m.yaml").warnings if "P-AXIS-00020" in str(line)]


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("P-AXIS-000999", "; did you mean P-AXIS-00099 getriebe[i].kv?"),
        ("getribe.0.kv", "; did you mean P-AXIS-00099 getriebe[i].kv?"),
        ("!", ""),
    ],
)
def test_unknown_parameter(name: str, hint: str) -> None:
    with pytest.raises(CncError) as caught:
        describe(name)
    assert str(caught.value) == f"P-ERR-25018 no parameter is called '{name}'{hint}"


def test_every_parameter_has_its_line() -> None:
    document = reference_markdown()
    for declaration in catalogue().by_id.values():
        assert document.count(f"\n| {declaration.id} | `{declaration.name}` |") == 1
