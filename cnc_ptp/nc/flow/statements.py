"""Assignments and control statements."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from cnc_ptp.nc.expressions import expression_faults
from cnc_ptp.nc.expressions.nodes import Node, Parameter
from cnc_ptp.nc.expressions.reader import Assignable
from cnc_ptp.nc.expressions.values import Scalar, Values
from cnc_ptp.nc.flow import flow_faults as faults
from cnc_ptp.nc.flow.lines import Flow, Line, Statement
from cnc_ptp.nc.program import NcBlock

ROUNDING: Final = 1e-6
"""Part of the step by which the counter of $FOR may be beyond the end because of rounding."""
EQUAL: Final = 0.001
"""Two numbers of $SWITCH and $CASE are equal if they differ by less, as the vendor has it."""


class Assignment(Statement):
    """P1 = 5, V.P.DEPTH = P1 * 2."""

    def __init__(self, column: int, target: Assignable, value: Node) -> None:
        super().__init__(column)
        self.target, self.value = target, value
        self.parameter = target.index if isinstance(target, Parameter) and not value.may_be_text else -1

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        self.assign(execution.values)
        return None

    def assign(self, values: Values) -> None:
        if self.parameter >= 0:
            if values.arrays:
                values.require_parameter(self.parameter, self.target.column)
            values.parameters[self.parameter] = self.value.value(values)
        else:
            self.target.assign(values, self.value.scalar(values))


class Assignments(Statement):
    """Several in one line, in their order."""

    def __init__(self, column: int, parts: Sequence[Assignment]) -> None:
        super().__init__(column)
        self.parts = parts

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        for part in self.parts:
            part.assign(execution.values)
        return None


class If(Statement):
    """$IF: jumps behind the first of its branches whose condition holds, or behind $ENDIF."""

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        structure = execution.structure(line)
        for branch in structure.branches:
            if branch.condition is None or branch.condition.holds(execution.values):
                execution.go(branch.place)
                return None
        execution.go(structure.after)
        return None


class ShortIf(Statement):
    """$IF condition $GOTO label."""

    def __init__(self, column: int, condition: Node) -> None:
        super().__init__(column)
        self.condition = condition

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        if self.condition.holds(execution.values):
            execution.jump(line)
        return None


class Switch(Statement):
    """$SWITCH: jumps behind the first $CASE of the same value, or behind $DEFAULT, or behind $ENDSWITCH."""

    def __init__(self, column: int, value: Node, assignment: Assignment | None) -> None:
        super().__init__(column)
        self.value, self.assignment = value, assignment

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        if self.assignment is not None:
            self.assignment.assign(execution.values)
        structure = execution.structure(line)
        value = self.value.scalar(execution.values)
        target = structure.after
        for branch in structure.branches:
            if branch.condition is None:
                target = branch.place
            elif same(value, branch.condition.scalar(execution.values)):
                target = branch.place
                break
        execution.go(target)
        return None


def same(a: Scalar, b: Scalar) -> bool:
    if isinstance(a, str) or isinstance(b, str):
        return a == b
    return abs(a - b) < EQUAL


class EndOfBranch(Statement):
    """$ELSE, $ELSEIF reached from above, $BREAK: execution continues behind the structure."""

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        execution.go(execution.structure(line).after)
        return None


class Mark(Statement):
    """$ENDIF, $ENDSWITCH, $CASE, $DEFAULT, $DO, $REPEAT: a place alone."""

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        return None


class While(Statement):
    def __init__(self, column: int, condition: Node) -> None:
        super().__init__(column)
        self.condition = condition

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        if not self.condition.holds(execution.values):
            execution.go(execution.structure(line).after)
        return None


class EndWhile(Statement):
    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        execution.back(execution.structure(line).begin, line)
        return None


class For(Statement):
    """$FOR counter = start, end, step: `end` and `step` are evaluated for each turn."""

    def __init__(self, column: int, counter: Assignable, values: Sequence[Node]) -> None:
        super().__init__(column)
        self.counter, self.parameter = counter, counter.index if isinstance(counter, Parameter) else -1
        self.start, self.end, self.step = values

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        values = execution.values
        start = self.start.value(values)
        self.counter.assign(values, start)
        if not self.turns(values, start):
            execution.go(execution.structure(line).after)
        return None

    def turns(self, values: Values, count: float) -> bool:
        """Whether the loop has a turn for this value of the counter."""
        step = self.step.value(values)
        if step == 0.0:
            raise values.fault(faults.STEP_ZERO, self.step.column)
        beyond = count - self.end.value(values)
        return beyond <= ROUNDING * step if step > 0.0 else beyond >= ROUNDING * step

    def next_turn(self, values: Values) -> bool:
        count = self.counter.finite(values, self.counter.value(values) + self.step.value(values), "$FOR")
        if self.parameter >= 0:
            values.parameters[self.parameter] = count
        else:
            self.counter.assign(values, count)
        return self.turns(values, count)


class EndFor(Statement):
    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        structure = execution.structure(line)
        statement = structure.statement
        if isinstance(statement, For) and statement.next_turn(execution.values):
            execution.back(structure.body, line)
        return None


class EndDo(Statement):
    """$ENDDO condition: again while it holds. $UNTIL condition: again until it holds."""

    def __init__(self, column: int, condition: Node, *, until: bool) -> None:
        super().__init__(column)
        self.condition, self.until = condition, until

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        if self.condition.holds(execution.values) != self.until:
            execution.back(execution.structure(line).body, line)
        return None


class Continue(Statement):
    """$CONTINUE: the last line of the loop is next."""

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        execution.go(execution.structure(line).end)
        return None


class Goto(Statement):
    """$GOTO, after the words of its line."""

    def __init__(self, column: int, words: Statement | None, block: NcBlock | None) -> None:
        super().__init__(column)
        self.words, self.block = words, block

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        block = self.block if self.words is None else self.words.run(execution, line)
        execution.jump(line)
        return block


class Return(Statement):
    """$RETURN: ends the subroutine."""

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        execution.leave(line)
        return None


class Declaration:
    """One line between #VAR and #ENDVAR: a variable or an array, its type and first values."""

    def __init__(
        self,
        column: int,
        name: str,
        sizes: Sequence[Node],
        values: Sequence[Node],
        *,
        type: str,
        longest: int,
    ) -> None:
        self.column = column
        self.name, self.sizes, self.values = name, sizes, values
        self.type, self.longest, self.is_text = type, longest, type == "STRING"

    def declare(self, values: Values) -> None:
        sizes: list[int] = []
        count = 1
        for size in self.sizes:
            elements = size.integer(values, f"the size of {self.name}")
            if elements < 1:
                raise values.fault(expression_faults.SIZE, size.column, name=self.name, size=elements)
            sizes.append(elements)
            count *= elements
        if len(self.values) > count:
            words = {"given": len(self.values), "count": count}
            raise values.fault(expression_faults.TOO_MANY_INITIAL, self.values[count].column, name=self.name, **words)
        if self.name in values.scope(self.name):
            raise values.fault(expression_faults.DECLARED_TWICE, self.column, name=self.name)
        values.reserve(count, self.name, self.column)
        given: list[Scalar] = []
        for node in self.values:
            value = node.scalar(values)
            if isinstance(value, str) != self.is_text:
                fault = expression_faults.TEXT_EXPECTED
                if isinstance(value, str):
                    raise values.fault(expression_faults.NUMBER_EXPECTED, node.column, what="the first value")
                raise values.fault(fault, node.column)
            given.append(value)
        empty: Scalar = "" if self.is_text else 0.0
        if self.name.startswith("P") and not sizes:
            values.parameters[int(self.name[1:])] = float(given[0]) if given else 0.0
            return
        values.declare(self.name, tuple(sizes), [empty] * count, self.column, self.type, self.longest)
        variable = values.variable(self.name, self.column)
        for place, value in enumerate(given):
            variable.values[place] = values.conforming(variable, value, self.values[place].column)


class Declarations(Statement):
    """#VAR ... #ENDVAR."""

    def __init__(self, column: int) -> None:
        super().__init__(column)
        self.lines: list[tuple[Line, Declaration]] = []

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        values = execution.values
        for declared, declaration in self.lines:
            values.source = declared.source
            declaration.declare(values)
        return None


class EndOfModalCall(Statement):
    """#DISABLE MODAL CYCLE."""

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        execution.end_modal_call()
        return None


class Delete(Statement):
    """#DELETE V.P.A, V.L.B."""

    def __init__(self, column: int, names: Sequence[tuple[str, int]]) -> None:
        super().__init__(column)
        self.names = names

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        for name, column in self.names:
            execution.values.delete(name, column)
        return None
