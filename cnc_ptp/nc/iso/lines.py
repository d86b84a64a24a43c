"""One line of the vocabulary iso -> one block: `/2 N10 G1 X1. (comment)`, `%`, `O1234`, calls by M98."""

import re
from typing import Final

from cnc_ptp.nc import faults
from cnc_ptp.nc.block_words import BlockWords
from cnc_ptp.nc.canonical import Source, code_name
from cnc_ptp.nc.flow.lines import Call, Line
from cnc_ptp.nc.iso import iso_faults
from cnc_ptp.nc.iso.comments import without_comments
from cnc_ptp.nc.iso.cycles import MOST_REPEATS
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.lexer import MAX_DIGITS, NUMBER, SKIP, Token
from cnc_ptp.nc.program import NcBlock, SpindleWords

MAX_SKIP_LEVEL: Final = 9
LARGEST_PROGRAM: Final = 99_999_999
_BLOCK_NUMBER = re.compile(r"\s*N\s*(\d{1,9})(?![\d.])", re.ASCII)
_WORD = re.compile(rf"\s*(?P<shown>(?P<letter>[A-Z])\s*(?P<number>{NUMBER}))(?![\d.])", re.ASCII)
_O_NUMBER = re.compile(r"\s*(O\s*(\d{1,8}))\s*(.*)", re.ASCII)
_KEYWORDS = "SUB|ENDSUB|CALL|RETURN|IF|ELSE|ELSEIF|ENDIF|WHILE|ENDWHILE|DO|REPEAT|ENDREPEAT|CONTINUE|BREAK"
_O_WORD = re.compile(rf"O\s*(?:<[^>]*>?\s*[A-Z]*|\d+\s*(?:{_KEYWORDS})(?![A-Z]))", re.ASCII)
_MACRO = re.compile(r"#\s*<?\w*>?|\[[^\]]*\]?|[A-Z]\s*[+-]?\s*(?:#\s*<?\w*>?|\[[^\]]*\]?)", re.ASCII)
_UNREADABLE = re.compile(r"[A-Z]\s*[-+.\d]*|[-+.\d]+|.", re.ASCII | re.DOTALL)


def iso_line(line: Line) -> None:
    """Reads any line of a program; raises ProgramError with the column."""
    text = without_comments(line.source)
    begin = text.lstrip()
    if begin.startswith("%"):
        line.header = True
        return
    if begin.startswith("O"):
        _program_number(line, text)
        return
    at = _skip_level(line, text)
    match = _BLOCK_NUMBER.match(text, at)
    if match is not None:
        place = match.start() + len(match[0]) - len(match[0].lstrip()) + 1
        line.source = line.source._replace(block_number=int(match[1]), names=("N",), columns=(place,))
        at = match.end()
    line.block = _words(line, text, at)


def _program_number(line: Line, text: str) -> None:
    """`O1234` begins a program or subroutine."""
    match = _O_NUMBER.match(text)
    if match is not None and not match[3]:
        line.header = True
        return
    begin = len(text) - len(text.lstrip())
    word = _O_WORD.match(text, begin)
    if word is not None:
        raise iso_faults.O_WORD.at(line.source, begin + 1, word=word[0].strip())
    raise iso_faults.PROGRAM_NUMBER.at(line.source, begin + 1, word=text.strip())


def program_name(source: Source) -> str:
    """`O100` of a line with a program number, "" of one with %. Raises ProgramError for words behind %."""
    text = without_comments(source).strip()
    if text.startswith("%"):
        if len(text) > 1:
            raise faults.PROGRAM_NAME.at(source, source.text.index("%") + 2, word=text[1:].strip())
        return ""
    return f"O{int(''.join(text[1:].split()))}"


def _skip_level(line: Line, text: str) -> int:
    match = SKIP.match(text)
    if match is None:
        return 0
    level = int(match[1] or "1") if len(match[1]) < 2 else 0
    if not 1 <= level <= MAX_SKIP_LEVEL:
        raise faults.SKIP_LEVEL.at(line.source, match.start(1) + 1, level=match[1], limit=MAX_SKIP_LEVEL)
    line.skip = 1 << (level - 1)
    return match.end()


