"""The vocabularies by the name that machine files and `--dialect` give them."""

from typing import Final

from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.program import Vocabulary
from cnc_ptp.nc.vocabulary import TWINCAT

VOCABULARIES: Final[dict[str, Vocabulary]] = {"twincat": TWINCAT, "iso": ISO}
