"""docs/nc_language.md and `cnc_ptp explain`: every word has its text, every example is a program."""

import re
from functools import cache

import pytest
from nc_support import HERE, run

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.commands.language.explain import explain
from cnc_ptp.commands.language.grammar import grammar, grammar_json
from cnc_ptp.commands.language.reference import GENERAL, reference_markdown
from cnc_ptp.commands.language.word_errors import error_texts, errors_by_key, faults_in
from cnc_ptp.commands.language.words import entries, explanations, find
from cnc_ptp.errors import CncError
from cnc_ptp.machine.program_files import SHIPPED
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.statement_reader import KEYWORDS
from cnc_ptp.nc.gears import GEAR_M
from cnc_ptp.nc.hash_commands import COMMANDS, STATEMENTS
from cnc_ptp.nc.iso import iso_faults
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.vocabularies import VOCABULARIES
from cnc_ptp.nc.vocabulary import TWINCAT
from cnc_ptp.parameters import read_machine

DOCS = HERE.parents[1] / "docs"
TEXTS = explanations()


def test_grammar_is_up_to_date():
    assert (DOCS.parent / "tools" / "nc.tmLanguage.json").read_text(encoding="utf-8") == grammar_json()


@pytest.mark.parametrize(
    ("text", "scope"),
    [("G01", "storage.type.g.nc"), ("#CS ON", "keyword.other.command.nc"), ("$ELSEIF P1", "keyword.control.nc"),
     ("SIN[30]", "support.function.nc"), ("V.P.A", "variable.other.nc"), ("O1234", "entity.name.function.program.nc"), ("G54.1", "storage.type.g.nc"), ("N10:", "entity.name.tag.block.nc"),
     ("; note", "comment.line.semicolon.nc"), ('"text"', "string.quoted.double.nc"), ("12.5", "constant.numeric.nc"),
     ("% NAME", "entity.name.function.nc"), ("LL POCKET", "entity.name.function.call.nc"), ("M30", "storage.type.m.nc")],
)  # fmt: skip
def test_the_first_rule_of_the_grammar_that_fits_is_the_right_one(text, scope):
    rules = [rule for rule in grammar()["patterns"] if "match" in rule]
    assert next(rule["name"] for rule in rules if re.match(rule["match"], text)) == scope


def test_document_is_up_to_date():
    assert (DOCS / "nc_language.md").read_text(encoding="utf-8") == reference_markdown()


def test_every_word_has_a_text_and_no_text_is_left_over():
    assert set(TEXTS["G function"]) == set(TWINCAT.g_codes)
    assert set(TEXTS["M function"]) == set(TWINCAT.m_codes) | set(GEAR_M)
    assert set(TWINCAT.value_words) <= set(TEXTS["word"])
    ends = {"ENDVAR", "COMMENT END"}
    assert set(TEXTS["command"]) == (set(COMMANDS) | set(STATEMENTS)) - ends
    divided = " ".join(row.syntax for row in TEXTS["control statement"].values())
    assert all(keyword in divided for keyword in KEYWORDS)


def test_the_document_of_iso_is_up_to_date():
    assert (DOCS / "iso_language.md").read_text(encoding="utf-8") == reference_markdown("iso")


def test_every_word_of_iso_has_a_text_and_no_text_is_left_over():
    texts = explanations("iso")
    assert {float(number) for number in texts["G function"]} == set(ISO.g_codes)
    assert set(texts["M function"]) == set(ISO.m_codes)
    assert set(ISO.value_words) <= set(texts["word"])


@pytest.mark.parametrize("code", [code for code in ISO.g_codes.values() if code.later], ids=lambda code: code.name)
def test_what_comes_later_in_iso_is_refused(code):
    with pytest.raises(ProgramError, match=rf"{code.name} is not available yet"):
        run(code.name, dialect="iso")
    assert find(code.name, "iso")[0].later


