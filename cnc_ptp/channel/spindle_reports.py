"""Expected reports of a spindle: does its block show what a channel has commanded? (TF5200 spindle 2.5)

A report counts for the path only while the spindle carries out the command of the channel: a spindle at a
standstill because somebody else has stopped it has reached no speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import isclose, remainder

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name
from cnc_ptp.protocol.blocks import SpindleBlock
from cnc_ptp.protocol.spindle_states import SpindleBit, SpindleMode

SAME_POSITION = 1e-3
"""°"""


class Condition(Enum):
    """The quantity that a spindle has to report."""

    NONE = ""
    SPEED = "the speed of spindle {spindle}"
    STANDSTILL = "the standstill of spindle {spindle}"
    POSITION = "the position of spindle {spindle}"
    GEAR = "gear {value:g} of spindle {spindle}"
    MASTER = "the coupling of spindle {spindle} to {master}"


COMMANDED = {
    Condition.SPEED: "turn at {value:g} rpm",
    Condition.STANDSTILL: "stop",
    Condition.POSITION: "go to {value:g} deg",
    Condition.GEAR: "change to gear {value:g}",
}
"""The command in words, by quantity."""


@dataclass(frozen=True, slots=True)
class Expectation:
    """The report that a spindle (node) owes for a command.

    `value`: speed in rpm (+ = M03), position in ° modulo `turn`, or gear stage; `master`: node of its master.
    """

    spindle: str = ""
    condition: Condition = Condition.NONE
    value: float = 0.0
    turn: float = 360.0
    master: str = ""

    def carried_out(self, block: SpindleBlock) -> bool:
        """At the end of its block the spindle carries out the command, or has carried it out."""
        state, mode = block.state[-1], block.mode[-1]
        match self.condition:
            case Condition.SPEED:
                commanded = block.programmed_speed_rpm[-1]
                return state == S.CONTINUOUS_MOTION and isclose(commanded, self.value, rel_tol=1e-9, abs_tol=1e-9)
            case Condition.STANDSTILL:
                return state != S.CONTINUOUS_MOTION
            case Condition.POSITION if state == S.STANDSTILL:
                away = remainder(block.target_position_deg[-1] - self.value, self.turn)
                return mode == SpindleMode.POSITION and abs(away) <= SAME_POSITION
            case Condition.POSITION:
                return state in (S.DISCRETE_MOTION, S.HOMING)
            case Condition.GEAR:
                return block.gear[-1] == self.value
        return True

    def reached(self, block: SpindleBlock) -> bool:
        """It reports speed, standstill or position, and nothing else precedes that; a stop (M05) never waits."""
        if self.condition is not Condition.STANDSTILL and must_wait(block):
            return False
        match self.condition:
            case Condition.SPEED:
                return bool(block.speed_reached[-1])
            case Condition.STANDSTILL:
                return bool(block.speed_zero[-1]) and block.state[-1] not in (S.HOMING, S.DISCRETE_MOTION)
            case Condition.POSITION:
                return bool(block.in_position[-1])
        return True

    def awaited(self) -> str:
        """What is waited for, in words."""
        return self.condition.value.format(spindle=self.spindle, value=self.value, master=self.master)

    def missed(self) -> str:
        """The command that the spindle does not carry out, for the text of an error or a warning."""
        commanded = COMMANDED[self.condition].format(value=self.value)
        return f"spindle {self.spindle} does not {commanded} as commanded"


NOTHING = Expectation()


def commands_wait(block: SpindleBlock) -> bool:
    """Commands wait in the spindle; the one in question may be among them."""
    return bool(block.status_bits[-1] & SpindleBit.ORDERS_WAIT)


def must_wait(block: SpindleBlock) -> bool:
    """The path has to wait: commands wait in the spindle, or a gear is changed, after which its rotation continues."""
    return commands_wait(block) or block.gear_change_active[-1]


def stands(block: SpindleBlock, channel: str) -> bool:
    """At a standstill without a job: nothing waits, no gear is changed, nothing is active for `channel`."""
    return block.state[-1] in (S.STANDSTILL, S.DISABLED) and not must_wait(block) and block.source != channel


def turns(block: SpindleBlock) -> bool:
    """In endless rotation."""
    return block.state[-1] == S.CONTINUOUS_MOTION


def current_activity(block: SpindleBlock) -> str:
    """What the spindle does instead of the command, in words."""
    state = block.state[-1]
    if block.gear_change_active[-1]:
        return "its gear is being changed"
    if state == S.CONTINUOUS_MOTION:
        return f"it was commanded to {block.programmed_speed_rpm[-1]:g} rpm"
    if state == S.STANDSTILL and block.mode[-1] == SpindleMode.POSITION:
        return f"it was commanded to {block.target_position_deg[-1]:g} deg"
    return f"it is in {state_name(S(state))}"
