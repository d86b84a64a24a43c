"""Every list that the manuals print, typed in by hand, is read without an unknown line, and with the printed values."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lists_support import imported, values

from cnc_ptp.parameters.lists.importing import Imported

LISTS = Path(__file__).parent / "manual_lists"
FILES = {
    "axis": "achs_mds_x.lis",
    "spindle": "achs_mds_s.lis",
    "channel": "sda_mds_channel.lis",
    "tool": "werkz_data_channel.lis",
    "compensation": "achs_kw_x.lis",
}
NODES = {"axis": "x", "spindle": "s", "channel": "channel", "tool": "channel", "compensation": "x"}
EXAMPLES = sorted({path.name.split(".")[0] for path in LISTS.glob("*.lis")})
WRITTEN = {
    "achs_typ": "kenngr.achs_typ",
    "achs_mode": "kenngr.achs_mode",
    "antr_typ": "kenngr.antr_typ",
    "koppelgruppe[0]": "synchro_data.koppel_gruppe[0]",
    "beschl_kennlinie": "getriebe[0].beschl_kennlinie",
    "getriebe[]": "getriebe[0]",
    "spindle[0]": "spindel[0]",
    "log_achs_no": "log_achs_nr",
    "spindel[i]": "spindel[0]",
    "wz[i]": "wz[0]",
}
"""What the manuals shorten or spell in another way, and what they mean."""
TYPES = {"0x0004": "ACHSTYP_SPINDEL", "0x00004": "ACHSTYP_SPINDEL"}
SYNCHRONISATION = {1: "MOS", 2: "MVS_SVS", 4: "MVS_SNS", 8: "MNS_SNS", 0x20002: "MVS_SVS | PLC_INFO"}
SYNCHRONISATION[0x20004] = "MVS_SNS | PLC_INFO"
FEEDFORWARD = {"0x101": "ADD_VEL", "0x202": "ADD_ACC"}


def example(name: str) -> dict[str, str]:
    """The lists of an example, by the kinds of the list."""
    kinds = (path.name.split(".")[1] for path in LISTS.glob(f"{name}.*"))
    return {kind: (LISTS / f"{name}.{kind}.lis").read_text(encoding="utf-8") for kind in kinds}


def read(lists: dict[str, str]) -> Imported:
    """An example, with an empty list for the axis or channel that its lists are for."""
    files = {FILES[kind]: text for kind, text in lists.items()}
    if "spindle" in lists and "achs_typ" not in lists["spindle"]:
        files[FILES["spindle"]] = "kenngr.achs_typ ACHSTYP_SPINDEL\n" + lists["spindle"]
    if "compensation" in lists:
        files[FILES["axis"]] = "kopf.achs_nr 1\n"
    if "tool" in lists:
        files[FILES["channel"]] = ""
    return imported(files, incomplete=True, strict=True)


def printed_values(text: str) -> dict[str, str]:
    """ROS name -> value as it is printed: the first word of a line, and what follows up to a blank."""
    found = {}
    for line in text.splitlines():
        words = line.replace(" | ", "|").split()
        if len(words) >= 2 and not line.startswith(("#", " ", ":", ".")):
            name = words[0]
            for short, whole in WRITTEN.items():
                begin = "^" if whole.endswith(short) else r"(?:^|(?<=\.))"
                name = re.sub(rf"{begin}{re.escape(short)}(?=\.|$)", whole, name)
            found[re.sub(r"\[(\d+)\]", r".\1", name)] = words[1]
    return found


def meant(name: str, printed: str) -> object:
    """The value that a printed one means."""
    last = name.rpartition(".")[2]
    if last == "achs_typ":
        return TYPES[printed]
    if last == "vorsteuerung":
        return FEEDFORWARD[printed]
    if last.endswith("_synch") or name.startswith("m_synch"):
        names = {"PLC_INFO": 0x20000, **{text: number for number, text in SYNCHRONISATION.items() if "|" not in text}}
        parts = [names[part] if part in names else int(part, 0) for part in printed.split("|")]
        return SYNCHRONISATION[sum(parts)]
    try:
        return int(printed, 0)
    except ValueError:
        pass
    try:
        return float(printed)
    except ValueError:
        return printed


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_printed_list_is_read(name: str) -> None:
    lists = example(name)
    result = read(lists)
    assert result.report.of("unknown") == []
    for kind, text in lists.items():
        of_node = values(result.sets[NODES[kind]])
        for parameter, printed in printed_values(text).items():
            assert of_node[parameter] == meant(parameter, printed), parameter


def test_all_examples_are_here() -> None:
    assert len(EXAMPLES) == 42
    assert sum(len(printed_values(text)) for name in EXAMPLES for text in example(name).values()) == 233


WHOLE = {
    "spindle_p11_nc_spindle": ("", ()),
    "spindle_p13_plc_spindle": ("", ()),
    "spindle_p15_main_spindle": ("spdl_anzahl 3\n", (10, 11, 12)),
    "spindle_p21_channel_1": ("", (6, 11, 30)),
    "spindle_p21_channel_2": ("", (6, 11)),
    "spindle_p65_three_spindles": ("", (6, 11, 30)),
    "friction_p14": ("", ()),
}
"""Examples that make a machine, with what the manual says in words: further lines, spindles by their numbers."""


@pytest.mark.parametrize("name", WHOLE)
def test_an_example_that_is_whole_makes_a_machine(name: str) -> None:
    more, spindles = WHOLE[name]
    lists = example(name)
    files = {FILES[kind]: text + (more if kind == "channel" else "") for kind, text in lists.items()}
    files |= {f"achs_mds_s{number}.lis": f"kopf.achs_nr {number}\nachs_typ 4\n" for number in spindles}
    if "compensation" in lists:
        files[FILES["axis"]] = "kopf.achs_nr 1\n"
    assert imported(files).report.of("unknown") == []


def test_a_tool_list_with_explanations_in_brackets_is_read() -> None:
    """The form that the vendor's configuration tool writes: name, value, an opening bracket and a text."""
    text = "kopf.achs_nr 1\ngetriebe[0].vb_eilgang\t100000        ( P-AXIS-00209 : [um/s] rapid traverse\n"
    result = imported({"achs_mds_x.lis": text}, strict=True)
    assert values(result.sets["x"])["getriebe.0.vb_eilgang"] == 100000
    assert "getriebe.0.vb_eilgang: 100000  # ( P-AXIS-00209 : [um/s] rapid traverse" in result.text
