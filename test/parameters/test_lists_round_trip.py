"""Machine -> lists -> machine: every value, comment and unknown line comes back; and a run is the same to the bit."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lists_support import SMALL, as_bytes, imported, values
from long_support import examples
from machine_support import ROOT, MachineBench
from replay_support import bits

from bench.lists import lists_of
from cnc_ptp.parameters import MachineParameters, ParameterError, load_machine, machine_text, read_machine
from cnc_ptp.parameters.declare.declarations import Declaration, catalogue
from cnc_ptp.parameters.lists.exporting import export_lists
from cnc_ptp.parameters.lists.importing import Imported, import_lists
from cnc_ptp.parameters.lists.lines import comment_text
from cnc_ptp.parameters.lists.problems import ListError
from cnc_ptp.parameters.lists.text import FOREIGN

MACHINES = sorted([*(ROOT / "config").glob("*.yaml"), *(ROOT / "examples" / "spindles").glob("*channels.yaml")])
SETTINGS = settings(
    max_examples=examples(60),
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)
BY_FILE = ("werkz_data", "nullp_data", "pzv_data")
"""Their files become lists, whose values are those of the channel."""


def back(text: str, file: str = "m.yaml") -> Imported:
    return imported(export_lists(text, file))


def all_values(machine: MachineParameters | Imported) -> dict[str, dict[str, object]]:
    found = {node: values(parameters) for node, parameters in machine.sets.items()}
    return {
        node: {name: value for name, value in of_node.items() if name not in BY_FILE} for node, of_node in found.items()
    }


@pytest.mark.parametrize("path", MACHINES, ids=lambda path: path.name)
def test_a_machine_comes_back(path: Path) -> None:
    text = machine_text(path)
    result = back(text, str(path))
    assert all_values(result) == all_values(load_machine(text, str(path)))
    assert result.report.of("unknown") == result.report.of("corrected") == []


@pytest.mark.parametrize("path", MACHINES, ids=lambda path: path.name)
def test_the_lists_of_lists_are_the_same(path: Path) -> None:
    lists = export_lists(machine_text(path), str(path))
    assert export_lists(imported(lists).text, "m.yaml") == lists


@pytest.mark.parametrize("path", MACHINES, ids=lambda path: path.name)
def test_every_comment_comes_back(path: Path) -> None:
    """The comments of a machine file, found without its reader: none of these files has a # in a text."""
    lines = path.read_text(encoding="utf-8").splitlines()
    comments = [comment_text("#" + line.partition("#")[2]) for line in lines if "#" in line]
    written = "\n".join(export_lists(machine_text(path), str(path)).values())
    assert [comment for comment in comments if f"# {comment}\n" not in written] == []


def test_what_a_list_has_besides_values_comes_out_again() -> None:
    content = (
        "# *** axis ***\n"
        "kopf.achs_nr 1 # number\n"
        "\n"
        "#\n"
        "handbetrieb.hb.vb_max   60000  # manual\n"
        "getriebe[0].kv 0x10 first | second\n"
        "beg getriebe[0]\n"
        "  what[3] 5\n"
        "end\n"
        "#? no unknown line\n"
        "#: axis list other.lis\n"
        "# end"
    )
    lists = export_lists(imported({"achsmds_x.lis": content}).text, "m.yaml")
    assert [" ".join(line.split()) for line in lists["achsmds_x.lis"].splitlines()] == [
        "# *** axis ***",
        "kopf.achs_nr 1 # number",
        "",
        "#",
        "handbetrieb.hb.vb_max 60000 # manual",
        "getriebe[0].kv 0x10 # first | second",
        "getriebe[0].what[3] 5",
        "# ? no unknown line",
        "# : axis list other.lis",
        "# end",
    ]


def test_comments_go_with_the_values_below_them() -> None:
    text = (
        "# the machine\n"
        "/machine: {ros__parameters: {axes: [x]}}  # one axis\n"
        "\n"
        "# the axis\n"
        "/x:\n"
        "  ros__parameters:\n"
        "    # friction\n"
        "    frict_comp:  # a table\n"
        "      scaling_factor: 5\n"
        "    # gear\n"
        "    getriebe.0: {kv: 7, load: 2}  # both\n"
        "    # last\n"
    )
    lists = export_lists(text, "m.yaml")
    compensation = [" ".join(line.split()) for line in lists["achs_kw_x.lis"].splitlines()]
    assert compensation == ["kopf.achs_nr 1", "# the axis", "# friction", "# a table", "frict_comp.scaling_factor 5"]
    axis = [" ".join(line.split()) for line in lists["achs_mds_x.lis"].splitlines()]
    assert axis == ["kopf.achs_nr 1", "# gear", "getriebe[0].kv 7", "getriebe[0].load 2 # both", "# last"]
    startup = [" ".join(line.split()) for line in lists["hochlauf.lis"].splitlines()]
    assert startup[:2] == ["# the machine", "# one axis"]


