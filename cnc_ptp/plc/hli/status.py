"""What the HLI shows a PLC of each object: fields of <Kind>HliStatus.msg, from the object's block.

Positions and speeds as the project has them (mm, °, rpm) and, beside them, in the integers of the HLI.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.plc.hli.messages import PER_LENGTH, PER_PERCENT, PER_SPEED
from cnc_ptp.plc.hli.object_control import Answered, ObjectControl
from cnc_ptp.protocol.axis_states import AxisStateCode, StatusBit
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, ControlUnitState, SpindleBlock
from cnc_ptp.protocol.control_units import CONTROL_UNITS, PERCENT, SWITCH, ControlUnit
from cnc_ptp.protocol.spindle_states import SpindleBit

Fields = dict[str, Any]
NOTHING = ControlUnitState("", False, 0.0, 0.0)


def status(control: ObjectControl, block: AxisBlock | SpindleBlock | ChannelBlock) -> Fields:
    """The fields of a status message but its header; nested ones as mappings."""
    if isinstance(block, AxisBlock):
        values = axis_values(block)
    elif isinstance(block, SpindleBlock):
        values = spindle_values(block)
    else:
        values = channel_values(block)
    values |= {"cycle": block.first_cycle + block.count - 1, "held": control.holder is not None}
    values |= {"holder": control.holder or "", "error_id": block.error_id[-1], "job": block.job}
    values |= control_units(control)
    if control.kind == "channel":
        values["acknowledge_enable_r"] = control.serves_functions
    else:
        values["external"] = {"command_semaphore": control.command_semaphore, **answer(control.external)}
        values["external"]["job"] = control.external.job
    return values


def control_units(control: ObjectControl) -> Fields:
    """The state of each control unit, as its object has reported it."""
    fields: Fields = {}
    for unit in CONTROL_UNITS[control.kind]:
        state = control.states.get(unit.name, NOTHING)
        if unit.edge:
            fields[unit.name] = {
                "enable_r": state.held,
                "request_r": bool(state.request),
                **answer(control.edges[unit.name]),
            }
        else:
            fields[unit.name] = level_state(unit, state)
    return fields


def level_state(unit: ControlUnit, state: ControlUnitState) -> Fields:
    if unit.value == SWITCH:
        return {"enable_r": state.held, "request_r": bool(state.request), "state_r": bool(state.state)}
    scale = PER_PERCENT if unit.value == PERCENT else 1.0
    return {
        "enable_r": state.held,
        "request_r": state.request,
        "state_r": state.state,
        "request_hli": round(state.request * scale),
        "state_hli": round(state.state * scale),
    }


def answer(answered: Answered) -> Fields:
    return {"count_r": answered.count, "error_id": answered.error_id}


def in_hli(values: Mapping[str, float], scale: float) -> Fields:
    """The same values as integers, with names that end in _hli; 0 for what is none."""
    return {f"{name}_hli": round(value * scale) if isfinite(value) else 0 for name, value in values.items()}


def axis_values(block: AxisBlock) -> Fields:
    lengths = {
        "set_position": block.set_position[-1],
        "actual_position": block.actual_position[-1],
        "following_error": block.following_error[-1],
    }
    speeds = {"set_velocity": block.set_velocity[-1], "actual_velocity": block.actual_velocity[-1]}
    bits, state = block.status_bits[-1], block.state[-1]
    return {
        **lengths,
        **in_hli(lengths, PER_LENGTH),
        **speeds,
        **in_hli(speeds, PER_SPEED),
        "state": state,
        "status_bits": bits,
        "enabled": state not in (AxisStateCode.DISABLED, AxisStateCode.ERROR_STOP),
        "in_position": bool(bits & StatusBit.IN_TARGET_POSITION),
        "moving": block.set_velocity[-1] != 0.0,
        "referenced": not bits & StatusBit.NOT_REFERENCED,
        "feed_withheld": bool(bits & StatusBit.FEED_WITHHELD),
    }


def spindle_values(block: SpindleBlock) -> Fields:
    speeds = {
        "set_speed": block.set_speed_rpm[-1],
        "actual_speed": block.actual_speed_rpm[-1],
        "programmed_speed": block.programmed_speed_rpm[-1],
    }
    positions = {
        "target_position": block.target_position_deg[-1],
        "actual_position": block.actual_position_deg[-1],
        "distance_to_go": block.distance_to_go_deg[-1],
    }
    bits = block.status_bits[-1]
    return {
        **{f"{name}_rpm": value for name, value in speeds.items()},
        **in_hli(speeds, DEG_S_PER_RPM * PER_SPEED),
        **{f"{name}_deg": value for name, value in positions.items()},
        **in_hli(positions, PER_LENGTH),
        "mode": block.mode[-1],
        "state": block.state[-1],
        "speed_monitoring": bool(bits & SpindleBit.MONITORING_ACTIVE),
        "speed_monitoring_invalid": bool(bits & SpindleBit.MONITORING_INVALID),
        "speed_reached": block.speed_reached[-1],
        "stopped": block.speed_zero[-1],
        "in_position": block.in_position[-1],
        "referenced": block.referenced[-1],
        "job_error": bool(bits & SpindleBit.JOB_ERROR),
        "gear": block.gear[-1],
        "gear_request": block.gear_request,
        "source": block.source,
        "plc_commands": block.plc_commands,
        "plc_acknowledged": block.plc_acknowledged,
    }


def channel_values(block: ChannelBlock) -> Fields:
    speeds = {"path_velocity": block.path_velocity[-1], "programmed_feed": block.programmed_feed[-1]}
    lengths = {"distance_to_go": block.distance_to_go[-1]}
    return {
        **speeds,
        **in_hli(speeds, PER_SPEED),
        **lengths,
        **in_hli(lengths, PER_LENGTH),
        "state": block.state[-1],
        "line": block.line[-1],
        "block_number": block.block_number[-1],
        "done": block.done,
        "blocks_done": block.blocks_done,
        "progress": block.progress,
        "time_left": block.time_left,
    }
