"""Function blocks that act while their input `enable` is true (PLCopen Motion Control part 1, 2.4.1)."""

from __future__ import annotations

from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare.declarations import ParameterValue
from cnc_ptp.plc.plcopen.unit_reference import UnitReference, unit_of
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import AxisBlock, SpindleBlock

OFF = -1
"""State before the first block."""


class LevelBlock:
    """A function block that acts while its input `enable` is true.

    `busy` from the first call with `enable` to the last one, or to an error. Errors last until `enable` falls.
    """

    def __init__(self, unit: UnitReference) -> None:
        self.unit = unit_of(self, unit)
        self.enable = False
        """The input, as in the last call."""
        self.busy = False
        self.error = False
        self.error_id = 0
        self.error_text = ""

    def _works(self, enable: bool) -> bool:
        """Takes `enable`; False while the block is off, or stays in an error."""
        self.enable = bool(enable)
        if not self.enable:
            self.error, self.error_id, self.error_text = False, 0, ""
        self.busy = self.enable and not self.error
        return self.busy

    def _fail(self, error_id: int, text: str) -> None:
        self.busy = False
        self.error, self.error_id, self.error_text = True, error_id, text


class Order:
    """A command that is given when its arguments change, and its answer."""

    def __init__(self, unit: UnitReference, command: str) -> None:
        self._unit = unit
        self._command = command
        self._arguments: dict[str, Any] = {}
        self._ticket = 0
        self.answered = False
        self.error_id = 0
        self.error_text = ""

    def give(self, **arguments: Any) -> None:
        """NaN is one value here: it is refused once, not given again in each cycle."""
        if repr(arguments) == repr(self._arguments):
            self._look()
            return
        self._arguments = arguments
        self._ticket = self._unit.give(self._command, **arguments)
        self.answered, self.error_id, self.error_text = False, 0, ""

    def assume(self, **arguments: Any) -> None:
        """The unit is as commanded already."""
        self._arguments, self.answered = arguments, True

    @property
    def given(self) -> bool:
        return bool(self._arguments)

    def forget(self) -> None:
        """The next `give` gives the command in any case."""
        self._arguments = {}

    def _look(self) -> None:
        answer = None if self.answered else self._unit.answer(self._ticket)
        if answer is not None:
            self.answered, self.error_id, self.error_text = True, answer.error_id, answer.message


class MC_Power:
    """Enable of an axis or spindle while `enable` is true, and the feed releases of an axis."""

    def __init__(self, unit: UnitReference) -> None:
        self.unit = unit_of(self, unit)
        self.enable = False
        self.status = False
        """The unit has its enable."""
        self.valid = False
        """The unit has taken the inputs."""
        self.busy = False
        self.error = False
        self.error_id = 0
        self.error_text = ""
        self._power = Order(unit, "power")
        self._release = Order(unit, "set_feed_release")

    def __call__(self, enable: bool, enable_positive: bool = True, enable_negative: bool = True) -> None:
        self.enable = bool(enable)
        orders, state = [self._power], state_of(self.unit)
        if state == OFF:
            self.busy = True
            return
        if not self._power.given and self.enable and state not in (S.DISABLED, S.ERROR_STOP):
            self._power.assume(enabled=True)
        self._power.give(enabled=self.enable)
        withheld = not (enable_positive and enable_negative)
        if self._release.given or withheld:  # both are released where nobody has said anything
            orders.append(self._release)
            self._release.give(forward=bool(enable_positive), backward=bool(enable_negative))
        refused = next((order for order in orders if order.error_id), None)
        self.error = refused is not None
        self.error_id, self.error_text = (refused.error_id, refused.error_text) if refused is not None else (0, "")
        answered = all(order.answered for order in orders)
        self.valid, self.busy = answered and not self.error, not (answered or self.error)
        self.status = state != S.DISABLED and (self.enable or state != S.ERROR_STOP)


class MC_SetOverride(LevelBlock):
    """Override of the unit while `enable` is true: `factor` 1 is 100 %. The last one holds when `enable` falls."""

    def __init__(self, unit: UnitReference) -> None:
        super().__init__(unit)
        self.enabled = False
        """The unit has taken the factor."""
        self._override = Order(unit, "set_override")

    def __call__(self, enable: bool, factor: float = 1.0) -> None:
        self.enabled = False
        if not self.enable and enable:
            self._override.forget()
        if not self._works(enable):
            return
        self._override.give(percent=100.0 * factor)
        if self._override.error_id:
            self._fail(self._override.error_id, self._override.error_text)
        self.enabled = self._override.answered and not self.error


class MC_ReadStatus(LevelBlock):
    """The state of an axis or spindle, as of its newest block: one output is true."""

    def __init__(self, unit: UnitReference) -> None:
        super().__init__(unit)
        self.valid = False
        self._state = OFF

    def __call__(self, enable: bool) -> None:
        self._state = state_of(self.unit) if self._works(enable) else OFF
        self.valid = self._state != OFF

    @property
    def disabled(self) -> bool:
        return self._state == S.DISABLED

    @property
    def standstill(self) -> bool:
        return self._state == S.STANDSTILL

    @property
    def homing(self) -> bool:
        return self._state == S.HOMING

    @property
    def discrete_motion(self) -> bool:
        return self._state == S.DISCRETE_MOTION

    @property
    def continuous_motion(self) -> bool:
        return self._state == S.CONTINUOUS_MOTION

    @property
    def synchronized_motion(self) -> bool:
        return self._state == S.SYNCHRONIZED_MOTION

    @property
    def stopping(self) -> bool:
        return self._state == S.STOPPING

    @property
    def error_stop(self) -> bool:
        return self._state == S.ERROR_STOP


class MC_ReadAxisError(LevelBlock):
    """The error of a unit, as of its newest block; 0 is none."""

    def __init__(self, unit: UnitReference) -> None:
        super().__init__(unit)
        self.valid = False
        self.axis_error_id = 0

    def __call__(self, enable: bool) -> None:
        block = self.unit.block if self._works(enable) else None
        self.valid = isinstance(block, (AxisBlock, SpindleBlock))
        self.axis_error_id = block.error_id[-1] if isinstance(block, (AxisBlock, SpindleBlock)) else 0


class MC_ReadParameter(LevelBlock):
    """A parameter in the unit of its list, by P number or name."""

    def __init__(self, unit: UnitReference) -> None:
        super().__init__(unit)
        self.valid = False
        self.value: ParameterValue = 0.0

    def __call__(self, enable: bool, parameter: str = "") -> None:
        self.valid = False
        if not self._works(enable):
            return
        try:
            self.value = self.unit.parameter(parameter)
            self.valid = True
        except CncError as error:
            self._fail(error.number, error.message)


def state_of(unit: UnitReference) -> int:
    """PLCopen state of an axis or spindle at the end of its newest block."""
    block = unit.block
    return block.state[-1] if isinstance(block, (AxisBlock, SpindleBlock)) else OFF
