"""A channel as the kernel uses it: its axes and spindles by program name, synchronisation of functions, path limits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, NamedTuple

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.channel_members import (
    ChannelAxisEntry,
    axis_entries,
    coupled_spindle_pairs,
    main_spindle_number,
    spindle_entries,
)
from cnc_ptp.parameters.view.fields import given_fields
from cnc_ptp.parameters.view.offsets_view import NO_OFFSET_TABLES, OffsetTables, offset_tables
from cnc_ptp.parameters.view.synchronisation import Synchronisation, synchronisation
from cnc_ptp.parameters.view.tool_view import NO_TOOLS, ToolTable, tool_table

INTERNAL_M_FUNCTIONS = (0, 1, 2, 3, 4, 5, 17, 19, 29, 30)
GEAR_M_FUNCTIONS = range(40, 46)


class ChannelAxis(NamedTuple):
    """An axis of a channel: its name in programs ("X"), its node ("x"), its logical number."""

    name: str
    node: str
    number: int = 0


class ChannelSpindle(NamedTuple):
    """A spindle of a channel with the synchronisation of its functions.

    name          its name in programs at start-up and in the canonical stream
    node          empty for a spindle that the PLC moves through the channel's interface (P-CHAN-00069)
    own_name      its name in programs while it is not the main spindle; empty is `name`
    ranges        (lowest, highest) speed of each gear stage, rpm; (0, 0) is an unused one
    """

    name: str
    node: str
    m3: Annotated[Synchronisation, ids.SPINDEL_M3_SYNCH]
    m4: Annotated[Synchronisation, ids.SPINDEL_M4_SYNCH]
    m5: Annotated[Synchronisation, ids.SPINDEL_M5_SYNCH]
    m19: Annotated[Synchronisation, ids.SPINDEL_M19_SYNCH]
    s: Annotated[Synchronisation, ids.SPINDEL_S_SYNCH]
    own_name: str = ""
    number: int = 0
    ranges: tuple[tuple[float, float], ...] = ()
    from_top: Annotated[bool, ids.SPINDEL_RANGE_WAY] = False
    automatic: Annotated[bool, ids.SPINDEL_AUTOM_RANGE] = False

    @property
    def plc_control(self) -> bool:
        """The PLC moves it through the channel's interface."""
        return not self.node


class ToolLimits(NamedTuple):
    """Limits of a tool for the spindle `node`, rpm and °/s²; None is not limited (P-TOOL-00012 … 00015)."""

    node: str
    min_speed_rpm: float | None
    max_speed_rpm: float | None
    max_acceleration: float | None