def _words(line: Line, text: str, at: int) -> NcBlock | None:
    found: list[Token] = []
    while at < len(text):
        match = _WORD.match(text, at)
        if match is None or match["letter"] == "O":
            raise _unreadable(line.source, text, at)
        found.append(Token("word", match["letter"], match["number"], match.start("shown") + 1, match["shown"]))
        at = match.end()
    if not found:
        return None
    names = [_name(token) for token in found]
    before = line.source
    columns = (*before.columns, *[token.column for token in found])
    line.source = before._replace(names=(*before.names, *names), columns=columns)
    words = BlockWords(line.source, ISO)
    for token in found:
        words.take(token)
    _check_owners(words)
    _call(line, words)
    _orientation(words)
    block = words.block()
    line.flow = block.flow
    return block


def _name(token: Token) -> str:
    """As the tables name it: G01, G54.1, M03, X."""
    value = float(token.text)
    if token.name not in "GM" or value < 0.0:
        return token.name
    code = ISO.g_codes.get(value) if token.name == "G" else None
    return code.name if code is not None else code_name(token.name, int(value))


def _check_owners(words: BlockWords) -> None:
    """P, Q, L, H, R belong to one code of their block."""
    calls = [code for code in words.m if code.number == 98]
    for letter in words.words:
        owners = [code.name for code in words.codes if letter in code.words]
        owners += [code.name for code in calls if letter in "PL"]
        if len(owners) > 1:
            column = words.source.column(letter)
            raise iso_faults.WORD_OF_TWO.at(words.source, column, word=letter, first=owners[0], second=owners[1])


def _call(line: Line, words: BlockWords) -> None:
    """M98 P1234 L2: the subroutine O1234, twice."""
    if all(code.number != 98 for code in words.m):
        return
    source = line.source
    if "P" not in words.words:
        raise iso_faults.CALL_NUMBER.at(source, source.column("M98"))
    number = _integer(words, "P", 0, LARGEST_PROGRAM)
    count = _integer(words, "L", 1, MOST_REPEATS) if "L" in words.words else 1
    line.call = Call(f"O{number}", source.column("P"), {}, local=True, cycle=False, modal="", count=count)


def _integer(words: BlockWords, word: str, low: int, high: int) -> int:
    value = words.words.pop(word)
    if value != int(value) or not low <= value <= high:
        column = words.source.column(word)
        raise iso_faults.RANGE.at(words.source, column, word=word, value=f"{value:g}", low=low, high=high)
    return int(value)


def _orientation(words: BlockWords) -> None:
    """M19 R90: the position of the spindle."""
    if any(code.number == 19 for code in words.m) and not any("R" in code.words for code in words.codes):
        position = words.words.pop("R", None)
        if position is not None:
            words.spindles.append(SpindleWords("", None, None, position, din=True))


def _unreadable(source: Source, text: str, at: int) -> faults.ProgramError:
    while text[at].isspace():
        at += 1
    macro = _MACRO.match(text, at)
    if macro is not None:
        return iso_faults.MACRO.at(source, at + 1, word=macro[0])
    if text[at] == "O":
        word = _O_WORD.match(text, at)
        return iso_faults.O_WORD.at(source, at + 1, word=word[0].strip() if word is not None else text[at:])
    match = _UNREADABLE.match(text, at)
    shown = match[0].strip() if match is not None else text[at]
    if re.search(rf"(?<![.\d])\d{{{MAX_DIGITS + 1}}}", shown):
        return faults.NUMBER_TOO_LONG.at(source, at + 1, word=shown, limit=MAX_DIGITS)
    if shown[0].isalnum() or shown[0] in "+-.":
        return iso_faults.GAP.at(source, at + 1, word=shown)
    return faults.UNEXPECTED_CHARACTER.at(source, at + 1, character=shown)