def test_texts_of_several_lines_hold_no_comments() -> None:
    text = (
        "/machine: {ros__parameters: {channels: [c]}}\n"
        "/c:\n"
        "  ros__parameters:\n"
        "    wz.1.name: 'a  # b\n"
        "      # c'  # comment\n"
        "    wz.2.name: >-\n"
        "      d # e\n"
        "    wz.1.radius: 5  # f\n"
    )
    lines = [" ".join(line.split()) for line in export_lists(text, "m.yaml")["werkz_data_c.lis"].splitlines()]
    assert lines == ['wz[1].name "a # b # c"', "# comment", 'wz[2].name "d # e"', "wz[1].radius 5 # f"]


def test_files_keep_their_names_unless_two_have_the_same() -> None:
    result = imported({**{f"my_{name}": text for name, text in SMALL.items()}})
    assert {"my_achs_mds_x.lis", "my_achs_mds_s.lis", "my_sda_mds_channel.lis"} < set(
        export_lists(result.text, "m.yaml")
    )
    text = result.text.replace("my_achs_mds_s.lis", "my_achs_mds_x.lis").replace("my_sda_mds_channel.lis", "../x.lis")
    assert set(export_lists(text, "m.yaml")) == {
        "hochlauf.lis", "my_achs_mds_x.lis", f"achs_mds_{list(result.sets)[-1]}.lis", f"sda_mds_{list(result.sets)[1]}.lis",
    }  # fmt: skip


def test_offsets_and_tools_of_other_files_become_lists(tmp_path: Path) -> None:
    channel = {
        "gruppe.0.achse.0.log_achs_nr": 1,
        "nullp_data": "zero.yaml",
        "pzv_data": "clamp.yaml",
        "werkz_data": "t.yaml",
    }
    machine = tmp_path / "m.yaml"
    lines = "".join(f"    {name}: {value}  # {name}\n" for name, value in channel.items())
    machine.write_text("/machine: {ros__parameters: {channels: [c], axes: [x]}}\n/c:\n  ros__parameters:\n" + lines)
    (tmp_path / "zero.yaml").write_text(
        "G54: {name: left vice, X: 12.5}\nG159=7: {X: -1, inactive: [X]}\ndefault: G54\n"
    )
    (tmp_path / "clamp.yaml").write_text("3: {X: 0.25}\n")
    (tmp_path / "t.yaml").write_text("5: {name: drill, type: drill, length: 40, offsets: {X: 1}}\n")
    text = machine_text(machine)
    lists = export_lists(text, str(machine))
    zero = [" ".join(line.split()) for line in lists["nullp_data_c.lis"].splitlines()]
    assert zero == [
        "default_index 1",
        'np_grp[1].bezeichnung "left vice"',
        "np_grp[1].achse[0].versch 125000",
        "np_grp[7].achse[0].versch -10000",
        "np_grp[7].achse[0].inaktiv 1",
    ]
    assert "pzv_grp[3].achse[0].versatz 2500" in " ".join(lists["pzv_data_c.lis"].split())
    assert "wz[5].laenge 400000" in " ".join(lists["werkz_data_c.lis"].split())
    assert {"# nullp_data", "# pzv_data", "# werkz_data"} <= set(lists["sda_mds_c.lis"].splitlines())
    assert all_values(imported(lists)) == all_values(load_machine(text, str(machine)))


def test_a_node_may_be_called_as_its_user_likes() -> None:
    text = imported().text.replace("/x:", "/xq:").replace("[x]", "[xq]")
    assert list(back(text).sets) == ["machine", "channel", "xq", "s"]


def of_axes(declaration: Declaration) -> bool:
    return declaration.belongs_to("axis") and declaration.axes != "" and "T" in declaration.axes


AXIS = [entry for entry in catalogue().by_id.values() if of_axes(entry)]
TEXTS = st.text(st.characters(codec="utf-8"), max_size=20).filter(lambda text: not FOREIGN.search(text))


@st.composite
def entries(draw: st.DrawFn, declarations: list[Declaration]) -> tuple[str, str, str]:
    """Name, value and comment in a machine file; the value fits the declaration by itself."""
    entry = draw(st.sampled_from(declarations))
    name = entry.ros_name(tuple(draw(st.integers(0, 5)) for _ in range(entry.index_count)))
    if entry.choices and entry.type != "string":
        value = str(draw(st.sampled_from(list(entry.choices))))
    elif entry.choices:
        value = draw(st.sampled_from(list(entry.choices)))
    elif entry.type in ("int", "float"):
        lower = max((limit.value for limit in entry.lower if not isinstance(limit.value, str)), default=-1000)
        upper = min((limit.value for limit in entry.upper if not isinstance(limit.value, str)), default=1000)
        value = repr(draw(st.integers(int(lower), int(upper)) if entry.type == "int" else st.floats(lower, upper)))
    elif entry.type == "bool":
        value = draw(st.sampled_from(["0", "1", "true", "off"]))
    elif entry.type == "strings":
        value = f"[{', '.join(map(quoted, draw(st.lists(TEXTS, max_size=3))))}]"
    else:
        value = quoted(draw(TEXTS))
    return name, value, draw(TEXTS)


