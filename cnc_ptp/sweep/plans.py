"""Which variants a sweep has: all combinations, or random ones. Each has a number and its values."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product
from typing import Protocol

import numpy as np

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare.declarations import ParameterValue
from cnc_ptp.sweep.faults import BAD_VARIATION, NOTHING, TOO_MANY_VARIANTS
from cnc_ptp.sweep.results import Row, Variant
from cnc_ptp.sweep.spread import Interval, Values
from cnc_ptp.sweep.variation import Variation

MOST_VARIANTS = 10**5


class Plan(Protocol):
    """The variants of a sweep, in batches: what is in one may be computed at the same time and in any order."""

    description: str
    """It, and the variations, decide all variants."""
    total: int

    def batches(self) -> Iterator[Sequence[Variant]]:
        """The next batch is asked for when `tell` has got the last one."""

    def tell(self, rows: Sequence[Row]) -> None:
        """What the last batch has given, in the order of its variants."""


class FixedPlan:
    """Variants that are all known before the first run."""

    def __init__(self, description: str, variants: Sequence[Variant]) -> None:
        self.description = description
        self.total = len(variants)
        self._variants = variants

    def batches(self) -> Iterator[Sequence[Variant]]:
        yield self._variants

    def tell(self, rows: Sequence[Row]) -> None:
        """Nothing depends on it."""


def grid(variations: Sequence[Variation]) -> FixedPlan:
    """All combinations; the last variation changes fastest. Raises CncError 26177, 26178, 26185."""
    for variation in variations:
        if not isinstance(variation.spread, Values):
            example = "a:b:n" if isinstance(variation.spread, Interval) else "--random N"
            reason = f"{variation.name}={variation.text} has no number of values, which a grid needs: {example}"
            raise CncError(BAD_VARIATION, reason, NOTHING, where="--vary")
    columns = [variation.values() for variation in variations]
    require_few(math.prod(map(len, columns)))
    return FixedPlan("grid", [Variant(number, values) for number, values in enumerate(product(*columns))])


def random_plan(variations: Sequence[Variation], count: int, seed: int) -> FixedPlan:
    """`count` draws; each depends on seed and number alone. Raises CncError 26177, 26178, 26185."""
    require_few(count)
    of_values = {variation.name: variation.values() for variation in variations if isinstance(variation.spread, Values)}
    variants = []
    for number in range(count):
        source = np.random.default_rng([seed, number])
        drawn = [drawn_value(variation, of_values.get(variation.name, ()), source) for variation in variations]
        variants.append(Variant(number, tuple(drawn)))
    return FixedPlan(f"random {count}, seed {seed}", variants)


def drawn_value(variation: Variation, values: Sequence[ParameterValue], source: np.random.Generator) -> ParameterValue:
    """One value. Raises CncError 26178 beyond the limits of the parameter."""
    spread = variation.spread
    if isinstance(spread, Values):
        return values[int(source.integers(len(values)))]
    if isinstance(spread, Interval):
        low, high = (math.log(spread.low), math.log(spread.high)) if spread.log else (spread.low, spread.high)
        number = float(source.uniform(low, high))
        number = min(max(math.exp(number), spread.low), spread.high) if spread.log else number
    else:
        number = float(source.normal(spread.mean, spread.sigma))
    return variation.checked(variation.of(number))


def require_few(count: int) -> None:
    if count > MOST_VARIANTS:
        reason = f"the sweep has {count} variants, more than {MOST_VARIANTS}"
        raise CncError(TOO_MANY_VARIANTS, reason, f"{NOTHING}, give fewer values or --random N", limit=MOST_VARIANTS)
