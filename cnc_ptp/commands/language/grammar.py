"""`python -m cnc_ptp.commands.language.grammar`: tools/nc.tmLanguage.json, colours of NC programs in editors."""

from __future__ import annotations

import json
import re
import sys
from typing import Any

from cnc_ptp.nc.expressions.functions import CONSTANTS, NUMERIC, TEXTUAL
from cnc_ptp.nc.flow.statement_reader import KEYWORDS
from cnc_ptp.nc.hash_commands import COMMANDS, STATEMENTS
from cnc_ptp.nc.vocabularies import VOCABULARIES


def alternatives(words: list[str]) -> str:
    """A pattern for any of these words, the longest first; blanks in a word stand for any number of them."""
    ordered = sorted(words, key=lambda word: (-len(word), word))
    return "|".join(re.escape(word).replace(r"\ ", r"\s+") for word in ordered)


def grammar() -> dict[str, Any]:
    """The TextMate grammar; VS Code, Sublime Text and others read it."""
    rows = [code for vocabulary in VOCABULARIES.values() for code in vocabulary.g_codes.values()]
    codes = alternatives(sorted({f"{code.key:g}" for code in rows} | {str(number) for number in range(80, 90)}))
    commands = alternatives([*COMMANDS, *STATEMENTS])
    rules = [
        ("comment.line.semicolon.nc", ";.*$"),
        ("string.quoted.double.nc", '"[^"]*"?'),
        ("entity.name.function.nc", r"^\s*%(?:L\s+)?\s*[^\s(;]*"),
        ("keyword.control.nc", rf"(?i)(?:{alternatives(list(KEYWORDS))})\b"),
        ("keyword.other.command.nc", rf"(?i)#\s*(?:{commands})\b"),
        ("entity.name.function.call.nc", r"(?i)\bLL?\s+(?:CYCLE\b|[^\s\[;]+)"),
        ("variable.other.nc", r"(?i)\bV\s*\.\s*[A-Z_]+(?:\s*\.\s*[-+]?[A-Z_@][A-Z0-9_]*)*|@[A-Z]\w*|\bP\d+"),
        ("support.function.nc", rf"(?i)\b(?:{alternatives([*NUMERIC, *TEXTUAL, 'EXIST', *CONSTANTS])})\b"),
        ("keyword.operator.word.nc", r"(?i)\b(?:AND|OR|XOR|MOD)\b"),
        ("entity.name.function.program.nc", r"(?i)^\s*O\s*\d+"),
        ("entity.name.tag.block.nc", r"(?i)\bN\s*\d+:?"),
        ("storage.type.g.nc", rf"(?i)\bG\s*0*(?:{codes})(?![\d.])"),
        ("storage.type.m.nc", r"(?i)\bM\s*\d+"),
        ("variable.parameter.nc", r"(?i)[A-FH-LO-Z](?=\s*=?\s*[-+.\d\[])"),
        ("constant.numeric.nc", r"(?:\d+\.?\d*|\.\d+)|'(?:H[0-9A-Fa-f]+|B[01]+)'"),
        ("keyword.operator.nc", r"\*\*|\|\||&&|[=!<>]=|[-+*/<>|^&=]"),
    ]
    comment = {
        "name": "comment.block.nc", "begin": r"\(", "end": r"\)|$", "patterns": [{"include": "#comment"}]
    }  # fmt: skip
    patterns: list[dict[str, Any]] = [{"include": "#comment"}]
    patterns += [{"name": name, "match": pattern} for name, pattern in rules]
    return {
        "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
        "name": "NC program (TwinCAT CNC, DIN 66025, Fanuc, LinuxCNC)",
        "scopeName": "source.nc",
        "fileTypes": ["nc", "cyc", "ngc", "tap"],
        "patterns": patterns,
        "repository": {"comment": comment},
    }


def grammar_json() -> str:
    """tools/nc.tmLanguage.json."""
    return json.dumps(grammar(), indent=2) + "\n"


if __name__ == "__main__":
    sys.stdout.write(grammar_json())
