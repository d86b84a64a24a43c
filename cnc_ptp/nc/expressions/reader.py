"""Text of an expression -> its tree. Reads as far as the expression goes and says where it ends.

Operators from weak to strong: || OR, XOR, && AND, comparisons, |, ^, &, + -, * / MOD, sign, **. Brackets are [ ].
"""

import re
from collections.abc import Sequence
from typing import Final

from cnc_ptp.errors import nearest_name
from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.expressions import expression_faults as faults
from cnc_ptp.nc.expressions.functions import ANY, CONSTANTS, NUMERIC, TEXTUAL
from cnc_ptp.nc.expressions.nodes import (
    Add,
    And,
    Argument,
    Bits,
    Call,
    ComputedParameter,
    Constant,
    Divide,
    Equal,
    Exists,
    Greater,
    GreaterOrEqual,
    Less,
    LessOrEqual,
    Modulo,
    Multiply,
    Negative,
    Node,
    NotEqual,
    Or,
    Parameter,
    Power,
    Readable,
    SelfDefined,
    Subtract,
    Text,
    TextCall,
    Xor,
)
from cnc_ptp.nc.expressions.readable import READABLE, all_names, forms
from cnc_ptp.nc.expressions.reading import Reading
from cnc_ptp.nc.expressions.values import LARGEST_PARAMETER, SCOPES, in_words
from cnc_ptp.nc.faults import NUMBER_TOO_LONG, Fault, ProgramError

Assignable = Parameter | ComputedParameter | SelfDefined | Readable

DEEPEST: Final = 40
"""Levels of brackets and operators within each other."""
MOST_OPERATORS: Final = 150
"""Operators one after the other."""
SIGN: Final = 10
POWER: Final = 11

_OPERATORS: Final = {
    "||": 1, "OR": 1, "XOR": 2, "&&": 3, "AND": 3, "==": 4, "!=": 4, "<=": 4, ">=": 4, "<": 4, ">": 4,
    "|": 5, "^": 6, "&": 7, "+": 8, "-": 8, "*": 9, "/": 9, "MOD": 9, "**": POWER,
}  # fmt: skip
_OPERATOR = re.compile(r"\s*(\*\*|\|\||&&|[=!<>]=|[-+*/<>|^&]|(?:MOD|AND|OR|XOR)(?![A-Z0-9_]))", re.ASCII)
_BLANK = re.compile(r"\s*", re.ASCII)
MOST_DIGITS: Final = 15
_TOO_LONG = re.compile(rf"\d{{{MOST_DIGITS + 1}}}", re.ASCII)
_NUMBER = re.compile(rf"(?:\d{{1,{MOST_DIGITS}}}+(?:\.\d*+)?+|\.\d++)(?![\d.])", re.ASCII)
_CODED = re.compile(r"'\s*(?:H\s*([0-9A-F]{1,13})|B\s*([01]{1,53}))\s*'", re.ASCII)
_PARAMETER = re.compile(r"P\s*(?:(\d+)(?![\d.])|(?=P\s*[\d\[P]|\[))", re.ASCII)
_VARIABLE = re.compile(r"V\s*\.\s*[A-Z_]+\s*\.\s*[-+]?[A-Z_@][A-Z0-9_]*", re.ASCII)
_PART = re.compile(r"\s*\.\s*([-+]?[A-Z_][A-Z0-9_]*)", re.ASCII)
_ARGUMENT = re.compile(r"@\s*([A-Z]\w*)", re.ASCII)
_NAME = re.compile(r"[A-Z_][A-Z0-9_]*", re.ASCII)
_WORD = re.compile(r"[A-Z0-9_.]+|\S", re.ASCII)
_FUNCTIONS = "|".join([*NUMERIC, *TEXTUAL, "EXIST"])
_BEGINS = rf"P\s*[\d\[P]|V\s*\.|@|'|(?:{_FUNCTIONS})\s*\[|(?:{'|'.join(CONSTANTS)})(?![A-Z0-9_])"
OPENS = re.compile(rf"\s*(?:[-+]\s*)*(?:\[|{_BEGINS})", re.ASCII)
"""Whether an expression, and not just a number, begins behind a word."""
FILLS = re.compile(rf"\[\s*(?:[-+]\s*)*(?:\[|[\d.]|{_BEGINS})", re.ASCII)
"""Whether a bracket holds an expression and not words of a spindle or an axis."""
CONTINUES = re.compile(r"[-+*/]|\s+MOD(?![A-Z0-9_])", re.ASCII)
"""Whether an expression continues behind a number: in `X10 -5` the letter of another word is missing."""
CONTINUES_BEHIND_EQUALS = re.compile(r"\s*(?:[-+*/]|MOD(?![A-Z0-9_]))", re.ASCII)
"""The same behind `X=10`, where blanks may precede the operator."""


