"""Function blocks of PLCopen Motion Control, by the names that PLC programmers know."""

from cnc_ptp.plc.plcopen.administration import MC_Reset, MC_SetPosition, MC_WriteParameter
from cnc_ptp.plc.plcopen.coupling import MC_CamIn, MC_CamOut, MC_GearIn, MC_GearOut
from cnc_ptp.plc.plcopen.external import MC_ExtSetPointGenDisable, MC_ExtSetPointGenEnable, MC_ExtSetPointGenFeed
from cnc_ptp.plc.plcopen.level_block import MC_Power, MC_ReadAxisError, MC_ReadParameter, MC_ReadStatus, MC_SetOverride
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
from cnc_ptp.plc.plcopen.unit_reference import UnitReference

__all__ = [
    "MC_CamIn",
    "MC_CamOut",
    "MC_ExtSetPointGenDisable",
    "MC_ExtSetPointGenEnable",
    "MC_ExtSetPointGenFeed",
    "MC_GearIn",
    "MC_GearOut",
    "MC_Halt",
    "MC_Home",
    "MC_MoveAbsolute",
    "MC_MoveAdditive",
    "MC_MoveModulo",
    "MC_MoveRelative",
    "MC_MoveSuperimposed",
    "MC_MoveVelocity",
    "MC_OrientSpindle",
    "MC_Power",
    "MC_ReadAxisError",
    "MC_ReadParameter",
    "MC_ReadStatus",
    "MC_Reset",
    "MC_SetOverride",
    "MC_SetPosition",
    "MC_Stop",
    "MC_WriteParameter",
    "UnitReference",
]
