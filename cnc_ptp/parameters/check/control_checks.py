"""Drive, telegram, feedforward and friction compensation of an axis or spindle against each other.

Error numbers of the manuals: TF5200 feedforward 4.1, 4.2, 5.2; friction 2.2.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, groupby

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view import telegram
from cnc_ptp.parameters.view.control_view import (
    ADD_ACC,
    ADD_JERK,
    ADD_VEL,
    flag_bits,
    friction_permitted,
    friction_table_size,
)

NO_ADDITIVE_VELOCITY = 70350
NO_ADDITIVE_TORQUE = 70351
GEAR_DENOMINATOR = 110579
TABLE_NOT_ASCENDING = 110591
TABLE_MISSING = 110592
ADDITIVE_MODE = 3
DENOMINATORS = (ids.VORSTEUER_VS_A_NENNER, ids.VORSTEUER_VS_V_NENNER, ids.VORSTEUER_FEEDFORWARD_V_ADD_DENOM)


def control_checks(parameters: ParameterSet) -> Iterator[Problem]:
    """All checks of one axis or spindle."""
    for check in (
        gear_denominators,
        zero_denominators,
        inertia,
        velocity_controller,
        known_objects,
        objects_once,
        names_and_numbers,
        operation_mode,
        additive_objects,
        friction,
    ):
        yield from check(parameters)


def gear_denominators(parameters: ParameterSet) -> Iterator[Problem]:
    for gear in parameters.used_indexes("getriebe"):
        if parameters.number(ids.GETRIEBE_GEAR_FACT_DENOM, gear) == 0:
            text = "value 0 is not a valid denominator of a gear ratio"
            yield problem(parameters, GEAR_DENOMINATOR, ids.GETRIEBE_GEAR_FACT_DENOM, (gear,), text)


def zero_denominators(parameters: ParameterSet) -> Iterator[Problem]:
    for number in DENOMINATORS:
        if parameters.number(number) == 0:
            yield problem(parameters, errors.DENOMINATOR, number, (), "value 0 is not a valid denominator")


def inertia(parameters: ParameterSet) -> Iterator[Problem]:
    """Simulated mechanics need an inertia."""
    torque = telegram.interface(parameters) == "torque"
    if parameters.number(ids.SIMULATION_INERTIA) or not (torque or parameters.text(ids.SIMULATION_MODEL) == "CASCADED"):
        return
    for gear in sorted({0, *parameters.used_indexes("getriebe")}):
        if parameters.number(ids.GETRIEBE_LOAD, gear) == 0:
            reason = "a torque command" if torque else "P-SIM-00006 simulation.model CASCADED"
            text = f"value 0 is not a valid inertia for {reason}, P-SIM-00007 simulation.inertia is 0 too"
            yield problem(parameters, errors.CONTRADICTION, ids.GETRIEBE_LOAD, (gear,), text)


def velocity_controller(parameters: ParameterSet) -> Iterator[Problem]:
    """The velocity loop of a cascaded plant, s³ Ti + s² + Kp s + Kp/Tn, is stable for Ti < Tn (Routh)."""
    lag = parameters.number(ids.SIMULATION_CURRENT_TIME_CONSTANT)
    integral = parameters.number(ids.SIMULATION_VELOCITY_INTEGRAL_TIME)
    used = parameters.text(ids.SIMULATION_MODEL) == "CASCADED" and telegram.interface(parameters) != "torque"
    if used and integral and lag >= integral:
        where = f"the {lag} µs of P-SIM-00010 simulation.current_time_constant"
        text = f"value {integral} is not above {where}, the velocity controller is unstable"
        yield problem(parameters, errors.CONTRADICTION, ids.SIMULATION_VELOCITY_INTEGRAL_TIME, (), text)


TELEGRAMS = {"command": "antr.sercos.mdt, antr.telegram.commands", "feedback": "antr.sercos.at, antr.telegram.feedback"}


def known_objects(parameters: ParameterSet) -> Iterator[Problem]:
    """Each object of a telegram is known and one of the drive type's own bus."""
    kind = int(parameters.number(ids.KENNGR_ANTR_TYP))
    for entries, known, others, own in (
        (telegram.configured_commands(parameters), telegram.COMMAND_OBJECTS, telegram.FEEDBACK_OBJECTS, "feedback"),
        (telegram.configured_feedback(parameters), telegram.FEEDBACK_OBJECTS, telegram.COMMAND_OBJECTS, "command"),
    ):
        for name, number, indexes in entries:
            usable = [known_name for known_name in known if telegram.fits(known_name, kind)]
            if name not in usable:
                listed = ", ".join(usable) or "none"
                text = f"object {name} cannot be exchanged with drive type {kind} (P-AXIS-00020), known are {listed}"
                if name in others and telegram.fits(name, kind):
                    text = f"object {name} is one of the {own} telegram ({TELEGRAMS[own]}), known here are {listed}"
                yield problem(parameters, errors.TELEGRAM, number, indexes, text)


def objects_once(parameters: ParameterSet) -> Iterator[Problem]:
    """A telegram has one object for each quantity."""
    for entries, known in (
        (telegram.configured_commands(parameters), telegram.COMMAND_OBJECTS),
        (telegram.configured_feedback(parameters), telegram.FEEDBACK_OBJECTS),
    ):
        for first, second in combinations([entry for entry in entries if entry.name in known], 2):
            quantity = known[first.name].replace("_", " ")
            if first.name == second.name:
                text = f"object {first.name} is in the telegram twice"
            elif known[first.name] == known[second.name]:
                text = f"objects {first.name} and {second.name} both carry the {quantity}"
            else:
                continue
            yield problem(parameters, errors.TELEGRAM, second.number, second.indexes, text)


