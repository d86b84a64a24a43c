"""Variants chosen by Optuna from the results before, in batches of a fixed size: the same on any number of workers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.sweep.faults import BAD_VARIATION, NOTHING, sweep_package
from cnc_ptp.sweep.goals import Goal
from cnc_ptp.sweep.plans import require_few
from cnc_ptp.sweep.results import Row, Variant
from cnc_ptp.sweep.spread import Interval, Normal
from cnc_ptp.sweep.variation import Variation

BATCH = 8
"""Variants that are chosen at once, from the same results; so many may be computed at the same time."""


class OptimisedPlan:
    """Optuna's tree-structured Parzen estimator, which takes several goals; its first choices are random."""

    def __init__(self, variations: Sequence[Variation], goals: Sequence[Goal], count: int, seed: int) -> None:
        """Raises CncError 26013, 26177, 26178, 26185."""
        require_few(count)
        self._optuna = sweep_package("optuna")
        self.description = f"optimise {count}, seed {seed}, optuna {self._optuna.__version__}"
        self.total = count
        self._space = {variation.name: self._distribution(variation) for variation in variations}
        self._variations = variations
        self._optuna.logging.set_verbosity(self._optuna.logging.ERROR)
        self._study = self._optuna.create_study(
            directions=["maximize" if goal.maximise else "minimize" for goal in goals],
            sampler=self._optuna.samplers.TPESampler(seed=seed),
        )
        self._asked: list[Any] = []

    def _distribution(self, variation: Variation) -> Any:
        spread, kinds = variation.spread, self._optuna.distributions
        if isinstance(spread, Normal):
            reason = f"{variation.name}={variation.text} has no limits, which --optimise needs: a:b"
            raise CncError(BAD_VARIATION, reason, NOTHING, where="--vary")
        if isinstance(spread, Interval):
            low, high = variation.extremes()
            kind = kinds.IntDistribution if variation.whole else kinds.FloatDistribution
            return kind(low, high, log=spread.log)
        return kinds.CategoricalDistribution(variation.values())

    def batches(self) -> Iterator[Sequence[Variant]]:
        for first in range(0, self.total, BATCH):
            self._asked = [self._study.ask(self._space) for _ in range(min(BATCH, self.total - first))]
            yield [
                Variant(trial.number, tuple(trial.params[variation.name] for variation in self._variations))
                for trial in self._asked
            ]

    def tell(self, rows: Sequence[Row]) -> None:
        for trial, row in zip(self._asked, rows, strict=True):
            if row.error:
                self._study.tell(trial, state=self._optuna.trial.TrialState.FAIL)
            else:
                self._study.tell(trial, list(row.goals))