@dataclass(frozen=True, slots=True)
class ChannelParameters:
    """An NC channel."""

    name: str
    axes: tuple[ChannelAxis, ...]
    spindles: tuple[ChannelSpindle, ...]
    main_spindle: str
    """Program name of the main spindle, empty if the channel has no spindle."""
    m_functions: Mapping[int, Synchronisation]
    """Synchronisation by M number; an M function that is missing here does not exist on the machine."""
    max_override_percent: float
    circle_center_tolerance: Annotated[float, ids.MITTELPKT_DIFF]
    """Largest shift of an arc's centre in mm …"""
    circle_center_ratio: Annotated[float, ids.MITTELPKT_FAKTOR]
    """… and as a fraction of its radius."""
    gear_change: Annotated[bool, ids.MAIN_SPINDLE_GEAR_CHANGE] = False
    """M40 to M45 and S change the gear of the main spindle (P-CHAN-00052)."""
    h_functions: Mapping[int, Synchronisation] = field(default_factory=dict)
    """Synchronisation by H number; one that is missing here is MOS."""
    coupled: tuple[tuple[str, str], ...] = ()
    """Coupling group 0: (slave, master) by the name of the spindle (P-CHAN-00037, 00038)."""
    tools: Mapping[int, ToolLimits] = field(default_factory=dict)
    """Limits of the tools that have some, by D number."""
    tool_table: ToolTable = NO_TOOLS
    """Compensation data of the tools."""
    slope: str = "TRAPEZ"
    """Of the path's acceleration, unless #SLOPE says otherwise: STEP, TRAPEZ or SIN2 (P-CHAN-00071)."""
    offsets: OffsetTables = NO_OFFSET_TABLES
    call_depth: Annotated[int, ids.INTERPRETER_CALL_DEPTH] = 20
    repeats: Annotated[int, ids.INTERPRETER_REPEATS] = 1_000_000
    known_blocks: Annotated[int, ids.INTERPRETER_KNOWN_BLOCKS] = 100_000
    checked_text: Annotated[int, ids.INTERPRETER_CHECKED_TEXT] = 10_000_000
    blocks_per_cycle: Annotated[int, ids.INTERPRETER_BLOCKS_PER_CYCLE] = 10
    folders: tuple[str, ...] = ()
    """In which called programs are looked for besides that of the main program (P-CHAN-90004)."""
    cycles: Mapping[str, str] = field(default_factory=dict)
    """Programs that G80 to G89 call, by code, where the machine file names them (P-CHAN-00160 … 00169)."""
    dialect: str = "twincat"
    """Vocabulary of its programs: twincat or iso (P-CHAN-90010)."""
    transition: Annotated[int, ids.PROG_START_TRANSITION] = 359
    """G function of the transition between blocks at the start of programs."""
    contour_path_dev: Annotated[float, ids.CONTOUR_PATH_DEV] = 1.0
    """Of G261, mm …"""
    contour_track_dev: Annotated[float, ids.CONTOUR_TRACK_DEV] = 0.0
    """… and mm or deg of the other axes, 0 none."""
    hsc_path_dev: Annotated[float, ids.HSC_PATH_DEV] = 0.0
    """Of #HSC ON, mm, 0 none …"""
    hsc_track_dev: Annotated[float, ids.HSC_TRACK_DEV] = 0.0
    """… and mm or deg of the other axes, 0 none."""
    thread_run_up: Annotated[float, ids.THREAD_RUN_UP] = 0.0
    """mm of a thread that may be out of pitch, 0: any (P-CHAN-90025)."""
    thread_retract_axis: str = ""
    """Axis by which the tool leaves a thread that is broken off, empty: none (P-CHAN-90026) …"""
    thread_retract: Annotated[float, ids.THREAD_RETRACT_DISTANCE] = 0.0
    """… and its way, mm, signed."""
    signal_required: Annotated[bool, ids.MEAS_ERROR_NO_SIGNAL] = True
    """A measuring run without a signal of the probe is an error."""
    offsets_in_diameters: Annotated[bool, ids.VERSCH_IM_DURCHM] = False
    """Zero offsets and G92 of the facing axis are diameters."""
    shows_diameter: Annotated[bool, ids.DISPLAY_DIAMETER_POS] = False
    """With G51 the channel shows the facing axis in diameters."""
    cutting_speed_in_feet: Annotated[bool, ids.ENABLE_UNIT_FEET_CUT_SPEED] = False
    """S of G96 is in ft/min with G70."""
    pitch_tolerance: float = 0.001
    """Ratio by which F / S of G63 may differ from a programmed pitch (P-CHAN-90020)."""
    contour_look_ahead: Annotated[int, ids.TOOL_RADIUS_LOOK_AHEAD] = 5
    """Elements of a contour that are known before the tool moves along one …"""
    contour_other_blocks: Annotated[int, ids.TOOL_RADIUS_OTHER_BLOCKS] = 100
    """… and blocks without motion in the plane between two of them."""
    outer_corners: Annotated[int, ids.PROG_START_OUTER_CORNERS] = 26
    """G function of outer corners at the start of programs."""
    c_axis: str = ""
    """Program name of the main spindle as an axis of the path; empty: it does not become one (P-CHAN-00010)."""
    face_kind: Annotated[int, ids.CAX_FACE_ID] = 0
    """Kind of machine for #FACE: 2, X may pass the centre of rotation."""
    c_axis_ramp: Annotated[float, ids.C_AXIS_RAMP_TIME] = 0.02
    """s in which the spindle builds up its acceleration as an axis of the path."""

    @property
    def path_axes(self) -> tuple[str, ...]:
        """Names of the axes of the path: those of the channel, then the C axis."""
        return (*[axis.name for axis in self.axes], *([self.c_axis] if self.c_axis else []))


def channel_view(channel: ParameterSet, sets: Mapping[str, ParameterSet], folder: Path) -> ChannelParameters:
    """`folder` of the machine file."""
    spindles = spindle_entries(channel, sets)
    axes = axis_entries(channel, sets)
    main = main_spindle_number(channel, spindles)
    c_axis = channel.text(ids.DEFAULT_AX_NAME_OF_SPINDLE) if spindles else ""
    return ChannelParameters(
        name=channel.node,
        axes=tuple(ChannelAxis(entry.name, str(entry.node), entry.number) for entry in axes),
        spindles=tuple(channel_spindle(channel, entry) for entry in spindles),
        main_spindle=next((entry.name for entry in spindles if entry.number == main), ""),
        m_functions=m_functions(channel),
        h_functions=listed_functions(channel, "h_synch", ids.H_SYNCH),
        max_override_percent=channel.percent(ids.MAX_VB_OVERRIDE),
        coupled=coupled_spindles(channel, spindles),
        tools=tool_limits(channel, spindles),
        dialect=channel.text(ids.INTERPRETER_DIALECT),
        tool_table=tool_table(channel, sets),
        slope={0: "STEP", 2: "SIN2"}.get(int(channel.number(ids.SLOPE_PROFILE)), "TRAPEZ"),
        offsets=offset_tables(channel, len(axes) + bool(c_axis)),
        cycles=cycles(channel),
        c_axis=c_axis,
        pitch_tolerance=channel.number(ids.TAPPING_PITCH_TOLERANCE) / 1000.0,
        thread_retract_axis=channel.text(ids.THREAD_RETRACT_AXIS),
        folders=tuple(str(folder / name) for name in channel.names(ids.INTERPRETER_FOLDERS)),
        **given_fields(ChannelParameters, channel),
    )