def test_words_of_iso_are_explained(capsys):
    explain(["g54.1", "G98"], "iso")
    assert capsys.readouterr().out == (
        "G54.1 (G function)\n  syntax:   G54.1 Pn\n  meaning:  Zero offset 6 + n, n from 1 to 90.\n"
        "  group:    zero offset, modal\n  example:  G54.1 P2 G0 X0.\n"
        "  errors:   21806 …… must be an integer from … to …\n            21807 … without …: …\n\n"
        "G98 (G function)\n  syntax:   G98\n"
        "  meaning:  Cycles return to the level before the cycle, if it is above R; so at the start.\n"
        "  group:    return level, modal\n  example:  G98\n"
    )


def test_errors_of_iso_are_explained(capsys):
    explain(["G53"], "iso")
    assert capsys.readouterr().out.splitlines()[-3:] == [
        "  errors:   21602 … without an axis",
        "            21808 G53 moves with G00 or G01 only",
        "            21809 G53 with G91: positions in machine coordinates are absolute; G90 first",
    ]


def test_an_example_of_several_lines(capsys):
    explain(["$DO"])
    assert (
        "  example:  P1 = 0\n            $DO\n            P1 += 1\n            $ENDDO P1 < 5\n"
        in capsys.readouterr().out
    )


FILES = {
    "drill.nc": "P1 = V.G.@P[1].VALID\nZ[@P1]\nM29",
    "pocket.nc": "M29",
    **{path.name: path.read_text(encoding="utf-8") for path in SHIPPED.glob("*.nc")},
}
"""What the examples call."""
MACHINES = {
    "config/lathe.yaml": ("G51", "G96", "#CAX", "#CAX OFF", "#FACE", "#FACE OFF", "#CYL", "#CYL OFF"),
    "examples/probe.yaml": ("G100", "G31", "V.A.MESS", "V.A.MERF", "V.A.MOFFS", "V.A.MEAS"),
    "examples/spindles/gears_programmed.yaml": ("M40", "M41", "M42", "M43"),
    "examples/spindles/gears.yaml": ("M44", "M45"),
    "examples/spindles/three_spindles.yaml": (
        *("#SET AX LINK", "#AX LINK", "#ENABLE AX LINK", "#AX LINK ON", "#DISABLE AX LINK", "#AX LINK OFF"),
    ),
}
"""Machines of the examples that config/mill.yaml cannot run."""
WITH_TOOLS = ("G40", "G41", "G42", "D", "H")
"""Of iso: they need a tool table with lengths and radii."""


@cache
def check_of(machine: str) -> ProgramCheck:
    return ProgramCheck.of_first_channel(read_machine(DOCS.parent / machine), "example.nc")


@pytest.mark.parametrize("dialect", VOCABULARIES)
def test_every_entry_has_an_example_unless_it_comes_later(dialect):
    assert [entry.name for entry in entries(dialect) if bool(entry.explanation.example) == bool(entry.later)] == []


@pytest.mark.parametrize(
    ("dialect", "entry"),
    [(dialect, entry) for dialect in VOCABULARIES for entry in entries(dialect) if entry.explanation.example],
    ids=lambda value: getattr(value, "name", value),
)
def test_every_example_is_a_program_of_a_shipped_machine(dialect, entry):
    machine = next((name for name, words in MACHINES.items() if entry.name in words), "config/mill.yaml")
    if dialect == "iso" and entry.name in WITH_TOOLS:
        machine = "config/lathe.yaml"
    example = entry.explanation.example
    text = example if {"M30", "M02", "M2"} & set(example.split()) else f"{example}\nM30"
    assert check_of(machine).errors(f"{text}\n", "example.nc", FILES, VOCABULARIES[dialect]) == []


def test_the_first_word_of_several_commands_explains_all_of_them():
    names = [entry.name for entry in find("#TIMER")]
    assert names[:3] == ["#TIMER START", "#TIMER START SYN", "#TIMER STOP"]
    assert all(name.startswith("#TIMER ") for name in names) and len(names) == 8
    assert [entry.name for entry in find("#flush")] == ["#FLUSH"]


