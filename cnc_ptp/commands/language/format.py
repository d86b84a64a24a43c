"""`cnc_ptp format`: an NC program in one style; every line stays a line with the same meaning."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from typing import Final

from cnc_ptp.commands.console import print_error
from cnc_ptp.commands.output_file import write_output
from cnc_ptp.errors import WRONG_INPUT
from cnc_ptp.machine.program_files import read_program
from cnc_ptp.nc.lexer import plain_words
from cnc_ptp.nc.parser import parse_all
from cnc_ptp.nc.vocabularies import VOCABULARIES

INDENT: Final = "  "
OPENING: Final = ("$IF", "$SWITCH", "$FOR", "$WHILE", "$DO", "$REPEAT", "#VAR")
DIVIDING: Final = ("$ELSEIF", "$ELSE", "$CASE", "$DEFAULT")
CLOSING: Final = ("$ENDIF", "$ENDSWITCH", "$ENDFOR", "$ENDWHILE", "$ENDDO", "$UNTIL", "#ENDVAR")
_PART = re.compile(r'(?P<text>"[^"]*"?)|(?P<comment>;.*$)|(?P<block>\()|(?P<code>[^";(]+)')
_CALLED = re.compile(
    r"(?:(?<![A-Z0-9_])LL?\s+(?!CYCLE\b)|\bNAME\s*=\s*)(?P<name>[^\s\"\],#$\[]+)", re.ASCII | re.IGNORECASE
)
_KEYWORD = re.compile(r"(?:/\d*\s*)?(?:N\s*\d+:?\s*)?(?:\[\w+\]\s*)?([$#]\s*[A-Z]+)")
_SHORT_IF = re.compile(r"\$IF\b.*\$GOTO\b")


def format_program(program: str, in_place: bool, check_only: bool, dialect: str = "twincat") -> int:
    """Prints the program, or writes it back; with `check_only` only says whether it would change (status 1).

    One with syntax errors, as a main program and as a subroutine, is left alone: they are printed, status 2.
    """
    text, files = read_program(program)
    vocabulary = VOCABULARIES[dialect]
    errors = parse_all(text, program, files=files, vocabulary=vocabulary)[1]
    if errors and parse_all(text, program, files=files, vocabulary=vocabulary, subroutine=True)[1]:
        for error in errors:
            print_error(error)
        return WRONG_INPUT
    formatted = format_text(text)
    if check_only:
        print(f"{program} {'is formatted' if formatted == text else 'would change'}")
        return 0 if formatted == text else 1
    if in_place:
        if formatted != text:
            write_output(program, formatted, remains="the program is as it was")
    else:
        sys.stdout.write(formatted)
    return 0


def format_text(text: str) -> str:
    """The lines in capitals with one blank between words, indented by structures.

    Comments, texts, names of programs and what is behind a second % do not change.
    """
    return "".join(f"{line}\n" for line in formatted_lines(text.removeprefix("\ufeff").splitlines()))


def formatted_lines(lines: list[str]) -> Iterator[str]:
    level, in_comment, continued, percents = 0, False, False, 0
    for line in lines:
        if percents == 2:
            yield line.rstrip()
            continue
        percents += line.strip() == "%"
        if in_comment or re.match(r"\s*(?:N\s*\d+\s*)?#\s*COMMENT\s+BEGIN\b", line, re.IGNORECASE):
            in_comment = not re.match(r"\s*(?:N\s*\d+\s*)?#\s*COMMENT\s+END\b", line, re.IGNORECASE)
            yield line.rstrip()
            continue
        code = formatted_line(line)
        found = _KEYWORD.match(code)
        keyword = found[1].replace(" ", "") if found and not continued else ""
        closes = keyword in CLOSING or keyword in DIVIDING
        depth = max(0, level - closes) + (1 if continued else 0)
        yield (INDENT * depth + code) if code and not code.startswith("%") else code
        if keyword in OPENING and not _SHORT_IF.search(code):
            level += 1
        elif keyword in CLOSING:
            level = max(0, level - 1)
        continued = code.endswith("\\")


def formatted_line(line: str) -> str:
    """One line without its indentation."""
    if line.lstrip().startswith("%"):
        return line.strip()
    parts: list[str] = []
    place = 0
    while place < len(line):
        found = _PART.match(line, place)
        assert found is not None
        place = found.end()
        if found["block"]:
            place = end_of_comment(line, found.start())
            parts.append(f" {line[found.start() : place]} ")
        elif found["code"]:
            parts.append(formatted_code(found[0]))
        else:
            parts.append(f" {found[0]}" if found["comment"] else found[0])
    return _joined(parts)


def _joined(parts: Sequence[str]) -> str:
    """The parts of a line with one blank where two of them meet with blanks."""
    text = ""
    for part in parts:
        text = text.rstrip() + " " + part.lstrip() if text.endswith(" ") or part.startswith(" ") else text + part
    return text.strip()


def end_of_comment(line: str, begin: int) -> int:
    """The place behind a comment in brackets, which may have others in it."""
    depth = 0
    for place in range(begin, len(line)):
        depth += (line[place] == "(") - (line[place] == ")")
        if depth == 0:
            return place + 1
    return len(line)


def formatted_code(code: str) -> str:
    """Capitals, one blank for several, and one before each word of a plain line."""
    before = " " if code[:1].isspace() else ""
    after = " " if code[-1:].isspace() else ""
    columns = plain_words(code.rstrip())[2]
    if columns:
        ends = [*(column - 1 for column in columns[1:]), len(code)]
        words = [code[column - 1 : end] for column, end in zip(columns, ends, strict=True)]
        return before + " ".join("".join(word.split()).upper() for word in words) + after
    return before + _tight(_capitals(" ".join(code.split()))) + after


def _capitals(code: str) -> str:
    """Capitals; names of programs and files as they are written."""
    text, place = "", 0
    for found in _CALLED.finditer(code):
        text += code[place : found.start("name")].upper() + found["name"]
        place = found.end("name")
    return text + code[place:].upper()


def _tight(code: str) -> str:
    """Without blanks behind # and at the ends of brackets."""
    return re.sub(r"(?<=[#\[]) | (?=\])", "", code)
