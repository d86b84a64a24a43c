"""A small machine as lists, and what an import or export of others says."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.lists.importing import Imported, import_lists
from cnc_ptp.parameters.lists.problems import ListError

END = "; nothing was written"
SMALL = {
    "achs_mds_x.lis": "kopf.achs_nr 1\nkenngr.achs_typ ACHSTYP_TRANSLATOR\ngetriebe[0].kv 5000 # 50 1/s\n",
    "achs_mds_s.lis": "kopf.achs_nr 2\nkenngr.achs_typ 0x4\ngetriebe[0].kv 3000\n",
    "sda_mds_channel.lis": (
        "gruppe[0].achs_anzahl 1\n"
        "gruppe[0].achse[0].bezeichnung X\n"
        "gruppe[0].achse[0].log_achs_nr 1\n"
        "spdl_anzahl 1\n"
        "main_spindle_ax_nr 2\n"
        "main_spindle_name S\n"
        "spindel[0].bezeichnung S1\n"
        "spindel[0].log_achs_nr 2\n"
    ),
}
"""An axis, a spindle, a channel."""


def as_bytes(files: Mapping[str, str | bytes]) -> dict[str, bytes]:
    return {name: text if isinstance(text, bytes) else text.encode() for name, text in files.items()}


def imported(files: Mapping[str, str | bytes] = SMALL, /, **options: Any) -> Imported:
    return import_lists("f", as_bytes(files), **options)


def small(name: str, text: str | bytes, **options: Any) -> Imported:
    """The small machine with one file more, or another one."""
    return imported({**SMALL, name: text}, **options)


def refusal(files: Mapping[str, str | bytes], /, **options: Any) -> str:
    with pytest.raises(ListError) as caught:
        imported(files, **options)
    return str(caught.value)


def small_refusal(name: str, text: str | bytes, **options: Any) -> str:
    return refusal({**SMALL, name: text}, **options)


def axis_refusal(*lines: str) -> str:
    """Of an axis list with these lines from line 2 on; without the folder in it."""
    return refusal({"achs_mds_x.lis": "\n".join(["kopf.achs_nr 1", *lines, ""])})


def notes(result: Imported, kind: str) -> list[str]:
    return [str(note) for note in result.report.of(kind)]


def values(parameters: ParameterSet) -> dict[str, object]:
    """Every value of a node by ROS name."""
    return {parameter.ros_name: parameter.value for parameter in parameters.parameters()}
