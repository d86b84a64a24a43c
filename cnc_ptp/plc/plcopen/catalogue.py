"""Function blocks with `execute` as data: those of axes and spindles, with what must and may be given to them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from cnc_ptp.errors import CncError, nearest_name
from cnc_ptp.plc.plcopen.administration import MC_Reset, MC_SetPosition, MC_WriteParameter
from cnc_ptp.plc.plcopen.coupling import MC_CamIn, MC_CamOut, MC_GearIn, MC_GearOut
from cnc_ptp.plc.plcopen.external import MC_ExtSetPointGenDisable, MC_ExtSetPointGenEnable
from cnc_ptp.plc.plcopen.motion import (
    MC_Halt,
    MC_Home,
    MC_MoveAbsolute,
    MC_MoveAdditive,
    MC_MoveModulo,
    MC_MoveRelative,
    MC_MoveSuperimposed,
    MC_MoveVelocity,
    MC_OrientSpindle,
    MC_Stop,
)
from cnc_ptp.protocol.commands import BAD_ARGUMENT, UNKNOWN_COMMAND


class BlockType(NamedTuple):
    """A function block and its inputs besides `execute`."""

    make: Any
    needed: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()


RAMPS = ("acceleration", "deceleration", "jerk")
DYNAMICS = ("velocity", *RAMPS)
RATIO = ("ratio_numerator", "ratio_denominator")
CAM = ("periodic", "master_offset", "slave_offset", "master_scaling", "slave_scaling")
OF_AXIS: Mapping[str, BlockType] = {
    "MC_Reset": BlockType(MC_Reset),
    "MC_Stop": BlockType(MC_Stop, (), ("deceleration", "jerk")),
    "MC_Halt": BlockType(MC_Halt),
    "MC_Home": BlockType(MC_Home, (), ("position",)),
    "MC_MoveAbsolute": BlockType(MC_MoveAbsolute, ("position",), (*DYNAMICS, "buffer_mode")),
    "MC_MoveRelative": BlockType(MC_MoveRelative, ("distance",), (*DYNAMICS, "buffer_mode")),
    "MC_MoveAdditive": BlockType(MC_MoveAdditive, ("distance",), (*DYNAMICS, "buffer_mode")),
    "MC_MoveModulo": BlockType(MC_MoveModulo, ("position",), (*DYNAMICS, "buffer_mode")),
    "MC_MoveVelocity": BlockType(MC_MoveVelocity, ("velocity",), (*RAMPS, "buffer_mode")),
    "MC_MoveSuperimposed": BlockType(MC_MoveSuperimposed, ("distance",), ("velocity_difference", *RAMPS)),
    "MC_SetPosition": BlockType(MC_SetPosition, ("position",), ("relative",)),
    "MC_WriteParameter": BlockType(MC_WriteParameter, ("parameter", "value")),
    "MC_GearIn": BlockType(MC_GearIn, ("master",), RATIO),
    "MC_GearOut": BlockType(MC_GearOut),
    "MC_CamIn": BlockType(MC_CamIn, ("master", "cam_table"), CAM),
    "MC_CamOut": BlockType(MC_CamOut),
    "MC_ExtSetPointGenEnable": BlockType(MC_ExtSetPointGenEnable, (), ("mode", "position")),
    "MC_ExtSetPointGenDisable": BlockType(MC_ExtSetPointGenDisable),
}
OF_SPINDLE: Mapping[str, BlockType] = {
    "MC_Reset": BlockType(MC_Reset),
    "MC_Stop": BlockType(MC_Stop),
    "MC_Halt": BlockType(MC_Halt),
    "MC_Home": BlockType(MC_Home),
    "MC_MoveVelocity": BlockType(MC_MoveVelocity, ("velocity",), ("buffer_mode",)),
    "MC_OrientSpindle": BlockType(MC_OrientSpindle, ("position",), ("velocity", "direction", "buffer_mode")),
    "MC_GearIn": BlockType(MC_GearIn, ("master",), RATIO),
    "MC_GearOut": BlockType(MC_GearOut),
}
BLOCK_TYPES: Mapping[str, Mapping[str, BlockType]] = {"axis": OF_AXIS, "spindle": OF_SPINDLE}
"""Kind of unit -> name -> function block."""
UNCHANGED = "nothing was changed"


def checked_type(kind: str, unit: str, name: str, inputs: Mapping[str, Any]) -> BlockType:
    """The function block of this name. Raises CncError 22002 (no such block of the unit), 22001 (its inputs)."""
    known = BLOCK_TYPES[kind]
    if name not in known:
        reason = f"unknown function block '{name}'{nearest_name(name, known)}"
        effect = f"{UNCHANGED}. Known: {', '.join(known)}"
        raise CncError(UNKNOWN_COMMAND, reason, effect, where=f"{kind} {unit}", function_block=name)
    where, found = f"{kind} {unit}: {name} refused", known[name]
    has = [*found.needed, *found.optional]
    for each in inputs:
        if each not in has:
            effect = f"{UNCHANGED}. Known: {', '.join(has) or 'none'}"
            raise CncError(BAD_ARGUMENT, f"unknown input '{each}'", effect, where=where, input=each)
    for each in found.needed:
        if each not in inputs:
            raise CncError(BAD_ARGUMENT, f"input '{each}' is missing", UNCHANGED, where=where, input=each)
    return found
