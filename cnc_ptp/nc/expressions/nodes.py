"""The tree of an expression. Numbers are real, TRUE is 1 and FALSE is 0; texts are for messages and comparison."""

from collections.abc import Callable, Sequence
from math import pow as power
from typing import Final

from cnc_ptp.nc.canonical import number
from cnc_ptp.nc.expressions import expression_faults as faults
from cnc_ptp.nc.expressions.reading import Reading
from cnc_ptp.nc.expressions.values import LARGEST_PARAMETER, LONGEST_TEXT, Scalar, Values, shown

TRUTH: Final = 0.5
LARGEST: Final = 1.7976931348623157e308
LARGEST_INTEGER: Final = 9007199254740992.0
"""2^53: up to it all integers are exact."""


class Node:
    """One value of an expression, at `column` of its line."""

    def __init__(self, column: int) -> None:
        self.column = column
        self.may_be_text = False

    def value(self, values: Values) -> float:
        """The number. Raises ProgramError."""
        raise values.fault(faults.NUMBER_EXPECTED, self.column, what=shown(self.scalar(values)))

    def scalar(self, values: Values) -> Scalar:
        """Number or text."""
        return self.value(values)

    def holds(self, values: Values) -> bool:
        """As a condition: true from 1/2 on, as the vendor has it."""
        return abs(self.value(values)) >= TRUTH

    def integer(self, values: Values, what: str) -> int:
        """Raises ProgramError 21423 for a number with decimals."""
        found = self.value(values)
        if found != found // 1.0 or not -LARGEST_INTEGER <= found <= LARGEST_INTEGER:
            raise values.fault(faults.NOT_INTEGER, self.column, what=what, value=number(found))
        return int(found)

    def finite(self, values: Values, result: float, operation: str) -> float:
        if not -LARGEST <= result <= LARGEST:
            raise values.fault(faults.OVERFLOW, self.column, operation=operation)
        return result


class Constant(Node):
    def __init__(self, column: int, constant: float) -> None:
        super().__init__(column)
        self.constant = constant

    def value(self, values: Values) -> float:
        return self.constant


class Text(Node):
    def __init__(self, column: int, constant: str) -> None:
        super().__init__(column)
        self.constant = constant
        self.may_be_text = True

    def scalar(self, values: Values) -> Scalar:
        return self.constant


class Parameter(Node):
    """P10."""

    def __init__(self, column: int, index: int) -> None:
        super().__init__(column)
        self.index = index

    def value(self, values: Values) -> float:
        found = values.parameters.get(self.index)
        if found is None:
            values.require_parameter(self.index, self.column)
            raise values.fault(faults.PARAMETER_UNSET, self.column, name=f"P{self.index}")
        return found

    def assign(self, values: Values, value: Scalar) -> None:
        if isinstance(value, str):
            raise values.fault(faults.NUMBER_EXPECTED, self.column, what=f"the value of P{self.index}")
        values.require_parameter(self.index, self.column)
        values.parameters[self.index] = value


class ComputedParameter(Node):
    """P[P1 + 2], P10[3], P[10][3]: the number of the parameter, and the indices if it is an array."""

    def __init__(self, column: int, index: Node, indices: Sequence[Node]) -> None:
        super().__init__(column)
        self.index, self.indices = index, indices

    def place(self, values: Values) -> int:
        index = self.index.integer(values, "the number of a parameter")
        if not 0 <= index <= LARGEST_PARAMETER:
            raise values.fault(faults.PARAMETER_NUMBER, self.index.column, number=index, limit=LARGEST_PARAMETER)
        return index

    def value(self, values: Values) -> float:
        index = self.place(values)
        if self.indices:
            return SelfDefined(self.column, f"P{index}", self.indices).value(values)
        return Parameter(self.column, index).value(values)

    def assign(self, values: Values, value: Scalar) -> None:
        index = self.place(values)
        if self.indices:
            SelfDefined(self.column, f"P{index}", self.indices).assign(values, value)
        else:
            Parameter(self.column, index).assign(values, value)


class SelfDefined(Node):
    """V.P.NAME, V.L.NAME[2][3]."""

    def __init__(self, column: int, name: str, indices: Sequence[Node]) -> None:
        super().__init__(column)
        self.name, self.indices = name, indices
        self.may_be_text = True

    def scalar(self, values: Values) -> Scalar:
        variable = values.variable(self.name, self.column)
        if not self.indices and not variable.dimensions:
            return variable.values[0]
        indices = [index.value(values) for index in self.indices]
        return variable.values[values.place(variable, indices, self.column)]

    def value(self, values: Values) -> float:
        found = self.scalar(values)
        if isinstance(found, str):
            raise values.fault(faults.NUMBER_EXPECTED, self.column, what=self.name)
        return found

    def assign(self, values: Values, value: Scalar) -> None:
        indices = [index.value(values) for index in self.indices]
        values.assign(self.name, indices, value, self.column)