class ExpressionReader:
    """Reads expressions in a normalised line from place `at` (from 0) on."""

    def __init__(self, line: str, source: Source, at: int = 0) -> None:
        self.line, self.source, self.at = line, source, at
        self._depth = 0
        self.synchronises = False
        """Something was read that only the run knows."""

    # what surrounds expressions

    def fault(self, fault: Fault, at: int, **values: float | str) -> ProgramError:
        return fault.at(self.source, at + 1, **values)

    def skip_blanks(self) -> int:
        found = _BLANK.match(self.line, self.at)
        assert found is not None
        self.at = found.end()
        return self.at

    def follows(self, character: str) -> bool:
        """Whether this character is next; it is taken."""
        if self.line.startswith(character, self.skip_blanks()):
            self.at += len(character)
            return True
        return False

    def word(self) -> str:
        """What is next, for an error."""
        found = _WORD.match(self.line, self.skip_blanks())
        return found[0] if found else ""

    def items(self) -> list[Node]:
        """Expressions with commas between them, up to the closing bracket; the opening one has been taken."""
        opened = self.at - 1
        items = [self.expression()]
        while self.follows(","):
            items.append(self.expression())
        self.close(opened)
        return items

    def close(self, opened: int) -> None:
        """Takes the closing bracket of the one at place `opened`."""
        if self.follows("]"):
            return
        if self.skip_blanks() >= len(self.line):
            raise self.fault(faults.PARENTHESIS_OPEN, opened, bracket=self.line[opened])
        if self.line[self.at] == "=":
            raise self.equals(self.at)
        raise self.operand_missing(self.at)

    def operand_missing(self, at: int) -> ProgramError:
        """The error of something that is no value, or of nothing."""
        word = self.word()
        if _TOO_LONG.match(self.line, self.at):
            return self.fault(NUMBER_TOO_LONG, at, word=word, limit=MOST_DIGITS)
        return self.fault(faults.OPERAND_MISSING, at, word=word) if word else self.fault(faults.OPERAND_END, at)

    def equals(self, at: int) -> ProgramError:
        """The error of a single '=' where values are compared."""
        return self.fault(faults.EQUALS_FOR_COMPARISON, at)

    def indices(self) -> list[Node]:
        """[1][2] or [1, 2]."""
        found: list[Node] = []
        while self.line.startswith("[", self.skip_blanks()):
            self.at += 1
            found += self.items()
        return found

    # expressions

    def expression(self, weakest: int = 1) -> Node:
        """The expression from here on, as far as operators of at least this strength hold it together."""
        self._depth += 1
        if self._depth > DEEPEST:
            raise self.fault(faults.TOO_DEEP, self.at, limit=DEEPEST)
        node = self._operand()
        operators = 0
        while True:
            found = _OPERATOR.match(self.line, self.at)
            strength = _OPERATORS[found[1]] if found else 0
            if found is None or strength < weakest:
                break
            place = found.start(1)
            operators += 1
            if operators > MOST_OPERATORS:
                raise self.fault(faults.TOO_LONG, place, limit=MOST_OPERATORS)
            self.at = found.end()
            right = self.expression(POWER if strength == POWER else strength + 1)
            node = _joined(found[1], place + 1, node, right)
        self._depth -= 1
        return node

    def _operand(self) -> Node:
        begin = self.skip_blanks()
        character = self.line[begin : begin + 1]
        if character in ("-", "+") and character:
            self.at += 1
            self._depth += 1
            if self._depth > DEEPEST:
                raise self.fault(faults.TOO_DEEP, begin, limit=DEEPEST)
            operand = self.expression(SIGN)
            self._depth -= 1
            return Negative(begin + 1, operand) if character == "-" else operand
        if character == "[":
            self.at += 1
            inner = self.expression()
            self.close(begin)
            return inner
        if character == '"':
            return self._text(begin)
        if character == "'":
            return self._coded(begin)
        if found := _NUMBER.match(self.line, begin):
            self.at = found.end()
            return Constant(begin + 1, float(found[0]))
        return self._named(begin)

    def _text(self, begin: int) -> Node:
        end = self.line.find('"', begin + 1)
        if end < 0:
            raise self.fault(faults.TEXT_OPEN, begin)
        self.at = end + 1
        return Text(begin + 1, self.line[begin + 1 : end])

    def _coded(self, begin: int) -> Node:
        found = _CODED.match(self.line, begin)
        if found is None:
            shown = self.line[begin:].split()[0]
            raise self.fault(faults.HEXADECIMAL, begin, word=shown)
        self.at = found.end()
        return Constant(begin + 1, float(int(found[1], 16) if found[1] else int(found[2], 2)))

    def _named(self, begin: int) -> Node:
        if found := _ARGUMENT.match(self.line, begin):
            self.at = found.end()
            return Argument(begin + 1, found[1])
        target = self.target()
        if target is not None:
            return target
        name = _NAME.match(self.line, begin)
        if name is None:
            raise self.operand_missing(begin)
        self.at = name.end()
        if name[0] in CONSTANTS:
            return Constant(begin + 1, CONSTANTS[name[0]])
        if not self.follows("["):
            raise self._unknown(name[0], begin)
        if name[0] == "EXIST":
            return self._exists(begin)
        return self._call(name[0], begin, self.items())

    def target(self) -> Assignable | None:
        """A parameter or variable from here on; None if there is none."""
        begin = self.skip_blanks()
        if found := _PARAMETER.match(self.line, begin):
            self.at = found.end()
            return self._parameter(found[1], begin)
        found = _VARIABLE.match(self.line, begin)
        if found is None:
            return None
        self.at = found.end()
        name = "".join(found[0].split())
        scope = name[: name.index(".", 2) + 1]
        if scope in SCOPES:
            return SelfDefined(begin + 1, name, self.indices())
        return self._readable(name, begin)

    def _parameter(self, digits: str | None, begin: int) -> Assignable:
        if digits is None:
            if self.line.startswith("[", self.at):
                self.at += 1
                opened = self.at - 1
                computed = self.expression()
                self.close(opened)
            else:
                self._depth += 1
                if self._depth > DEEPEST:
                    raise self.fault(faults.TOO_DEEP, self.at, limit=DEEPEST)
                inner = self.target()
                self._depth -= 1
                if inner is None:
                    raise self.operand_missing(self.skip_blanks())
                computed = inner
            return ComputedParameter(begin + 1, computed, self.indices())
        number = int(digits[:9])
        if number > LARGEST_PARAMETER or len(digits) > 9:
            raise self.fault(faults.PARAMETER_NUMBER, begin, number=digits, limit=LARGEST_PARAMETER)
        indices = self.indices()
        return (
            ComputedParameter(begin + 1, Constant(begin + 1, float(number)), indices)
            if indices
            else Parameter(begin + 1, number)
        )

    def _readable(self, name: str, begin: int) -> Readable:
        """V.A.ABS.X, V.G.NP[1].V.X: names with an axis or an index."""
        parts: list[Node | str] = []
        while True:
            if self.line.startswith("[", self.skip_blanks()):
                parts += self.indices()
            elif found := _PART.match(self.line, self.at):
                parts.append(found[1])
                self.at = found.end()
            else:
                break
        reading = _reading(name, parts)
        if reading is None:
            shown = ".".join([name, *(part for part in parts if isinstance(part, str))])
            if name in READABLE:
                raise self.fault(faults.READING_FORM, begin, word=self.line[begin : self.at], forms=forms(name))
            raise self.fault(faults.NAME_UNKNOWN, begin, word=shown, nearest=nearest_name(shown, all_names()))
        found_reading, units = reading
        self.synchronises = self.synchronises or found_reading.synchronises
        return Readable(begin + 1, name, found_reading, units)

    def _exists(self, begin: int) -> Node:
        opened = self.at - 1
        inside = self.skip_blanks()
        if found := _ARGUMENT.match(self.line, inside):
            self.at = found.end()
            asked: Node | None = Argument(inside + 1, found[1])
        else:
            asked = self.target()
        if not isinstance(asked, (SelfDefined, Argument, Parameter)):
            raise self.operand_missing(inside)
        self.close(opened)
        return Exists(begin + 1, asked)

    def _call(self, name: str, begin: int, given: Sequence[Node]) -> Node:
        numeric, textual = NUMERIC.get(name), TEXTUAL.get(name)
        if numeric is not None:
            fewest, most = numeric.fewest, numeric.most
        elif textual is not None:
            kinds = textual.kinds.replace("?", "")
            fewest, most = len(textual.kinds.split("?")[0]), len(kinds)
        else:
            raise self._unknown(name, begin)
        if not fewest <= len(given) <= most:
            wanted = f"at least {in_words(fewest, 'value')}" if most == ANY else in_words(fewest, "value")
            wanted = f"{fewest} to {most} values" if fewest < most < ANY else wanted
            values = {"function": name, "wanted": wanted, "given": str(len(given))}
            raise self.fault(faults.ARGUMENT_COUNT, begin, **values)
        if numeric is not None:
            return Call(begin + 1, name, given, numeric.operation)
        assert textual is not None
        return TextCall(begin + 1, name, given, textual.kinds.replace("?", ""), textual.operation)

    def _unknown(self, name: str, begin: int) -> ProgramError:
        function = NUMERIC.get(name) or TEXTUAL.get(name)
        if function is not None:
            return self.fault(faults.FUNCTION_BRACKETS, begin, function=name, syntax=function.text.partition(":")[0])
        nearest = nearest_name(name, [*NUMERIC, *TEXTUAL, *CONSTANTS, "EXIST"])
        return self.fault(faults.NAME_UNKNOWN, begin, word=name, nearest=nearest)


def _reading(name: str, parts: Sequence[Node | str]) -> tuple[Reading, list[Node | str]] | None:
    """The row of a readable name, and what `*` in the table stands for: an axis, a spindle or an index."""
    for pattern, reading in READABLE.get(name, ()):
        if len(pattern) != len(parts):
            continue
        if all(wanted == "*" or wanted == part for wanted, part in zip(pattern, parts, strict=True)):
            return reading, [part for wanted, part in zip(pattern, parts, strict=True) if wanted == "*"]
    return None


def _joined(operator: str, column: int, left: Node, right: Node) -> Node:
    if operator in ("&", "|", "^"):
        return Bits(column, left, right, operator)
    kind = _BINARY[operator]
    return kind(column, left, right)


_BINARY: Final = {
    "||": Or, "OR": Or, "XOR": Xor, "&&": And, "AND": And, "==": Equal, "!=": NotEqual, "<": Less, "<=": LessOrEqual,
    ">": Greater, ">=": GreaterOrEqual, "+": Add, "-": Subtract, "*": Multiply, "/": Divide, "MOD": Modulo, "**": Power,
}  # fmt: skip
