"""What a machine file may say but what does not do what its author may expect. Lines for the log, none stops a node."""

from collections.abc import Iterator, Mapping

from cnc_ptp.parameters.control_notices import control_notices
from cnc_ptp.parameters.lines import line
from cnc_ptp.parameters.parameter_set import ParameterSet

LATE_TYPES = ("MVS_SLM", "MVS_SLP", "MNE_SNS")


def machine_warnings(sets: Mapping[str, ParameterSet], cycle_time: float) -> Iterator[str]:
    """One line a warning, with file and line; `cycle_time` in s."""
    for parameters in sets.values():
        yield from without_effect(parameters)
        if parameters.kind == "channel":
            yield from late_synchronisation(parameters)
        else:
            yield from control_notices(parameters, cycle_time)


def without_effect(parameters: ParameterSet) -> Iterator[str]:
    for ros_name in parameters.given:
        declaration, indexes, _ = parameters.find(ros_name)
        if not declaration.effective:
            yield line(parameters, declaration.id, indexes, "accepted, but without effect in this version")


def late_synchronisation(parameters: ParameterSet) -> Iterator[str]:
    """Types that wait later than the path does here."""
    for ros_name in parameters.given:
        declaration, indexes, value = parameters.find(ros_name)
        late = [name for name in LATE_TYPES if "_synch" in ros_name and name in str(value)]
        if late:
            yield line(parameters, declaration.id, indexes, f"{late[0]} waits before the motion, like MVS_SVS")