class Readable(Node):
    """V.A.ABS.X: state of axes and channel. `units`: the axis, or expressions for an index."""

    def __init__(self, column: int, name: str, reading: Reading, units: Sequence[Node | str]) -> None:
        super().__init__(column)
        self.name, self.reading, self.units = name, reading, units
        self.may_be_text = True

    def given(self, values: Values) -> list[Scalar]:
        return [unit if isinstance(unit, str) else unit.value(values) for unit in self.units]

    def scalar(self, values: Values) -> Scalar:
        return self.reading.read(values, self.given(values), self.column)

    def value(self, values: Values) -> float:
        found = self.scalar(values)
        if isinstance(found, str):
            raise values.fault(faults.NUMBER_EXPECTED, self.column, what=shown(found))
        return found

    def assign(self, values: Values, value: Scalar) -> None:
        if self.reading.write is None:
            raise values.fault(faults.NOT_ASSIGNABLE, self.column, name=self.name)
        self.reading.write(values, self.given(values), value, self.column)


class Argument(Node):
    """@P1, @DEPTH: what the call has given; `default` if it has given nothing."""

    def __init__(self, column: int, name: str) -> None:
        super().__init__(column)
        self.name = name
        self.may_be_text = True

    def scalar(self, values: Values) -> Scalar:
        found = values.arguments.get(self.name)
        if found is None:
            raise values.fault(faults.PARAMETER_UNSET, self.column, name=f"@{self.name}")
        return found

    def value(self, values: Values) -> float:
        found = self.scalar(values)
        if isinstance(found, str):
            raise values.fault(faults.NUMBER_EXPECTED, self.column, what=f"@{self.name}")
        return found


class Negative(Node):
    def __init__(self, column: int, operand: Node) -> None:
        super().__init__(column)
        self.operand = operand

    def value(self, values: Values) -> float:
        return -self.operand.value(values)


class Binary(Node):
    """Two operands with an operator between them, at its column."""

    def __init__(self, column: int, left: Node, right: Node) -> None:
        super().__init__(column)
        self.left, self.right = left, right


class Add(Binary):
    """Sum of two numbers; with a text among them, one after the other."""

    def __init__(self, column: int, left: Node, right: Node) -> None:
        super().__init__(column, left, right)
        self.may_be_text = left.may_be_text or right.may_be_text

    def value(self, values: Values) -> float:
        if not self.may_be_text:
            return self.finite(values, self.left.value(values) + self.right.value(values), "+")
        found = self.scalar(values)
        if isinstance(found, str):
            raise values.fault(faults.NUMBER_EXPECTED, self.column, what=shown(found))
        return found

    def scalar(self, values: Values) -> Scalar:
        left, right = self.left.scalar(values), self.right.scalar(values)
        if not isinstance(left, str) and not isinstance(right, str):
            return self.finite(values, left + right, "+")
        joined = plain(left) + plain(right)
        if len(joined) > LONGEST_TEXT:
            words = {"length": len(joined), "limit": LONGEST_TEXT}
            raise values.fault(faults.TEXT_TOO_LONG, self.column, name="+", **words)
        return joined


def plain(value: Scalar) -> str:
    """As a message has it."""
    return value if isinstance(value, str) else number(value)


class Subtract(Binary):
    def value(self, values: Values) -> float:
        return self.finite(values, self.left.value(values) - self.right.value(values), "-")


class Multiply(Binary):
    def value(self, values: Values) -> float:
        return self.finite(values, self.left.value(values) * self.right.value(values), "*")


class Divide(Binary):
    def value(self, values: Values) -> float:
        dividend, divisor = self.left.value(values), self.right.value(values)
        if divisor == 0.0:
            raise values.fault(faults.DIVISION_BY_ZERO, self.column)
        return self.finite(values, dividend / divisor, "/")


class Modulo(Binary):
    """Rest of the division of two integers, with the sign of the dividend."""

    def value(self, values: Values) -> float:
        dividend, divisor = self.left.integer(values, "MOD"), self.right.integer(values, "MOD")
        if divisor == 0:
            raise values.fault(faults.DIVISION_BY_ZERO, self.column)
        rest = abs(dividend) % abs(divisor)
        return float(rest if dividend >= 0 else -rest)


class Power(Binary):
    def value(self, values: Values) -> float:
        base, exponent = self.left.value(values), self.right.value(values)
        try:
            return self.finite(values, power(base, exponent), "**")
        except ValueError:
            undefined = {"base": number(base), "exponent": number(exponent)}
            raise values.fault(faults.POWER_UNDEFINED, self.column, **undefined) from None
        except OverflowError:
            raise values.fault(faults.OVERFLOW, self.column, operation="**") from None


class And(Binary):
    """The second operand is evaluated only if the first one is true."""

    def value(self, values: Values) -> float:
        return 1.0 if self.left.holds(values) and self.right.holds(values) else 0.0


