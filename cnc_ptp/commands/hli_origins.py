"""The objects of the HLI for people: what each control unit does, what TwinCAT calls it, where the manuals have it.

What they are (values, edge or level, commands) says protocol/control_units.py; docs/hli_objects.md is made from both
and from the comments of the messages. Names of TwinCAT are those of the public HLI documentation below gpAx[i]^ and
gpCh[i]^, and of the older one (StateBahn_Data); PlcToNc and NcToPlc are the cyclic interface of an NC axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class Origin(NamedTuple):
    """Name in TwinCAT, empty where none is known; page of the spindle manual (TF5200) or chapter of TX1250."""

    twincat: str = ""
    manual: str = ""


class UnitText(NamedTuple):
    """What a control unit does, and where it comes from."""

    meaning: str
    origin: Origin


HOLD = "stops the motion on its ramp; it continues when the hold is off"
NO_OVERRIDE = "off: 100 % instead of the override (P-AXIS-00109, P-CHAN-00056 if that is less)"
ENABLE = "power; the axis is enabled while drive_ready is on too"
READY = "the drive may be enabled (contactor, brake); off: as controller enable off"
EMERGENCY = (
    "on: to standstill at once, ErrorStop 26168; acts while the PLC or anybody else wants it, and blocks the reset"
)
OVERRIDE = Origin("ipo_mc_control.override", "p. 26")
VALID = Origin("ipo_mc_control.override_valid", "p. 26")
FEED_ENABLE = "lr_mc_control.release_feedhold"
MODE = Origin("channel_mc_control.mode_and_state")
DRIVE_ON = Origin("drive_on, torque_permission; PlcToNc.ControlDWord.0", "TX1250 2.1, 2.6")
DRIVE_READY = Origin("ready_for_power_on_r (from the drive)", "TX1250 2.6")
ALIVE = Origin("head.mc_watchdog")

UNIT_TEXTS: Mapping[str, Mapping[str, UnitText]] = {
    "axis": {
        "feed_hold": UnitText(f"{HOLD}; on a path, all of the path", Origin("ipo_mc_control.feedhold")),
        "override": UnitText("override of PTP motion", OVERRIDE),
        "override_valid": UnitText(NO_OVERRIDE, VALID),
        "controller_enable": UnitText(ENABLE, DRIVE_ON),
        "drive_ready": UnitText(READY, DRIVE_READY),
        "feed_enable_forward": UnitText(
            "motion towards greater positions",
            Origin("PlcToNc.ControlDWord.1, lr_mc_control.release_feedhold", "TX1250 2.1, 2.6"),
        ),
        "feed_enable_backward": UnitText(
            "motion towards smaller positions",
            Origin("PlcToNc.ControlDWord.2, lr_mc_control.release_feedhold", "TX1250 2.1, 2.6"),
        ),
        "emergency_stop": UnitText(f"{EMERGENCY}; on the emergency ramp P-AXIS-00003", Origin("", "TX1250 2.2")),
        "reset": UnitText("leaves ErrorStop at a standstill", Origin("MC_Reset")),
    },
    "spindle": {
        "feed_hold": UnitText(f"{HOLD}; G167 does not suppress it", Origin("ipo_mc_control.feedhold")),
        "override": UnitText("override of rotation and positioning", OVERRIDE),
        "override_valid": UnitText(NO_OVERRIDE, VALID),
        "controller_enable": UnitText(ENABLE.replace("axis", "spindle"), DRIVE_ON),
        "drive_ready": UnitText(READY, DRIVE_READY),
        "stop_at_program_end": UnitText(
            "the spindle stops at M30", Origin("ipo_mc_control.spdl_stop_at_prog_end", "p. 26, 60")
        ),
        "emergency_stop": UnitText(f"{EMERGENCY}; on the ramp of rotation", Origin()),
        "reset": UnitText(
            "leaves ErrorStop; otherwise stops the spindle", Origin("ipo_mc_control.spdl_reset", "p. 60")
        ),
        "gear_changed": UnitText(
            "the gear of gear_request is in; served, the machine no longer says so on its own", Origin("", "p. 35 – 38")
        ),
    },
    "channel": {
        "feed_hold": UnitText(f"{HOLD}", Origin("feed hold of the channel")),
        "override": UnitText("override of the path", Origin("override of the channel")),
        "override_valid": UnitText(NO_OVERRIDE, Origin()),
        "single_block": UnitText(
            "0 off, 1 stops after each block, 2 after each motion", Origin("MCControlDecoder_Data: SingleBlock")
        ),
        "optional_stop": UnitText("M01 stops", Origin("m01_stop_enable")),
        "block_skip": UnitText(
            "bit n - 1: blocks with skip level n are left out, from the next start on",
            Origin("decoder_mc_control.program_block_ignore"),
        ),
        "emergency_stop": UnitText(f"{EMERGENCY}; the program is aborted", Origin()),
        "reset": UnitText("aborts the program, clears the error", MODE),
        "start": UnitText(
            "starts the program, or resumes it after M00, M01, single block",
            Origin("channel_mc_control.mode_and_state"),
        ),
        "measuring_event": UnitText("the event that MNE_SNS and measuring runs wait for", Origin("", "p. 27")),
    },
}
"""Kind of object, control unit."""

OF_ALL: Mapping[str, Origin] = {
    "valid": Origin("head.plc_present_w"),
    "life_sign": ALIVE,
    "error_id": Origin("head.error_r"),
}
ORIGINS: Mapping[str, Mapping[str, Origin]] = {
    "axis": {
        "external": Origin("external commanding of the axis", "TX1250 2.1 – 2.3"),
        "set_position": Origin("lr_state.active_position_acs_r; NcToPlc.SetPos", "TX1250 2.1, 4.3"),
        "actual_position": Origin("lr_state.current_position_acs_r; NcToPlc.ActPos", "TX1250 2.1, 4.3"),
        "following_error": Origin("NcToPlc.PosDiff", "TX1250 4.3"),
        "set_velocity": Origin("NcToPlc.SetVelo", "TX1250 4.3"),
        "actual_velocity": Origin("NcToPlc.ActVelo", "TX1250 4.3"),
        "state": Origin("lr_state.axis_state_r; NcToPlc.AxisState"),
        "status_bits": Origin("NcToPlc.StateDWord", "TX1250 2.6"),
        "enabled": Origin("NcToPlc.StateDWord.0", "TX1250 4.3"),
        "in_position": Origin("NcToPlc.StateDWord.4", "TX1250 4.3"),
        "moving": Origin("not NcToPlc.StateDWord.2", "TX1250 4.3"),
        "referenced": Origin("NcToPlc.StateDWord.1", "TX1250 4.3"),
        "feed_withheld": Origin("lr_state.axis_state_r = HLI_AXIS_HOLD"),
        "error_id": Origin("head.error_r; NcToPlc.ErrorCode", "TX1250 4.3"),
        "job": Origin("NcToPlc.StateDWord.8", "TX1250 4.3"),
    },
    "spindle": {
        "external": Origin("ipo_mc_control.ext_to_ipo", "p. 11, 60"),
        "set_speed": Origin("lr_state.active_rev_r", "p. 60"),
        "actual_speed": Origin("lr_state.current_rev_r", "p. 60"),
        "programmed_speed": Origin("lr_state.cmd_rev_r", "p. 60"),
        "target_position": Origin("lr_state.end_position_acs_r", "p. 60"),
        "actual_position": Origin("lr_state.current_position_acs_r", "p. 60"),
        "distance_to_go": Origin("distance to go", "p. 60"),
        "mode": Origin("ipo_state.spindle.mode_r", "p. 23, 60"),
        "state": Origin("operating state", "p. 23, 60"),
        "speed_monitoring": Origin("lr_state.rev_control_aktiv_r", "p. 31, 60"),
        "speed_monitoring_invalid": Origin("speed monitoring invalid", "p. 60"),
        "speed_reached": Origin("lr_state.rev_erreicht_r", "p. 31, 60"),
        "stopped": Origin("lr_state.rev_null_r", "p. 31, 60"),
        "referenced": Origin("", "p. 32"),
        "job_error": Origin("job error", "p. 60"),
        "gear": Origin("", "p. 35 – 38"),
        "gear_request": Origin("", "p. 35 – 38"),
        "source": Origin("", "p. 11"),
        "plc_commands": Origin("", "p. 11"),
        "plc_acknowledged": Origin("", "p. 11"),
    },
    "channel": {
        "acknowledge": Origin("techno_unit_std_sync, techno_unit_late_sync", "p. 27, 28"),
        "acknowledge_enable_r": Origin("", "p. 27, 28"),
        "requests": Origin("techno_unit_std_sync, techno_unit_late_sync", "p. 27, 28"),
        "state": MODE,
        "line": Origin("mc_block_count_r"),
        "path_velocity": Origin("bahn_state.active_feed_r; StateBahn_Data.D_ActiveFeed"),
        "programmed_feed": Origin("StateBahn_Data.D_CommandFeed"),
        "distance_to_go": Origin("bahn_state.covered_distance_r, a share of the block"),
        "done": Origin("StateBahn_Data.X_ProgramEnd"),
    },
}
"""Kind of object, field of its messages that is no control unit; `set_speed` is set_speed_rpm and set_speed_hli."""


def origin(kind: str, field: str) -> Origin:
    """Where a field of the messages comes from."""
    for name in (field, field.removesuffix("_hli"), field.removesuffix("_rpm"), field.removesuffix("_deg")):
        if name in ORIGINS[kind]:
            return ORIGINS[kind][name]
        if name in UNIT_TEXTS[kind]:
            return UNIT_TEXTS[kind][name].origin
    return OF_ALL.get(field, Origin())
