"""docs/nc_language.md and `cnc_ptp explain`: every word has its text, every example is a program."""

import re

import pytest
from nc_support import FACING, HERE, TABLES, run

from cnc_ptp.commands.language.explain import explain
from cnc_ptp.commands.language.grammar import grammar, grammar_json
from cnc_ptp.commands.language.reference import GENERAL, reference_markdown
from cnc_ptp.commands.language.word_errors import error_texts, errors_by_key
from cnc_ptp.commands.language.words import entries, explanations, find
from cnc_ptp.errors import CncError
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.statement_reader import KEYWORDS
from cnc_ptp.nc.flow.structures import CLOSING
from cnc_ptp.nc.gears import GEAR_M
from cnc_ptp.nc.hash_commands import COMMANDS, STATEMENTS
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.vocabulary import TWINCAT

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


@pytest.mark.parametrize(
    "entry", [entry for entry in entries("iso") if entry.explanation.example], ids=lambda entry: entry.name
)
def test_every_example_of_iso_is_a_program(entry):
    example = entry.explanation.example.replace(" G86", "\nG86")
    run(f"F500\nG0\n{example}\nM30\nO100\nM99", dialect="iso", turning_axes=FACING["X"])


@pytest.mark.parametrize("code", [code for code in ISO.g_codes.values() if code.later], ids=lambda code: code.name)
def test_what_comes_later_in_iso_is_refused(code):
    with pytest.raises(ProgramError, match=rf"{code.name} is not available yet"):
        run(code.name, dialect="iso")
    assert find(code.name, "iso")[0].later


def test_words_of_iso_are_explained(capsys):
    explain(["g54.1", "G98"], "iso")
    assert capsys.readouterr().out == (
        "G54.1 (G function)\n  syntax:   G54.1 Pn\n  meaning:  Zero offset 6 + n, n from 1 to 90.\n"
        "  group:    zero offset, modal\n  example:  G54.1 P2 G0 X0.\n\n"
        "G98 (G function)\n  syntax:   G98\n"
        "  meaning:  Cycles return to the level before the cycle, if it is above R; so at the start.\n"
        "  group:    return level, modal\n  example:  G98\n"
    )


BEFORE = {"$FOR": "$ENDFOR", "$IF": "$ENDIF", "$WHILE": "$ENDWHILE", "$SWITCH": "$ENDSWITCH"}
PLACES = {"V.P.F[2][3] = [1, 2, 3]": "#VAR\n{}\n#ENDVAR", "$GOTO [END]": "{}\n[END] X5"}
CYCLES = {path.name: path.read_text() for path in (HERE.parents[1] / "cnc_ptp" / "nc" / "cycles").glob("*.nc")}
FILES = {"drill.nc": "Z[@P1]\nM29", "pocket.nc": "M29", **CYCLES}


@pytest.mark.parametrize(
    "entry", [entry for entry in entries() if entry.explanation.example], ids=lambda entry: entry.name
)
def test_every_example_is_a_program(entry):
    example = entry.explanation.example
    text = PLACES.get(example, "{}").format(example)
    if entry.name in CLOSING:
        text += f"\n{CLOSING[entry.name]}"
    if entry.name == "%":
        text = f"{text}\nM29\n%MAIN"
    if "LL POCKET" in text:
        text = f"%L POCKET\nM29\n%MAIN\n{text}"
    before = "" if text.startswith("%") else "P1 = 9 P2 = 2\nF500\n"
    if entry.name == "#CAX":
        run(f"{text}\nM30", axes=("X", "Z", "C"), spindles=TABLES["c_axis"])
        return
    run(f"{before}{text}\nM30", files=FILES, turning_axes=FACING["X"])


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
        "  errors:   21435 the channel has no … …; it has: …\n"
        "            21439 '…' is not complete or has too much: it is written …\n"
        "            21600 zero offset … does not exist: …=0 to …=…\n"
        "            21622 …: G53 selects no zero offset, so that index 0 has no values (P-ZERO-00001)\n"
    )


def test_each_error_belongs_to_a_word_and_each_key_is_one():
    assert {number for numbers in errors_by_key().values() for number in numbers} == set(error_texts())
    words = {entry.name for entry in entries()} | {entry.kind for entry in entries()} | set(GENERAL)
    assert [word for key in errors_by_key() for word in key.split(", ") if word not in words] == []


def test_codes_that_stand_alone_are_their_own_example():
    assert find("G17")[0].explanation.example == "G17" and find("G351")[0].explanation.example == ""


def test_an_unknown_word():
    with pytest.raises(CncError) as refused:
        find("SINUS")
    assert str(refused.value) == "P-ERR-26123 'SINUS' is no word of the NC language; did you mean SIN or SIGN or ASIN?"
