"""Numbers on the command line: between limits, and a number at all."""

from __future__ import annotations

import math
from typing import Any

import click

from cnc_ptp.protocol.run_time import LONGEST_RUN


class NumberRange(click.FloatRange):
    """A FloatRange that refuses what is not finite: no comparison with `nan` is true, so click lets it through."""

    name = "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a number." if math.isnan(number) else f"{value} is not finite.", param, ctx)
        return number


DURATION = NumberRange(0.0, LONGEST_RUN)
PERCENT = NumberRange(0.0, 1000.0)
STATES_PER_SECOND = NumberRange(0.0, 10_000.0)
RATE = POSITIVE = NumberRange(min=0.0, min_open=True)