def names_and_numbers(parameters: ParameterSet) -> Iterator[Problem]:
    """An object that has a name and a number has them of the same object."""
    for array, name_of, number_of in (
        ("mdt", ids.MDT_NC_REF, ids.MDT_IDENT_NR),
        ("at", ids.AT_NC_REF, ids.AT_IDENT_NR),
    ):
        for index in parameters.used_indexes(f"antr.sercos.{array}"):
            name, number = parameters.text(name_of, index).replace("_", "-"), parameters.number(number_of, index)
            if name and number and int(name[-4:]) != number:
                text = f"value {number} is not the number of {name}, the object in {name_of}"
                yield problem(parameters, errors.TELEGRAM, number_of, (index,), text)


def operation_mode(parameters: ParameterSet) -> Iterator[Problem]:
    """The quantity that P-AXIS-00320 commands is in the telegram."""
    mode = parameters.text(ids.ANTR_OPERATION_MODE)
    wanted = telegram.OPERATION_MODES.get(mode)
    if wanted is not None and wanted not in telegram.commands(parameters):
        text = f"mode {mode} commands the {wanted}, {carried(parameters)}"
        yield problem(parameters, errors.TELEGRAM, ids.ANTR_OPERATION_MODE, (), text)


def additive_objects(parameters: ParameterSet) -> Iterator[Problem]:
    """ADD_… of P-AXIS-00223; a torque command can hold all of them, as the NC has the velocity controller."""
    mode, available = flag_bits(parameters, ids.VORSTEUER_VORSTEUERUNG), telegram.commands(parameters)
    if telegram.interface(parameters) == "torque":
        return
    if mode & ADD_VEL and "additive_velocity" not in available:
        text = f"ADD_VEL needs an additive velocity command (S-0-0037, 60B1, NSOLL_B), {carried(parameters)}"
        yield problem(parameters, NO_ADDITIVE_VELOCITY, ids.VORSTEUER_VORSTEUERUNG, (), text)
    if mode & (ADD_ACC | ADD_JERK) and "additive_torque" not in available:
        names = " and ".join(name for name, bit in (("ADD_ACC", ADD_ACC), ("ADD_JERK", ADD_JERK)) if mode & bit)
        needs = "need" if " and " in names else "needs"
        text = f"{names} {needs} an additive torque command (S-0-0081, 60B2, M_ADD1), {carried(parameters)}"
        yield problem(parameters, NO_ADDITIVE_TORQUE, ids.VORSTEUER_VORSTEUERUNG, (), text)


def carried(parameters: ParameterSet) -> str:
    """What the command telegram carries, for messages."""
    quantities = ", ".join(sorted(telegram.commands(parameters))).replace("_", " ") or "nothing"
    return f"the command telegram carries {quantities}"


def friction(parameters: ParameterSet) -> Iterator[Problem]:
    """The table of the friction compensation (P-COMP-…) if it is used."""
    entries, points = parameters.number(ids.FRICT_COMP_TABLE_ENTRIES), friction_table_size(parameters)
    if entries > points:
        text = f"value {entries} is above the {points} entries of P-COMP-00062 frict_comp.max_points"
        yield problem(parameters, errors.CONTRADICTION, ids.FRICT_COMP_TABLE_ENTRIES, (), text)
        return
    mode = parameters.number(ids.FRICT_COMP_MODE)
    if mode not in (0, ADDITIVE_MODE):
        text = f"mode {mode} is unknown, there are 0 (off) and {ADDITIVE_MODE} (additive current)"
        yield problem(parameters, TABLE_MISSING, ids.FRICT_COMP_MODE, (), text)
    elif mode and not entries:
        text = f"mode {mode} has no values, P-COMP-00042 frict_comp.table_entries is 0"
        yield problem(parameters, TABLE_MISSING, ids.FRICT_COMP_MODE, (), text)
    yield from ascending(parameters, int(entries))
    permitted = friction_permitted(parameters)
    takes_torque = {"additive_torque"} & telegram.commands(parameters) or telegram.interface(parameters) == "torque"
    if permitted and mode and not takes_torque:
        text = f"friction compensation needs an additive torque command (S-0-0081, 60B2, M_ADD1), {carried(parameters)}"
        yield problem(parameters, NO_ADDITIVE_TORQUE, ids.LR_PARAM_FRICT_COMP, (), text)


def ascending(parameters: ParameterSet, entries: int) -> Iterator[Problem]:
    """Velocities that do not ascend; those that are not given at all in one problem (entry 0 may be left out)."""
    missing = [index for index in range(1, entries) if not parameters.is_given(ids.TABLE_IN, index)]
    if missing:
        which = f"entries {spans(missing)}" if len(missing) > 1 else f"entry {missing[0]}"
        text = f"value {entries}, but the velocity (P-COMP-00046) of {which} is not given"
        yield problem(parameters, TABLE_NOT_ASCENDING, ids.FRICT_COMP_TABLE_ENTRIES, (), text)
    last, before = -1, -1
    for index in (index for index in range(entries) if index not in missing):
        value = parameters.number(ids.TABLE_IN, index)
        if value <= before or value < 0:
            wanted = "not negative" if value < 0 else f"above the {before} of entry {last}"
            text = f"value {value} must be {wanted}, velocities ascend"
            yield problem(parameters, TABLE_NOT_ASCENDING, ids.TABLE_IN, (index,), text)
        last, before = index, max(before, int(value))


def spans(indexes: list[int]) -> str:
    """[1, 2, 3, 7] as '1 ... 3, 7'."""
    runs = [[run for _, run in group] for _, group in groupby(enumerate(indexes), lambda pair: pair[1] - pair[0])]
    return ", ".join(f"{run[0]} ... {run[-1]}" if len(run) > 1 else f"{run[0]}" for run in runs)
