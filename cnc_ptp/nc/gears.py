"""Gear stages of the main spindle: selection by speed (TF5200 spindle 2.8.2, P-CHAN-00004, 00052 to 00074)."""

from cnc_ptp.nc import spindle_faults
from cnc_ptp.nc.canonical import number
from cnc_ptp.nc.program import NcBlock, Spindle

FIRST_M = 40
GEAR_M = range(FIRST_M, FIRST_M + 6)
"""M40 is stage 1."""


def holds(spindle: Spindle, stage: int, speed_rpm: float) -> bool:
    """True if the range of `stage` (from 1) has the speed; its limits belong to it, (0, 0) has none.

    Standstill is in every range.
    """
    low, high = speed_range(spindle, stage)
    return speed_rpm == 0.0 or low <= speed_rpm <= high > 0.0


def speed_range(spindle: Spindle, stage: int) -> tuple[float, float]:
    """(lowest, highest) speed of a stage, rpm; (0, 0) where it has none."""
    return spindle.ranges[stage - 1] if stage <= len(spindle.ranges) else (0.0, 0.0)


def search(spindle: Spindle, speed_rpm: float) -> int:
    """The first stage with the speed, from the side that P-CHAN-00074 names; 0 if none has it."""
    stages = range(1, len(spindle.ranges) + 1)
    order = reversed(stages) if spindle.from_top else stages
    return next((stage for stage in order if holds(spindle, stage, speed_rpm)), 0)


def stage_for(
    spindle: Spindle, active: int, programmed: int, speed_rpm: float | None, block: NcBlock, name: str
) -> int:
    """The stage for a speed: the programmed one, else the active one while it fits, else (automatic) the one found.

    `programmed` is 0 without M40 to M45, `speed_rpm` None without a speed; `name` is what the program calls it.
    Raises ProgramError if speed and stage do not fit.
    """
    if programmed:
        _require_fit(spindle, programmed, speed_rpm, block, name)
        return programmed
    if speed_rpm is None or holds(spindle, active, speed_rpm):
        return active
    found = search(spindle, speed_rpm)
    column = block.source.column("S")
    if not found:
        raise spindle_faults.NO_GEAR_FOR_SPEED.at(
            block.source, column, speed=number(speed_rpm), spindle=name, ranges=ranges_text(spindle)
        )
    if not spindle.automatic:
        low, high = speed_range(spindle, active)
        raise spindle_faults.GEAR_NOT_PROGRAMMED.at(
            block.source,
            column,
            speed=number(speed_rpm),
            spindle=name,
            stage=m_of(active),
            low=number(low),
            high=number(high),
            fitting=_fitting(spindle, speed_rpm),
        )
    return found


def _require_fit(spindle: Spindle, stage: int, speed_rpm: float | None, block: NcBlock, name: str) -> None:
    low, high = speed_range(spindle, stage)
    column = block.source.column(f"M{m_of(stage)}")
    if high == 0.0:
        ranges = ranges_text(spindle)
        raise spindle_faults.GEAR_UNUSED.at(block.source, column, stage=m_of(stage), spindle=name, ranges=ranges)
    if speed_rpm is not None and not holds(spindle, stage, speed_rpm):
        values = {"speed": number(speed_rpm), "low": number(low), "high": number(high)}
        raise spindle_faults.GEAR_TOO_NARROW.at(block.source, column, spindle=name, stage=m_of(stage), **values)


def m_of(stage: int) -> int:
    """Number of the M function that selects a stage."""
    return FIRST_M + stage - 1


def ranges_text(spindle: Spindle) -> str:
    """All stages with a range, for errors."""
    used = [(stage, *speed_range(spindle, stage)) for stage in range(1, len(spindle.ranges) + 1)]
    texts = [f"M{m_of(stage)} {number(low)} to {number(high)} rpm" for stage, low, high in used if high > 0.0]
    return ", ".join(texts) or "none"


def _fitting(spindle: Spindle, speed_rpm: float) -> str:
    stages = [stage for stage in range(1, len(spindle.ranges) + 1) if holds(spindle, stage, speed_rpm)]
    return " or ".join(f"M{m_of(stage)}" for stage in stages)