def channel_spindle(channel: ParameterSet, entry: ChannelAxisEntry) -> ChannelSpindle:
    """One of spindel[i], or one that the channel has without listing it; then all parameters have their defaults."""
    return ChannelSpindle(
        name=entry.name,
        node="" if entry.plc_control else str(entry.node),
        own_name=entry.own_name,
        number=entry.number,
        ranges=speed_ranges(channel, *entry.indexes) if entry.indexes else (),
        **given_fields(ChannelSpindle, channel, *entry.indexes),
    )


def speed_ranges(channel: ParameterSet, spindle: int) -> tuple[tuple[float, float], ...]:
    """(lowest, highest) speed of the gear stages up to the last one that the file gives, rpm."""
    given = channel.used_indexes(f"spindel.{spindle}.range_table")
    ends = (ids.RANGE_TABLE_MIN_SPEED, ids.RANGE_TABLE_MAX_SPEED)
    speeds = [[float(channel.number(end, spindle, gear)) for end in ends] for gear in range(max(given, default=-1) + 1)]
    return tuple((lowest, highest) for lowest, highest in speeds)


def coupled_spindles(channel: ParameterSet, spindles: Sequence[ChannelAxisEntry]) -> tuple[tuple[str, str], ...]:
    """The pairs of spindles in coupling group 0."""
    name = {entry.number: entry.name for entry in spindles}
    return tuple((name.get(slave, ""), name.get(master, "")) for _, slave, master in coupled_spindle_pairs(channel))


def tool_limits(channel: ParameterSet, spindles: Sequence[ChannelAxisEntry]) -> dict[int, ToolLimits]:
    """Limits of the tools; one that the file does not give is None."""
    node = {entry.number: str(entry.node) for entry in spindles}
    tools = {}
    for tool in channel.used_indexes("wz"):
        number = int(channel.number(ids.WZ_LOG_AX_NR_SPDL, tool))
        if number:
            low, high = (limit(channel, parameter, tool) for parameter in (ids.WZ_VB_MIN, ids.WZ_VB_MAX))
            tools[tool] = ToolLimits(
                node.get(number, ""),
                None if low is None else low / DEG_S_PER_RPM,
                None if high is None else high / DEG_S_PER_RPM,
                limit(channel, ids.WZ_A_MAX, tool),
            )
    return tools


def limit(channel: ParameterSet, number: str, tool: int) -> float | None:
    """A limit of a tool in kernel units; None if it is not given."""
    return channel.kernel(number, tool) if channel.is_given(number, tool) else None


CYCLE_PARAMETERS = (
    ids.G80_PROG_FILE,
    ids.G81_PROG_FILE,
    ids.G82_PROG_FILE,
    ids.G83_PROG_FILE,
    ids.G84_PROG_FILE,
    ids.G85_PROG_FILE,
    ids.G86_PROG_FILE,
    ids.G87_PROG_FILE,
    ids.G88_PROG_FILE,
    ids.G89_PROG_FILE,
)


def cycles(channel: ParameterSet) -> dict[str, str]:
    """Programs of G80 … G89 that the file names."""
    codes = enumerate(CYCLE_PARAMETERS, 80)
    return {f"G{code}": channel.text(parameter) for code, parameter in codes if channel.is_given(parameter)}


def m_functions(channel: ParameterSet) -> dict[int, Synchronisation]:
    functions = dict.fromkeys(INTERNAL_M_FUNCTIONS, Synchronisation.NO_SYNCH)
    if channel.number(ids.MAIN_SPINDLE_GEAR_CHANGE):
        functions |= dict.fromkeys(GEAR_M_FUNCTIONS, Synchronisation.MVS_SVS)
    functions |= listed_functions(channel, "m_synch", ids.M_SYNCH)
    return dict(sorted(functions.items()))


def listed_functions(channel: ParameterSet, array: str, number: str) -> dict[int, Synchronisation]:
    """Synchronisation of the functions that an array names, by number of the function."""
    constants = {index: channel.text(number, index) for index in channel.used_indexes(array)}
    return {index: synchronisation(text) for index, text in constants.items() if text != "NOT_VALID"}
