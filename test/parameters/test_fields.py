"""Fields of views that are parameters: the types fit, the numbers in the code are those of the declarations."""

from typing import Any

import pytest

from cnc_ptp.parameters import (
    AxisParameters,
    ChannelParameters,
    ChannelSpindle,
    CurveParameters,
    GearParameters,
    MachineParameters,
    SpindleParameters,
    Synchronisation,
    catalogue,
)
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.view.control_view import (
    ControlParameters,
    DriveParameters,
    FeedforwardParameters,
    FrictionParameters,
    LagMonitoring,
    PlantParameters,
)
from cnc_ptp.parameters.view.fields import parameter_fields
from cnc_ptp.parameters.view.telegram import DriveType

VIEWS = {
    "machine": (MachineParameters,),
    "channel": (ChannelParameters, ChannelSpindle),
    "axis": (AxisParameters,),
    "spindle": (SpindleParameters, GearParameters, CurveParameters),
    "axis and spindle": (
        ControlParameters,
        DriveParameters,
        FeedforwardParameters,
        FrictionParameters,
        LagMonitoring,
        PlantParameters,
    ),
}
DECLARED = {float: ("int", "float"), int: ("int",), bool: ("int", "bool"), Synchronisation: ("string",)}
"""Type of a field -> types of a parameter that may fill it."""


@pytest.mark.parametrize(("kinds", "view"), [(kinds, view) for kinds, views in VIEWS.items() for view in views])
def test_every_field_has_a_fitting_parameter(kinds: str, view: Any) -> None:
    fields = parameter_fields(view)
    assert fields
    for name, kind, number in fields:
        declaration = catalogue().by_id[number]
        assert declaration.type in DECLARED[kind], name
        assert all(declaration.belongs_to(node) for node in kinds.split(" and ")), name


def test_drive_types() -> None:
    assert set(DriveType) == set(catalogue().by_id[ids.KENNGR_ANTR_TYP].choices)
