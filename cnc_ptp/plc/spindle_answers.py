"""The PLC's answers to spindles: it changes gears and permits couplings (TF5200 spindle 2.8.2, 2.8.3)."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping

from cnc_ptp.protocol.blocks import Command, CycleBlock, SpindleBlock


def spindle_answers(inputs: Mapping[str, CycleBlock], *, changes_gears_of: Container[str]) -> Iterator[Command]:
    """Answers to what the spindles have reported; `changes_gears_of`: whose gear changes are acknowledged at once."""
    spindles = {name: block for name, block in inputs.items() if isinstance(block, SpindleBlock)}
    for name, block in spindles.items():
        if block.gear_request and name in changes_gears_of:
            yield Command(name, "gear_changed", {})
    masters = {name: block.master for name, block in spindles.items() if block.master}
    for name, block in spindles.items():
        if block.master_wanted:
            reason = why_no_coupling(name, block.master_wanted, masters, spindles)
            if not reason:
                masters[name] = block.master_wanted
            yield Command(name, "coupling_answer", {"granted": not reason, "reason": reason})


def why_no_coupling(slave: str, master: str, masters: Mapping[str, str], spindles: Mapping[str, SpindleBlock]) -> str:
    """Empty when `slave` may follow `master`: a master must publish and be no slave, a slave no master."""
    if master not in spindles:
        return f"nothing is published by spindle {master}"
    if master in masters:
        return f"{master} is itself a slave of {masters[master]}"
    slaves = [name for name, of_name in masters.items() if of_name == slave]
    return f"{slave} is itself the master of {slaves[0]}" if slaves else ""
