"""Texts of the commands and arguments of `COMMANDS` for the reference (docs/commands.md)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class ArgumentText(NamedTuple):
    """Unit and meaning of an argument, and the effect of leaving it out ("" if it is required)."""

    unit: str
    meaning: str
    left_out: str = ""


OVERLAY = "an external PLC serves a control unit, or gives it back ([plc_hli.md](plc_hli.md))"
COMMAND_TEXTS: Mapping[str, Mapping[str, str]] = {
    "axis": {
        "power": "enable",
        "reset": "leaves ErrorStop at a standstill; a stop in DiscreteMotion and ContinuousMotion",
        "set_feed_release": "feed release of each direction",
        "feed_hold": "stops positioning and path on their ramps, and resumes them",
        "move_absolute": "positioning to a target",
        "move_relative": "positioning over a distance from the set position",
        "move_modulo": "positioning within a turn, modulo axes",
        "move_additive": "positioning over a distance from the target of the last positioning",
        "move_velocity": "moves at a velocity until another motion comes",
        "move_superimposed": "adds a distance to the basic motion",
        "halt_superimposed": "ends the superimposed motion on its ramp",
        "set_position": "other coordinates for the axis, which does not move",
        "set_override": "override of PTP motion",
        "set_override_type": "to which velocity the override applies",
        "stop": "stops on the ramp; new targets wait until the axis is at a standstill",
        "halt": "stops on the ramp; a new target acts immediately",
        "jog": "moves at a velocity until the next one; 0 ends the jog",
        "home": "homing (G74): reference cam, zero pulse; by the drive with P-AXIS-00299 = DRIVE_CONTROLLED",
        "emergency_stop": "stops on a ramp of its own, never weaker than that of the start",
        "new_target": "new target on the fly",
        "new_velocity_and_target": "new target immediately, new velocity from a position on",
        "compensation_start": "position compensation: an additional distance within a length of the motion",
        "compensation_stop": "ends the compensation on its ramp",
        "external_enable": "external setpoints on",
        "external_disable": "external setpoints off",
        "external_setpoints": "external setpoints, one per cycle",
        "couple": "linear slave",
        "couple_gantry": "gantry: linear slave of factor 1 with monitored actual positions",
        "couple_cyclic": "slave with a factor that is set cyclically",
        "couple_flying_saw": "synchronises with a moving master from given positions on",
        "couple_cam": "follows a cam table",
        "change_cam": "new table at the end of the active one",
        "set_coupling_factor": "new factor of a linear slave",
        "set_cyclic_factor": "new factor of a cyclic slave",
        "decouple": "ends the coupling, in motion too",
        "write_parameter": "changes a parameter until the end of the run",
        "set_feedforward": "switches and weights feedforward",
        "reset_feedforward": "feedforward off, weight 100 %",
        "set_friction_compensation": "switches friction compensation",
        "read_drive_parameter": "reads a parameter of a SERCOS drive; the answer holds it",
        "write_drive_parameter": "writes a parameter of a SERCOS drive; S-0-0148 = 3 lets the drive home the axis",
        "overlay": OVERLAY,
    },
    "spindle": {
        "power": "enable",
        "start": "M03, M04: endless rotation",
        "set_speed": "S: new speed in the same direction",
        "stop": "M05",
        "orient": "M19: positioning",
        "home": "G74: homing",
        "set_override": "override of speed and positioning",
        "suppress_override": "override without effect (G167)",
        "feed_hold": "stops the spindle on its ramp, and lets it turn again",
        "select_gear": "M40 … M45: requests a gear change",
        "gear_changed": "the PLC has changed the gear",
        "set_limits": "limits of a tool",
        "reset_limits": "ends the limits of the tool",
        "stop_at_program_end": "whether the spindle stops at M30",
        "couple": "synchronous operation with a master",
        "decouple": "ends synchronous operation",
        "set_feedforward": "switches and weights feedforward",
        "reset_feedforward": "feedforward off, weight 100 %",
        "reset": "leaves ErrorStop at a standstill",
        "overlay": OVERLAY,
    },
    "channel": {
        "load": "reads and checks an NC program",
        "start": "starts the program at its beginning, a line or block; resumes it after M00, M01, single block",
        "feed_hold": "stops the path on its ramp, and resumes it",
        "set_override": "override of the path",
        "single_block": "stops after each NC block, or after each motion",
        "optional_stop": "whether M01 stops",
        "block_skip": "whether blocks with `/` are left out, from the next start on",
        "reset": "aborts the program; path and spindles stop on their ramps",
        "mdi": "executes NC text (manual data input)",
        "acknowledge": "acknowledges a handshake request",
        "measuring_event": "the probe has switched: ends a measuring run (G100), sends functions of type MNE_SNS",
        "set_zero_offset": "a value of a zero offset; it counts when the offset is selected next",
        "teach_zero_offset": "the present position becomes a zero offset",
        "set_clamp_position": "clamp position of the next program",
        "overlay": OVERLAY,
    },
    "plc": {
        "acknowledge": "acknowledges a handshake request of any channel",
        "auto_acknowledge": "whether requests are acknowledged with the next cycle block",
        "set_life_sign": "life sign of the PLC; without it all units stop",
        "set_input": "a value from outside for a [PLC in a file](plc.md#inputs)",
        "serve": "an external PLC answers the functions of a channel, or the gear changes of a spindle",
        "emergency_stop": "everything stops at once and is locked until this is off and each unit was reset",
        "reset": "resets each unit that is in error",
        "stop_all": "stops everything on its ramp",
    },
}

VALUE = ArgumentText("", "switches 0 and 1, overrides in %; 1 has an edge carried out", "with `enabled` off only")
ARGUMENT_TEXTS: Mapping[str, ArgumentText] = {
    "index": ArgumentText("", "of the zero offset: 1 is G54, up to 96"),
    "axis": ArgumentText("", "its name in programs"),
    "value": ArgumentText("mm, °", "offset of the axis"),
    "enabled": ArgumentText("", "on or off"),
    "dialect": ArgumentText("", "vocabulary of the program: twincat or iso", "that of P-CHAN-90010"),
    "files": ArgumentText("", "texts of the programs that it calls, by name", "they are read"),
    "forward": ArgumentText("", "positive direction released"),
    "backward": ArgumentText("", "negative direction released"),
    "target": ArgumentText("mm, °", "position of the axis"),
    "distance": ArgumentText("mm, °", "signed"),
    "position": ArgumentText("°, mm", "sign = direction, magnitude = turns and position within the turn"),
    "velocity": ArgumentText("mm/s, °/s", "largest velocity", "the smaller of P-AXIS-00212 and P-MACH-00008"),
    "acceleration": ArgumentText("mm/s², °/s²", "largest acceleration", "P-AXIS-00001"),
    "deceleration": ArgumentText("mm/s², °/s²", "largest deceleration", "P-AXIS-00002"),
    "jerk": ArgumentText("mm/s³, °/s³", "largest jerk", "P-AXIS-00001 / P-AXIS-00196"),
    "buffer_mode": ArgumentText(
        "", "how it follows an active motion ([ptp.md](ptp.md#buffer-modes))", "only from Standstill"
    ),
    "velocity_difference": ArgumentText(
        "mm/s, °/s", "largest velocity of the addition", "what P-AXIS-00212 leaves beside the basic motion"
    ),
    "relative": ArgumentText("", "`position` is a distance from the actual one", "off"),
    "percent": ArgumentText("%", "override"),
    "type": ArgumentText("", "1 … 4"),
    "activation_position": ArgumentText("mm, °", "where the new velocity starts to act"),
    "length": ArgumentText("mm, °", "length of the basic motion in which the difference is made"),
    "difference": ArgumentText("mm, °", "additional distance, signed"),
    "process_velocity": ArgumentText("mm/s, °/s", "velocity of the basic motion"),
    "velocity_increase": ArgumentText("mm/s, °/s", "largest velocity of the compensation"),
    "mode": ArgumentText("", "what the setpoints count from"),
    "setpoints": ArgumentText("", "rows cycle, position, velocity, acceleration, direction; or `file`"),
    "file": ArgumentText("", "CSV file, relative to the scenario", "the rows are in the command"),
    "master": ArgumentText("", "name of the master"),
    "factor": ArgumentText("", "coupling factor, signed"),
    "difference_limit": ArgumentText("mm, °", "largest difference of the actual positions"),
    "acc_bound": ArgumentText("mm/s², °/s²", "largest acceleration by a change of the factor"),
    "master_position": ArgumentText("mm, °", "master, when both are synchronous"),
    "slave_position": ArgumentText("mm, °", "slave, when both are synchronous"),
    "table": ArgumentText("", "points [master, slave]; or `file`"),
    "cyclic": ArgumentText("", "whether the table is repeated", "on"),
    "master_offset": ArgumentText("mm, °", "of the table", "0"),
    "master_scaling": ArgumentText("", "of the table, not 0", "1"),
    "slave_scaling": ArgumentText("", "of the table, not 0", "1"),
    "slave_offset": ArgumentText("mm, °", "of the table", "from the positions when coupled"),
    "weight_percent": ArgumentText("%", "weight of feedforward, 0 … 100", "unchanged"),
    "direction": ArgumentText("", "of rotation"),
    "speed_rpm": ArgumentText("rpm", "speed"),
    "position_deg": ArgumentText("°", "position"),
    "source": ArgumentText("", "`plc` or a channel: for whom the spindle works", "nobody; acts immediately"),
    "stage": ArgumentText("", "gear 1 … 6"),
    "resume": ArgumentText("", "whether the previous rotation continues", "on"),
    "max_speed_rpm": ArgumentText("rpm", "largest speed", "not limited"),
    "min_speed_rpm": ArgumentText("rpm", "smallest speed in rotation", "not limited"),
    "max_acceleration": ArgumentText("°/s²", "largest acceleration", "not limited"),
    "factor_num": ArgumentText("", "ratio: numerator, signed", "1"),
    "factor_den": ArgumentText("", "ratio: denominator", "1"),
    "program": ArgumentText("", "NC program; file relative to the scenario"),
    "text": ArgumentText("", "NC text"),
    "line": ArgumentText("", "begins at this line", "the beginning"),
    "block_number": ArgumentText("", "begins at the block with this N number", "the beginning"),
    "in_program": ArgumentText("", "of the line or block: one that is called", "the loaded one"),
    "pass_number": ArgumentText("", "of several passes of the line", "the first one"),
    "level": ArgumentText("", "skip level 1 … 10 (`/` is `/1`)", "1"),
    "id": ArgumentText("", "number of the request"),
    "name": ArgumentText("", "of the input"),
    "parameter": ArgumentText("", "P-AXIS-00236 or P-MACH-00014"),
    "idn": ArgumentText("", "`S-0-` and four digits"),
    "control_unit": ArgumentText("", "of the unit ([hli_objects.md](hli_objects.md))"),
    "holder": ArgumentText("", "name of the PLC", "none"),
    "silent": ArgumentText("", "the PLC has fallen silent: its value holds until others command the same", "off"),
    "unit": ArgumentText("", "a channel or a spindle"),
}
"""By name; those that differ for single commands follow below."""

SPECIAL_TEXTS: Mapping[tuple[str, str, str], ArgumentText] = {
    **{(kind, "overlay", "value"): VALUE for kind in ("axis", "spindle", "channel")},
    ("axis", "new_velocity_and_target", "velocity"): ArgumentText("mm/s, °/s", "from the activation position on"),
    ("axis", "home", "position"): ArgumentText("mm, °", "position of the reference point", "P-AXIS-00152"),
    ("axis", "write_drive_parameter", "value"): ArgumentText("", "in digits of the drive"),
    ("axis", "move_velocity", "velocity"): ArgumentText("mm/s, °/s", "sign = direction"),
    ("axis", "set_position", "position"): ArgumentText("mm, °", "the actual position from now on"),
    ("axis", "jog", "velocity"): ArgumentText("mm/s, °/s", "sign = direction"),
    ("axis", "emergency_stop", "deceleration"): ArgumentText("mm/s², °/s²", "of the stop", "that of the start"),
    ("axis", "emergency_stop", "jerk"): ArgumentText("mm/s³, °/s³", "of the stop", "that of the start"),
    ("axis", "compensation_start", "acceleration"): ArgumentText(
        "mm/s², °/s²", "of the compensation alone", "P-AXIS-00001"
    ),
    ("axis", "compensation_start", "deceleration"): ArgumentText(
        "mm/s², °/s²", "of the compensation alone", "P-AXIS-00002"
    ),
    ("axis", "external_enable", "target"): ArgumentText("mm, °", "where the setpoints end", "not monitored"),
    ("channel", "set_clamp_position", "index"): ArgumentText("", "0 to 149, one of the machine file"),
    ("channel", "teach_zero_offset", "axis"): ArgumentText("", "its name in programs", "all axes of the channel"),
    ("channel", "teach_zero_offset", "value"): ArgumentText("mm, °", "what programs will call the position", "0"),
    ("axis", "decouple", "target"): ArgumentText("mm, °", "where the axis goes", "none: the motion is endless"),
    ("axis", "decouple", "velocity"): ArgumentText("mm/s, °/s", "of the axis from now on", "unchanged"),
    ("axis", "set_feedforward", "enabled"): ArgumentText("", "on or off", "unchanged"),
    ("spindle", "set_feedforward", "enabled"): ArgumentText("", "on or off", "unchanged"),
    ("spindle", "orient", "speed_rpm"): ArgumentText("rpm", "speed of the positioning", "P-AXIS-00209"),
    ("spindle", "orient", "direction"): ArgumentText("", "of rotation", "the rules of M19"),
    ("spindle", "couple", "master"): ArgumentText("", "name of the master spindle"),
    ("axis", "write_parameter", "value"): ArgumentText("", "in the unit of its list"),
    ("plc", "set_input", "value"): ArgumentText("", "a number; 1 is on, 0 is off"),
    ("channel", "single_block", "mode"): ArgumentText("", "behind what the program stops", "`block`"),
    ("channel", "load", "text"): ArgumentText("", "the program itself", "`program` is read"),
}
"""Kind of unit, command, argument."""


def argument_text(kind: str, command: str, name: str) -> ArgumentText:
    """The text of one argument of a command."""
    return SPECIAL_TEXTS.get((kind, command, name), ARGUMENT_TEXTS[name])
