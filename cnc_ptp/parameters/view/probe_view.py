"""The measuring probe of an axis, and where its simulated one meets a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.fields import given_fields


@dataclass(frozen=True, slots=True)
class ProbeParameters:
    """mm (deg). The surfaces are where the encoder of the machine counts them: the input is on outside of them."""

    measures: Annotated[bool, ids.KENNGR_MESSACHSE] = False
    """The axis may take part in measuring runs."""
    stroke: Annotated[float, ids.KENNGR_HUB_MESSTASTER] = 0.0
    """Farthest way behind the measured point; 0.0 is not monitored."""
    below: Annotated[float, ids.SIMULATION_PROBE_BELOW] = -214748.3648
    above: Annotated[float, ids.SIMULATION_PROBE_ABOVE] = 214748.3647


def probe_view(parameters: ParameterSet) -> ProbeParameters:
    return ProbeParameters(**given_fields(ProbeParameters, parameters))
