"""What a machine file may say but what does not do what its author may expect. Lines for the log, none stops a node."""

from collections.abc import Iterator, Mapping

from cnc_ptp.parameters.encoder import CORRECTED
from cnc_ptp.parameters.parameter_set import ParameterSet

SIMULATED_DRIVES = (4, 16)
VELOCITY_INDEPENDENT = 4
LATE_TYPES = ("MVS_SLM", "MVS_SLP", "MNE_SNS")


def machine_warnings(sets: Mapping[str, ParameterSet]) -> Iterator[str]:
    """One line a warning, with file and line."""
    for parameters in sets.values():
        yield from without_effect(parameters)
        if parameters.kind == "channel":
            yield from late_synchronisation(parameters)
        else:
            yield from simulated_drive(parameters)
            yield from following_error(parameters)
            yield from corrected_resolution(parameters)


def line(parameters: ParameterSet, number: str, indexes: tuple[int, ...], text: str) -> str:
    name = parameters.catalogue.by_id[number].list_style_name(indexes)
    return f"{parameters.where(number, *indexes)}: {number} {name} of /{parameters.node}: {text}"


def without_effect(parameters: ParameterSet) -> Iterator[str]:
    for ros_name in parameters.given:
        declaration, indexes, _ = parameters.find(ros_name)
        if not declaration.effective_for(parameters.axis_type):
            yield line(parameters, declaration.id, indexes, "accepted, but without effect in this version")


def late_synchronisation(parameters: ParameterSet) -> Iterator[str]:
    """Types that wait later than the path does here."""
    for ros_name in parameters.given:
        declaration, indexes, value = parameters.find(ros_name)
        late = [name for name in LATE_TYPES if "_synch" in ros_name and name in str(value)]
        if late:
            yield line(parameters, declaration.id, indexes, f"{late[0]} waits before the motion, like MVS_SVS")


def simulated_drive(parameters: ParameterSet) -> Iterator[str]:
    drive = parameters.number("P-AXIS-00020")
    if drive not in SIMULATED_DRIVES:
        yield line(parameters, "P-AXIS-00020", (), f"drive type {drive} does not exist here, the drive is simulated")


def corrected_resolution(parameters: ParameterSet) -> Iterator[str]:
    for gear in parameters.used_indexes("getriebe"):
        for number, warning in CORRECTED.items():
            if parameters.number(number, gear) == 0:
                yield line(parameters, number, (gear,), f"P-WARN-{warning} value 0 is corrected to 1")


def following_error(parameters: ParameterSet) -> Iterator[str]:
    """Monitoring that is another than asked for, or that would trip in plain motion: vb_max / kv above slep_max."""
    gear = (int(parameters.number("P-AXIS-00079")) - 1,)
    kind = parameters.number("P-AXIS-00172", *gear)
    if kind not in (1, 2, VELOCITY_INDEPENDENT):
        return
    if kind != VELOCITY_INDEPENDENT:
        yield line(parameters, "P-AXIS-00172", gear, f"monitoring type {kind} is carried out as type 4")
    expected = parameters.kernel("P-AXIS-00212", *gear) / parameters.kernel("P-AXIS-00099", *gear)
    limit = parameters.kernel("P-AXIS-00168", *gear)
    if expected >= limit and parameters.kind == "axis":
        unit = "mm" if parameters.axis_type == "T" else "°"
        text = f"limit {limit:g} {unit} is not above vb_max / kv, the {expected:g} {unit} that P-AXIS-00212 brings"
        yield line(parameters, "P-AXIS-00168", gear, text)