class Or(Binary):
    """The second operand is evaluated only if the first one is false."""

    def value(self, values: Values) -> float:
        return 1.0 if self.left.holds(values) or self.right.holds(values) else 0.0


class Xor(Binary):
    def value(self, values: Values) -> float:
        return 1.0 if self.left.holds(values) != self.right.holds(values) else 0.0


class Bits(Binary):
    """&, |, ^ of two integers."""

    def __init__(self, column: int, left: Node, right: Node, operator: str) -> None:
        super().__init__(column, left, right)
        self.operator = operator

    def value(self, values: Values) -> float:
        left, right = self.left.integer(values, self.operator), self.right.integer(values, self.operator)
        if self.operator == "&":
            return float(left & right)
        return float(left | right) if self.operator == "|" else float(left ^ right)


class Equal(Binary):
    """Of two numbers or two texts."""

    def value(self, values: Values) -> float:
        return 1.0 if self.equal(values) else 0.0

    def equal(self, values: Values) -> bool:
        left, right = self.left.scalar(values), self.right.scalar(values)
        if isinstance(left, str) != isinstance(right, str):
            wrong = self.left if isinstance(left, str) else self.right
            raise values.fault(faults.NUMBER_EXPECTED, wrong.column, what=shown(wrong.scalar(values)))
        return left == right


class NotEqual(Equal):
    def value(self, values: Values) -> float:
        return 0.0 if self.equal(values) else 1.0


class Less(Binary):
    def value(self, values: Values) -> float:
        return 1.0 if self.left.value(values) < self.right.value(values) else 0.0


class LessOrEqual(Binary):
    def value(self, values: Values) -> float:
        return 1.0 if self.left.value(values) <= self.right.value(values) else 0.0


class Greater(Binary):
    def value(self, values: Values) -> float:
        return 1.0 if self.left.value(values) > self.right.value(values) else 0.0


class GreaterOrEqual(Binary):
    def value(self, values: Values) -> float:
        return 1.0 if self.left.value(values) >= self.right.value(values) else 0.0


class Call(Node):
    """A function of numbers. Its operation gives NaN where it is not defined, infinity beyond the range."""

    def __init__(
        self, column: int, name: str, arguments: Sequence[Node], operation: Callable[[Sequence[float]], float]
    ) -> None:
        super().__init__(column)
        self.name, self.arguments, self.operation = name, arguments, operation

    def value(self, values: Values) -> float:
        given = [argument.value(values) for argument in self.arguments]
        result = self.operation(given)
        if result != result:
            of = ", ".join(number(value) for value in given)
            raise values.fault(faults.DOMAIN, self.column, function=self.name, value=of)
        return self.finite(values, result, self.name)


class TextCall(Node):
    """A function with texts among its arguments or as its result; `kinds` of its arguments: t text, n number."""

    def __init__(
        self,
        column: int,
        name: str,
        arguments: Sequence[Node],
        kinds: str,
        operation: Callable[[Sequence[Scalar]], Scalar],
    ) -> None:
        super().__init__(column)
        self.name, self.arguments, self.kinds, self.operation = name, arguments, kinds, operation
        self.may_be_text = True

    def scalar(self, values: Values) -> Scalar:
        given: list[Scalar] = []
        for argument, kind in zip(self.arguments, self.kinds, strict=False):
            found = argument.scalar(values)
            if kind == "t" and not isinstance(found, str):
                raise values.fault(faults.TEXT_EXPECTED, argument.column)
            if kind == "n" and isinstance(found, str):
                raise values.fault(faults.NUMBER_EXPECTED, argument.column, what=shown(found))
            given.append(found)
        result = self.operation(given)
        if not isinstance(result, str) and result != result:
            of = ", ".join(shown(value) for value in given)
            raise values.fault(faults.DOMAIN, self.column, function=self.name, value=of)
        if isinstance(result, str) and len(result) > LONGEST_TEXT:
            words = {"length": len(result), "limit": LONGEST_TEXT}
            raise values.fault(faults.TEXT_TOO_LONG, self.column, name=self.name, **words)
        return result

    def value(self, values: Values) -> float:
        found = self.scalar(values)
        if isinstance(found, str):
            raise values.fault(faults.NUMBER_EXPECTED, self.column, what=shown(found))
        return found


class Exists(Node):
    """EXIST[V.P.NAME]: whether a variable or an argument is there."""

    def __init__(self, column: int, asked: "SelfDefined | Argument | Parameter") -> None:
        super().__init__(column)
        self.asked = asked

    def value(self, values: Values) -> float:
        asked = self.asked
        if isinstance(asked, SelfDefined):
            return 1.0 if asked.name in values.scope(asked.name) else 0.0
        if isinstance(asked, Argument):
            return 1.0 if asked.name in values.arguments else 0.0
        return 1.0 if asked.index in values.parameters or f"P{asked.index}" in values.program else 0.0