def quoted(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"


TOOLS = [entry for entry in catalogue().by_id.values() if entry.list_name in ("tool", "zero", "clamp", "channel")]


@SETTINGS
@given(st.lists(entries(AXIS), max_size=12), st.lists(entries(TOOLS), max_size=8), st.lists(TEXTS, max_size=3))
def test_a_random_machine_comes_back(axis: list, channel: list, unknown: list[str]) -> None:
    text = "/machine: {ros__parameters: {channels: [c], axes: [x]}}\n"
    for node, given_values in (("x", axis), ("c", channel)):
        text += (
            f"/{node}:\n  ros__parameters:\n    #: axis list a.lis\n"
            if node == "x"
            else f"/{node}:\n  ros__parameters:\n"
        )
        for name, value, comment in {entry[0]: entry for entry in given_values}.values():
            line = f"    {name}: {value}  # {comment}\n"
            try:
                load_machine(text + line, "m.yaml")
            except ParameterError:
                continue
            text += line
        text += "".join(f"    #? {line}\n" for line in unknown) if node == "x" else ""
    result = back(text)
    assert all_values(result) == all_values(load_machine(text, "m.yaml"))
    again = back(result.text)
    assert all_values(again) == all_values(result)
    assert again.text == result.text


@SETTINGS
@given(
    st.dictionaries(
        st.sampled_from([*SMALL, "hochlauf.lis", "werkz_data_1.lis", "achs_kw_x.lis"]), st.binary(max_size=80)
    )
)
def test_any_bytes_are_read_or_refused(files: dict[str, bytes]) -> None:
    read_or_refused(files)
    read_or_refused({**as_bytes(SMALL), **files})


@SETTINGS
@given(st.sampled_from(sorted(SMALL)), st.integers(0, 300), st.text(max_size=8), st.integers(0, 8))
def test_a_list_with_a_slip_is_read_or_refused(name: str, place: int, slip: str, cut: int) -> None:
    text = SMALL[name]
    changed = text[:place] + slip + text[place + cut :]
    read_or_refused(as_bytes({**SMALL, name: changed.encode("utf-8", "replace").decode()}))


def read_or_refused(files: dict[str, bytes]) -> None:
    """Any files are a machine that a node accepts, or ListError says why, each time with a place."""
    try:
        result = import_lists("f", files)
    except ListError as error:
        assert all(
            line.startswith("P-ERR-") and line.endswith("; nothing was written") for line in str(error).splitlines()
        )
        return
    load_machine(result.text, "m.yaml")
    export_lists(result.text, "m.yaml")


def test_the_lists_of_the_mill_are_those_of_its_machine_file() -> None:
    """Otherwise: cnc_ptp lists export config/mill.yaml -o examples/lists --force"""
    folder = ROOT / "examples" / "lists"
    written = {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()}
    mill = ROOT / "config" / "mill.yaml"
    assert written == export_lists(machine_text(mill), str(mill))


@pytest.mark.long
def test_the_mill_of_lists_runs_as_the_mill(tmp_path: Path) -> None:
    files = {path.name: path.read_bytes() for path in (ROOT / "examples" / "lists").iterdir()}
    path = tmp_path / "mill.yaml"
    path.write_text(import_lists("examples/lists", files, strict=True).text, encoding="utf-8")
    program = (ROOT / "examples" / "bracket.nc").read_text(encoding="utf-8")
    machines = (read_machine(path), read_machine(ROOT / "config" / "mill.yaml"))
    of_lists, of_file = (bits(MachineBench(program, machine=machine).run(4.0)) for machine in machines)
    assert of_lists == of_file


@pytest.mark.long
def test_a_large_machine_comes_back() -> None:
    files = lists_of(32, 16)
    first = import_lists("f", files, strict=True)
    assert len(first.sets) == 1 + 1 + 32 + 16
    lists = export_lists(first.text, "m.yaml")
    again = imported(lists, strict=True)
    assert all_values(again) == all_values(first)
    assert len(first.report.of("read")) == sum(line.count(b"\n") for line in files.values()) - 48
    assert {name: text.encode() for name, text in lists.items() if name.startswith("achs_mds")} == {
        name: text for name, text in files.items() if name.startswith("achs_mds")
    }
