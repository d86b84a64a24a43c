"""`python -m cnc_ptp.commands.language.reference [iso]`: docs/nc_language.md, docs/iso_language.md, from the tables."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from cnc_ptp.commands.language.word_errors import error_texts, errors_by_key
from cnc_ptp.commands.language.words import Entry, entries
from cnc_ptp.nc.expressions.reader import DEEPEST
from cnc_ptp.nc.expressions.values import LARGEST_PARAMETER, MOST_VALUES
from cnc_ptp.nc.program import Limits

INTRODUCTION = """# NC language
Made from the tables of the language by `make docs`; `cnc_ptp explain G54` prints one row. Names and rules are those of
TwinCAT CNC (DIN 66025 with the vendor's extensions). The second vocabulary is [iso_language.md](iso_language.md).
[program.md](program.md) says how programs and machine files go together.

A program is interpreted before it starts. What only the run knows (V.A.ACT_POS) makes the path stop before its line;
what follows is checked when it is reached.

## Rules
| what | rule |
|---|---|
"""
RULES = {
    "letters": "upper and lower case are equal, except in texts",
    "order in a line": "`/`, N or label, words; assignments act from left to right",
    "numbers": "real; an integer is a real number without decimals; `'H2FF'` hexadecimal, `'B1001'` binary",
    "truth": "TRUE is 1, FALSE is 0; a number is true from 1/2 on",
    "angles": "degrees; SIN and COS are exact at the multiples of 30° where they are 0, ±1/2, ±1",
    "brackets": "`[ ]` in expressions; `( )` and `;` are comments, without `)` to the end of the line",
    "operators, weak to strong": "`||` OR · XOR · `&&` AND · `== != < <= > >=` · `|` · `^` · `&` · `+ -` · `* / MOD` · "
    "sign · `**`",
    "words with expressions": "`X[P1 + 5]`, `XP1`, `X=P1 + 5`, `X SIN[30]`, `S[M3 REV=P1]`, `G[P1]`",
    "assignments": "`P1 = 5`, `V.P.A += 2` (also `-=`, `*=`, `/=`)",
    "long lines": "a backslash at the end continues a line",
    "faults": "division by 0, overflow, undefined results and unset variables are errors with line and column",
    "limits": f"P0 to P{LARGEST_PARAMETER}; {MOST_VALUES:,} values; {DEEPEST} levels of brackets; "
    f"{Limits().call_depth} calls within each other; {Limits().repeats:,} repeats",
}
ISO_INTRODUCTION = """# Vocabulary iso
Made from the tables of the language by `make docs`; `cnc_ptp explain --dialect iso G64` prints one row. What CAM
post-processors write for Fanuc and LinuxCNC. Where the two differ, [nc_readings.md](nc_readings.md#vocabulary-iso) says
what counts here. [program.md](program.md#the-vocabulary-iso) says how it is chosen.

## Rules
| what | rule |
|---|---|
"""
ISO_RULES = {
    "letters": "upper and lower case are equal; a word is a letter and a number, with or without blanks between them",
    "order in a line": "`/`, N, words",
    "numbers": "`10`, `10.`, `.5`, `+1.5`, `007`; up to 9 digits before the point",
    "program": "`%` at both ends may be missing; what is behind the second one is not read",
    "subroutines": "`O1234` … `M99` before or behind the main program, which ends with M30 or M2",
    "refused": "macro variables `#1`, expressions `[ ]`, O words (`o<name> call`): the error names them",
    "start": "G0 G17 G21 G54 G61 G90 G91.1 G94 G98",
}
SECTIONS = {
    "G function": "G functions",
    "M function": "M functions",
    "word": "Words",
    "operator": "Operators",
    "control statement": "Control statements",
    "command": "Commands",
    "function": "Functions",
    "constant": "Constants",
    "readable state": "Readable state",
}


GENERAL = ("any line", "expressions", "programs", "axes in brackets", "spindles in brackets", "free M function")
"""Keys of errors.yaml that are no words."""


def reference_markdown(dialect: str = "twincat") -> str:
    """docs/nc_language.md or docs/iso_language.md."""
    introduction, chosen = (INTRODUCTION, RULES) if dialect == "twincat" else (ISO_INTRODUCTION, ISO_RULES)
    rules = [f"| {what} | {escaped(rule)} |" for what, rule in chosen.items()]
    lines = [introduction.rstrip(), *rules, "", *section_lines(dialect)]
    return "\n".join([*lines, *error_lines(dialect)])


def error_lines(dialect: str) -> Iterator[str]:
    """The errors with their texts; first those that belong to no single word."""
    yield "## Errors"
    yield "The tables above name by number the errors of each word. Besides these there are:"
    yield ""
    yield "| in | errors |"
    yield "|---|---|"
    listed = errors_by_key(dialect)
    yield from (f"| {key} | {', '.join(map(str, sorted(listed[key])))} |" for key in GENERAL if key in listed)
    yield ""
    yield "| number | text |"
    yield "|---|---|"
    yield from (f"| {number} | {escaped(text)} |" for number, text in sorted(error_texts(dialect).items()))
    yield ""


def section_lines(dialect: str) -> Iterator[str]:
    all_entries = entries(dialect)
    for kind, title in SECTIONS.items():
        chosen = [entry for entry in all_entries if entry.kind == kind]
        if not chosen:
            continue
        grouped = kind in ("G function", "M function")
        columns = [
            "code" if grouped else "name",
            "syntax",
            *["group"] * grouped,
            "meaning",
            "example",
            "errors",
        ]
        yield f"## {title}"
        yield f"| {' | '.join(columns)} |"
        yield "|" + "---|" * len(columns)
        yield from (row(entry, grouped=grouped) for entry in chosen)
        yield ""


def row(entry: Entry, *, grouped: bool) -> str:
    text = entry.explanation
    meaning = f"{text.meaning} **Not available yet.**" if entry.later else text.meaning
    group = [entry.group if entry.modal or not entry.group else f"{entry.group} (block)"] if grouped else []
    example = "<br>".join(f"`{line}`" for line in text.example.splitlines())
    numbers = ", ".join(map(str, entry.errors))
    cells = [entry.name, f"`{text.syntax}`", *group, meaning, example, numbers]
    return "| " + " | ".join(map(escaped, cells)) + " |"


def escaped(cell: str) -> str:
    return cell.replace("|", "\\|")


if __name__ == "__main__":
    sys.stdout.write(reference_markdown(*sys.argv[1:]))
