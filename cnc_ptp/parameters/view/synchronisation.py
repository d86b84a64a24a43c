"""Synchronisation types of S, M3, M4, M5, M19 and free M functions with path motion and PLC."""

from enum import IntFlag

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import catalogue


class Synchronisation(IntFlag):
    """When a function is given out and when the channel waits for it (TF5200 spindle, page 27)."""

    NO_SYNCH = 0x00000000  # not given out to the PLC
    MOS = 0x00000001  # given out, never waited for
    MVS_SVS = 0x00000002  # given out before the motion, waited for before the motion
    MVS_SNS = 0x00000004  # given out before the motion, waited for at the block end
    MNS_SNS = 0x00000008  # given out after the motion, waited for there
    MNE_SNS = 0x00000020  # given out after a measuring event, waited for at the block end
    MVS_SLM = 0x00004000  # given out in the block, waited for at the next G01, G02, G03
    MVS_SLP = 0x00008000  # given out in the block, waited for at #EXPL SYN
    PLC_INFO = 0x00020000  # added to one of them: the PLC gets the spindle function too and must acknowledge it

    @property
    def constants(self) -> str:
        """Their names joined by |, as a parameter has them."""
        return " | ".join(constant.name or "" for constant in Synchronisation if constant & self)


def synchronisation(constants: str) -> Synchronisation:
    """The value of constants joined by |, in the spelling that the loader makes; NOT_VALID counts as NO_SYNCH."""
    choices = catalogue().by_id[ids.M_SYNCH].choices
    value = Synchronisation.NO_SYNCH
    for name in constants.split(" | "):
        value |= Synchronisation(choices.get(name, 0))
    return value
