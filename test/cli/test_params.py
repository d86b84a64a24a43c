"""`cnc_ptp params`: what a part of a name, a number, a word and nothing at all find; what fits a terminal."""

import pytest
from commands_support import call

from cnc_ptp.commands.look.params import group_lines, hit_lines
from cnc_ptp.parameters.declare.declarations import catalogue
from cnc_ptp.parameters.declare.reference import find


def ids(*words):
    return [entry.id for entry in find(" ".join(words))]


def test_one_hit_is_shown_in_full():
    for words in (["P-AXIS-00099"], ["p-axis-00099"], ["99"], ["kv"], ["getriebe[0].kv"], ["getriebe.0.kv"]):
        done = call("params", *words)
        assert done.exit_code == 0
        assert done.output.splitlines()[0] == "P-AXIS-00099  getriebe[i].kv"
        assert "  unit     0.01/s" in done.output.splitlines()


@pytest.mark.parametrize(
    ("words", "first", "among"),
    [
        (["frict"], "P-AXIS-00522", {"P-COMP-00041", "P-COMP-00062", "P-SIM-00012"}),
        (["following"], "P-AXIS-00236", {"P-AXIS-00168", "P-AXIS-00169"}),
        (["FOLLOWING", "standstill"], "P-AXIS-00172", {"P-AXIS-00169"}),
        (["8"], "P-AXIS-00008", {"P-CHAN-00008", "P-SIM-00008", "P-MACH-00008"}),
        (["P-TOOL"], "P-TOOL-00001", {"P-TOOL-00015"}),
        (["a_max"], "P-AXIS-00008", {"P-TOOL-00015"}),
        (["vorsteuer."], None, {"P-AXIS-00223"}),
    ],
)
def test_several_hits_are_a_line_each(words, first, among):
    found = ids(*words)
    assert first is None or found[0] == first
    assert among <= set(found)
    lines = call("params", *words).output.splitlines()
    if len(found) > 1:
        assert lines[0].split() == ["id", "name", "meaning"]
        assert [line.split()[0] for line in lines[1:]] == found


def test_what_is_found_is_what_a_search_by_hand_finds():
    """Each hit has all words; nothing that has them is left out."""
    entries = {entry.id: f"{entry.id} {entry.name} {entry.text}".lower() for entry in catalogue().by_id.values()}
    for words in ("friction", "soft limit", "spindle gear", "spindel"):
        assert set(ids(words)) == {n for n, text in entries.items() if all(word in text for word in words.split())}


def test_names_come_before_texts():
    found = find("frict")
    named = ["frict" in f"{entry.id} {entry.name}".lower() for entry in found]
    assert named == sorted(named, reverse=True) and not all(named)


def test_nothing_found_is_status_2_with_the_nearest_names():
    done = call("params", "slep_mxa")
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.startswith(
        "P-ERR-25018 no parameter is called 'slep_mxa'; did you mean P-AXIS-00168 getriebe[i].slep_max"
    )
    assert call("params", "!!").stderr == "P-ERR-25018 no parameter is called '!!'\n"


@pytest.mark.parametrize("width", [60, 80, 200])
def test_lines_fit_the_terminal(width):
    everything = list(catalogue().by_id.values())
    for lines in (list(group_lines(everything, width)), list(hit_lines(find("frict"), width))):
        assert max(map(len, lines)) <= width
        assert width == 200 or any(line.endswith("…") for line in lines)


def test_without_a_word_the_groups_are_shown():
    done = call("params")
    assert done.exit_code == 0
    lines = done.output.splitlines()
    assert len(lines) <= 38
    counted = [line.split() for line in lines[1:-2]]
    assert sum(int(next(word for word in words[1:] if word.isdecimal())) for words in counted) == len(catalogue().by_id)
    assert {words[0] for words in counted} == {
        "P-AXIS",
        "P-CHAN",
        "P-COMP",
        "P-TOOL",
        "P-STUP",
        "P-ZERO",
        "P-CLMP",
        "P-SIM",
        "P-MACH",
    }
