"""Brackets with feedforward or COMP of a block -> canonical functions, once their axis or spindle is known."""

from cnc_ptp.nc import faults, spindle_faults
from cnc_ptp.nc.canonical import CompensationSwitch, Function, SpindleCommand, SpindleFeedforward, SpindleFunction
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, NcBlock, Spindle
from cnc_ptp.nc.spindles import names


def bracketed_controls(
    channel: Channel, state: ModalState, block: NcBlock, before: tuple[Function, ...]
) -> tuple[SpindleFeedforward | CompensationSwitch, ...]:
    """The control functions in brackets, in their order; `before`: the block's other functions.

    Raises 20797, 20180 for axes and spindles that the channel does not have, 21099 and 21037 for one that is named
    twice, 21202 for spindles that the PLC moves.
    """
    spindles = names(channel, state)
    moved = {function.spindle for function in before if isinstance(function, (SpindleFunction, SpindleCommand))}
    used = {name for name, spindle in spindles.items() if spindle.key in moved}
    axes: set[str] = set()
    controls: list[SpindleFeedforward | CompensationSwitch] = []
    for control in block.controls:
        if isinstance(control, CompensationSwitch):
            _check(block, control.axis, channel.axes, axes, faults.AXIS_UNKNOWN, faults.COMP_TWICE)
            controls.append(control)
        else:
            _check(block, control.spindle, tuple(spindles), used, faults.SPINDLE_UNKNOWN, faults.SPINDLE_TWICE)
            _require_unit(block, control, spindles[control.spindle])
            controls.append(control._replace(spindle=spindles[control.spindle].key))
    return tuple(controls)


def _require_unit(block: NcBlock, control: SpindleFeedforward, spindle: Spindle) -> None:
    """Raises 21202 for a spindle that the PLC moves: it has no position controller here (P-CHAN-00069)."""
    if spindle.plc_control:
        word = "G136" if control.on is None else "G135" if control.on else "G137"
        column = block.source.column(word)
        raise spindle_faults.PLC_SPINDLE.at(block.source, column, word=word, spindle=control.spindle)


def _check(
    block: NcBlock, name: str, known: tuple[str, ...], used: set[str], unknown: faults.Fault, twice: faults.Fault
) -> None:
    """Raises for a name that is not `known` or already `used`; notes it."""
    column = block.source.column(name)
    if name not in known:
        raise unknown.at(block.source, column, word=name, known=", ".join(known) or "none")
    if name in used:
        raise twice.at(block.source, block.source.column(name, last=True), axis=name, spindle=name)
    used.add(name)