@pytest.mark.parametrize("number", [code.number for code in TWINCAT.g_codes.values() if code.later])
def test_what_comes_later_is_refused_and_explained(number, capsys):
    with pytest.raises(ProgramError, match=f"G{number} is not available yet"):
        run(f"G{number}")
    explain([f"G{number}"])
    assert "not available yet: a program with it is refused when it is read" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("typed", "name"),
    [("g1", "G01"), ("G001", "G01"), ("m3", "M03"), ("G159=3", "G159"), ("for", "$FOR"), ("#cs", "#CS"), ("cs", "#CS"),
     ("flush  wait", "#FLUSH WAIT"), ("atan2", "ATAN2"), ("v.a.abs", "V.A.ABS"), ("l cycle", "L CYCLE"), ("pi", "PI"),
     ("M41", "M41"), ("m6", "M06"), ("M1234", "M1234"), ("mod", "MOD"), ("and", "AND"), ("or", "OR"), ("xor", "XOR"), ("not", "NOT"),
     ("#HSC ON", "#HSC"), ("#cs def", "#CS"), ("V.A.ACT_POS", "V.A.ACT_POS"), ("v.a.act_pos.x", "V.A.ACT_POS"), ("V.G.NP[1].V.X", "V.G.NP"),
     ("V.RTG.OVERRIDE.VEL.TOTAL", "V.RTG.OVERRIDE")],
)  # fmt: skip
def test_words_are_found_as_people_type_them(typed, name):
    assert [entry.name for entry in find(typed)] == [name]


def test_an_explanation(capsys):
    explain(["G54", "V.G.NP"])
    assert capsys.readouterr().out == (
        "G54 (G function)\n"
        "  syntax:   G54\n"
        "  meaning:  Zero offset 1; it acts with the next absolute word of each axis.\n"
        "  group:    zero offset, modal\n"
        "  example:  G54 G00 X0\n"
        "  errors:   21052 … takes no value\n"
        "\n"
        "V.G.NP (readable state)\n"
        "  syntax:   V.G.NP[<index>].V.<axis>\n"
        "  meaning:  zero offset of an index and an axis; can be assigned\n"
        "  example:  V.G.NP[1].V.X = 20\n"
        "            G54 G00 X0\n"
        "  errors:   21435 the channel has no … …; it has: …\n"
        "            21439 '…' is not complete or has too much: it is written …\n"
        "            21600 zero offset … does not exist: …=0 to …=…\n"
        "            21622 …: G53 selects no zero offset, so that index 0 has no values (P-ZERO-00001)\n"
    )


def test_each_error_belongs_to_a_word_and_each_key_is_one():
    assert {number for numbers in errors_by_key().values() for number in numbers} == set(error_texts())
    words = {entry.name for entry in entries()} | {entry.kind for entry in entries()} | set(GENERAL)
    assert [word for key in errors_by_key() for word in key.split(", ") if word not in words] == []


def test_each_error_of_iso_belongs_to_a_word_and_each_key_is_one():
    listed = errors_by_key("iso")
    numbers = {number for row in listed.values() for number in row}
    assert numbers == set(error_texts("iso"))
    assert {fault.number for fault in faults_in(iso_faults)} <= numbers
    words = {entry.name for entry in entries("iso")} | set(GENERAL)
    assert [word for key in listed for word in key.split(", ") if word not in words] == []


def test_codes_that_stand_alone_are_their_own_example():
    assert find("G17")[0].explanation.example == "G17" and find("G106")[0].explanation.example == ""


def test_an_unknown_word():
    with pytest.raises(CncError) as refused:
        find("SINUS")
    assert str(refused.value) == "P-ERR-26123 'SINUS' is no word of the NC language; did you mean SIN or SIGN or ASIN?"
