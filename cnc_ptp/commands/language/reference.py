"""`python -m cnc_ptp.commands.language.reference`: docs/nc_language.md, made from the tables of the language."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from cnc_ptp.commands.language.words import Entry, entries
from cnc_ptp.nc.expressions.reader import DEEPEST
from cnc_ptp.nc.expressions.values import LARGEST_PARAMETER, MOST_VALUES
from cnc_ptp.nc.flow.execution import Limits

INTRODUCTION = """# NC language
Made from the tables of the language by `make docs`; `cnc_ptp explain G54` prints one row. Names and rules are those of
TwinCAT CNC (DIN 66025 with the vendor's extensions). [program.md](program.md) says how programs and machine files go
together.

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
    "brackets": "`[ ]` in expressions; `( )` and `;` are comments",
    "operators, weak to strong": "`||` OR · XOR · `&&` AND · `== != < <= > >=` · `|` · `^` · `&` · `+ -` · `* / MOD` · "
    "sign · `**`",
    "words with expressions": "`X[P1 + 5]`, `XP1`, `X=P1 + 5`, `X SIN[30]`, `S[M3 REV=P1]`, `G[P1]`",
    "assignments": "`P1 = 5`, `V.P.A += 2` (also `-=`, `*=`, `/=`)",
    "long lines": "a backslash at the end continues a line",
    "faults": "division by 0, overflow, undefined results and unset variables are errors with line and column",
    "limits": f"P0 to P{LARGEST_PARAMETER}; {MOST_VALUES:,} values; {DEEPEST} levels of brackets; "
    f"{Limits().call_depth} calls within each other; {Limits().repeats:,} repeated lines",
}
SECTIONS = {
    "G function": "G functions",
    "M function": "M functions",
    "word": "Words",
    "control statement": "Control statements",
    "command": "Commands",
    "function": "Functions",
    "constant": "Constants",
    "readable state": "Readable state",
}


def reference_markdown() -> str:
    """docs/nc_language.md."""
    rules = [f"| {what} | {escaped(rule)} |" for what, rule in RULES.items()]
    return "\n".join([INTRODUCTION.rstrip(), *rules, "", *section_lines()])


def section_lines() -> Iterator[str]:
    all_entries = entries()
    for kind, title in SECTIONS.items():
        chosen = [entry for entry in all_entries if entry.kind == kind]
        grouped = kind == "G function"
        yield f"## {title}"
        yield "| code | syntax | group | meaning | example |" if grouped else "| name | syntax | meaning | example |"
        yield "|---|---|---|---|---|" if grouped else "|---|---|---|---|"
        yield from (row(entry, grouped=grouped) for entry in chosen)
        yield ""


def row(entry: Entry, *, grouped: bool) -> str:
    text = entry.explanation
    meaning = f"{text.meaning} **Not available yet.**" if entry.later else text.meaning
    group = [entry.group if entry.modal else f"{entry.group} (block)"] if grouped else []
    example = f"`{text.example}`" if text.example else ""
    cells = [entry.name, f"`{text.syntax}`", *group, meaning, example]
    return "| " + " | ".join(map(escaped, cells)) + " |"


def escaped(cell: str) -> str:
    return cell.replace("|", "\\|")


if __name__ == "__main__":
    sys.stdout.write(reference_markdown())
