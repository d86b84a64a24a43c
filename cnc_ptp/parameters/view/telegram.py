"""Cyclic telegrams: the objects that go to and come from a drive, and their meaning.

Sources: TF5200 feedforward 4, friction 2.4; SERCOS IDN and CiA 402 object numbers; PROFIdrive signals of telegram 5.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet


class DriveType(IntEnum):
    """P-AXIS-00020."""

    CONVENTIONAL = 1
    SERCOS = 2
    PROFIDRIVE = 3
    SIMULATION = 4
    LIGHTBUS = 5
    TERMINAL = 6
    ETHERNET = 7
    CANOPEN = 8
    VIRTUAL = 16
    CAN = 32


COMMAND_OBJECTS: dict[str, str] = {
    "S-0-0036": "velocity",
    "S-0-0047": "position",
    "S-0-0080": "torque",
    "S-0-0037": "additive_velocity",
    "S-0-0081": "additive_torque",
    "60FF": "velocity",
    "607A": "position",
    "6071": "torque",
    "60B1": "additive_velocity",
    "60B2": "additive_torque",
    "NSOLL_B": "velocity",
    "XERR": "lag",
    "M_ADD1": "additive_torque",
    "DA_WORD": "velocity",
}
FEEDBACK_OBJECTS: dict[str, str] = {
    "S-0-0051": "position",
    "S-0-0040": "velocity",
    "S-0-0084": "torque",
    "6064": "position",
    "606C": "velocity",
    "6077": "torque",
    "G1_XIST1": "position",
    "NIST_B": "velocity",
    "MIST_GLATT": "torque",
}
EVERYTHING = frozenset({"velocity", "position", "torque", "lag", "additive_velocity", "additive_torque"})
ALL_FEEDBACK = frozenset({"position", "velocity", "torque"})
PLAIN = (frozenset({"velocity"}), frozenset({"position"}))
PRESETS: dict[int, tuple[frozenset[str], frozenset[str]]] = {
    DriveType.CONVENTIONAL: PLAIN,
    DriveType.SERCOS: PLAIN,
    DriveType.PROFIDRIVE: (frozenset({"lag", "additive_velocity"}), frozenset({"position", "velocity"})),
    DriveType.SIMULATION: (EVERYTHING, ALL_FEEDBACK),
    DriveType.LIGHTBUS: PLAIN,
    DriveType.TERMINAL: PLAIN,
    DriveType.ETHERNET: PLAIN,
    DriveType.CANOPEN: PLAIN,
    DriveType.VIRTUAL: (frozenset(), frozenset()),
    DriveType.CAN: PLAIN,
}
"""Quantities that a drive type (P-AXIS-00020) exchanges if no telegram is configured."""
BUSES: dict[int, tuple[str, ...]] = {
    DriveType.CONVENTIONAL: ("DA",),
    DriveType.SERCOS: ("S-",),
    DriveType.PROFIDRIVE: ("NSOLL", "XERR", "M_ADD", "G1", "NIST", "MIST"),
    DriveType.LIGHTBUS: ("S-",),
    DriveType.TERMINAL: ("DA",),
    DriveType.ETHERNET: ("S-", "6"),
    DriveType.CANOPEN: ("6",),
    DriveType.CAN: ("6",),
}
"""First letters of the objects of a drive type; the simulated drive (4) takes them all, the virtual axis (16) none."""
ANALOGUE = (DriveType.CONVENTIONAL, DriveType.TERMINAL)
"""Drive types whose command is a voltage of ±10 V."""
WITHOUT_FORMAT = (DriveType.SIMULATION, DriveType.VIRTUAL)
"""Drive types that take kernel units: nothing is rounded between NC and drive."""
OPERATION_MODES = {
    "DRIVE_POSITION_CONTROL": "position",
    "CNC_POSITION_CONTROL": "velocity",
    "DSC_POSITION_CONTROL": "lag",
}
INTERFACES = ("velocity", "lag", "position", "torque")


def fits(name: str, kind: int) -> bool:
    """Whether an object can be exchanged with a drive of type `kind` (P-AXIS-00020)."""
    return kind == DriveType.SIMULATION or name.startswith(BUSES.get(kind, ("-",)))


class Configured(NamedTuple):
    """An object of a telegram, and the parameter that configures it."""

    name: str
    number: str
    indexes: tuple[int, ...]


def configured_commands(parameters: ParameterSet) -> tuple[Configured, ...]:
    """The objects of the command telegram by name, S-0-0037."""
    return _objects(parameters, ids.TELEGRAM_COMMANDS, "mdt", (ids.MDT_NC_REF, ids.MDT_IDENT_NR))


def configured_feedback(parameters: ParameterSet) -> tuple[Configured, ...]:
    """The objects of the feedback telegram by name, S-0-0051."""
    return _objects(parameters, ids.TELEGRAM_FEEDBACK, "at", (ids.AT_NC_REF, ids.AT_IDENT_NR))


def command_objects(parameters: ParameterSet) -> tuple[str, ...]:
    return tuple(entry.name for entry in configured_commands(parameters))


def feedback_objects(parameters: ParameterSet) -> tuple[str, ...]:
    return tuple(entry.name for entry in configured_feedback(parameters))


def default_bits() -> dict[str, int]:
    """Lengths of all quantities if the telegram gives none: torques 16 bits, all others 32."""
    return {quantity: 16 if "torque" in quantity else 32 for quantity in EVERYTHING}


def command_bits(parameters: ParameterSet) -> dict[str, int]:
    """Lengths in bits: 16 for a DA word, P-MACH-00024 if it is given."""
    bits = default_bits() | _lengths(parameters, "mdt", (ids.MDT_NC_REF, ids.MDT_IDENT_NR, ids.MDT_IDENT_LEN))
    return bits | {"velocity": 16} if parameters.number(ids.KENNGR_ANTR_TYP) in ANALOGUE else bits


def feedback_bits(parameters: ParameterSet) -> dict[str, int]:
    """Lengths in bits: P-MACH-00027 if it is given."""
    return default_bits() | _lengths(parameters, "at", (ids.AT_NC_REF, ids.AT_IDENT_NR, ids.AT_IDENT_LEN))


def _lengths(parameters: ParameterSet, array: str, elements: tuple[str, str, str]) -> dict[str, int]:
    quantities = COMMAND_OBJECTS if array == "mdt" else FEEDBACK_OBJECTS
    found = {}
    for index in parameters.used_indexes(f"antr.sercos.{array}"):
        name = _object(parameters, elements[:2], index)
        if name in quantities and parameters.is_given(elements[2], index):
            found[quantities[name]] = 8 * int(parameters.number(elements[2], index))
    return found


def commands(parameters: ParameterSet) -> frozenset[str]:
    """Quantities that can be commanded; next to the lag of DSC, NSOLL_B is an additive velocity.

    A telegram of additive values alone (TF5200 feedforward 4) has them in addition to the drive type's own command.
    """
    objects, preset = command_objects(parameters), PRESETS[int(parameters.number(ids.KENNGR_ANTR_TYP))][0]
    if not objects:
        return preset
    quantities = {COMMAND_OBJECTS[name] for name in objects if name in COMMAND_OBJECTS}
    if "XERR" in objects and "NSOLL_B" in objects:
        quantities = quantities - {"velocity"} | {"additive_velocity"}
    if quantities.isdisjoint(INTERFACES):
        quantities.update(main_command(preset))
    return frozenset(quantities)


def main_command(available: frozenset[str]) -> tuple[str, ...]:
    """The first of velocity, lag, position and torque that there is."""
    return tuple(quantity for quantity in INTERFACES if quantity in available)[:1]


def feedback(parameters: ParameterSet) -> frozenset[str]:
    """Actual values that come back; the position always does."""
    objects = feedback_objects(parameters)
    if not objects:
        return PRESETS[int(parameters.number(ids.KENNGR_ANTR_TYP))][1]
    return frozenset({"position", *(FEEDBACK_OBJECTS[name] for name in objects if name in FEEDBACK_OBJECTS)})


def is_open_loop(parameters: ParameterSet) -> bool:
    """The position loop stays open, except for positioning and homing of a spindle (P-AXIS-00320; spindle 2.2.4)."""
    return parameters.text(ids.ANTR_OPERATION_MODE).startswith("OPEN_POSITION_LOOP")


def interface(parameters: ParameterSet) -> str:
    """Commanded quantity: velocity, position, lag or torque; none for a virtual axis (P-AXIS-00020, 00320)."""
    mode = OPERATION_MODES.get(parameters.text(ids.ANTR_OPERATION_MODE))
    return mode or next(iter(main_command(commands(parameters))), "none")


def _objects(parameters: ParameterSet, names: str, array: str, elements: tuple[str, str]) -> tuple[Configured, ...]:
    objects = [Configured(name, names, ()) for name in parameters.names(names)]
    for index in parameters.used_indexes(f"antr.sercos.{array}"):
        name = _object(parameters, elements, index)
        if name:
            objects.append(Configured(name, elements[0 if parameters.text(elements[0], index) else 1], (index,)))
    return tuple(objects)


def _object(parameters: ParameterSet, elements: tuple[str, str], index: int) -> str:
    """Name of a configured object by its name or number; empty if the element names none."""
    name, number = parameters.text(elements[0], index), parameters.number(elements[1], index)
    return name.replace("_", "-") or (f"S-0-{number:04d}" if number else "")
