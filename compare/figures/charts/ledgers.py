"""Energy ledgers in numbers: what the load has put in, what became of it, and what is missing."""

from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from compare.figures.charts.interactive import thinned
from compare.figures.style import TERMS, in_order
from compare.figures.subplots import variant_names
from compare.misfit.pairs import Comparison

MOST = 480  # samples of a curve, and of the table
LEAST = 1e-17  # of what is drawn of a residual: below round-off


class Ledger(NamedTuple):
    """The ledger of one engine's run of one variant, since its first sample.

    time : [n], s. terms : [n] by name, J, work among them. residual : [n], the sum of all others
    less the work, over the largest work; of the largest term, where no work is done.
    """

    variant: str
    engine: str
    time: np.ndarray
    terms: dict[str, np.ndarray]
    residual: np.ndarray

    @property
    def missing(self) -> np.ndarray:
        """The size of the residual, no number where it is zero: its axis is logarithmic."""
        size = np.abs(self.residual)
        return np.where(size > LEAST, size, np.nan)


def ledgers_of(comparisons: list[Comparison]) -> list[Ledger]:
    """Return the ledger of every engine and variant that has kept one."""
    return [
        _ledger(variant, engine, comparison.results[engine])
        for comparison, variant in zip(comparisons, variant_names(comparisons), strict=True)
        for engine in in_order(set(comparison.results))
        if "energy" in comparison.results[engine]
    ]


def _ledger(variant: str, engine: str, result: xr.Dataset) -> Ledger:
    """Return the ledger of an engine's result."""
    since = result["energy"].values - result["energy"].values[:, :1]
    names = [str(term) for term in result["term"].values]
    work = since[names.index("work")]
    scale = float(np.abs(work if work.any() else since).max()) or 1.0
    kept = thinned(len(work), MOST)
    residual = (since.sum(axis=0) - 2 * work) / scale
    terms = {term: since[i, kept] for i, term in enumerate(names)}
    return Ledger(variant, engine, result.time.values[kept], terms, residual[kept])


def table(ledgers: list[Ledger]) -> pd.DataFrame:
    """Return a row a variant, engine and sample; a term that a run has not is empty."""
    return pd.concat(
        pd.DataFrame(
            {
                "variant": ledger.variant,
                "engine": ledger.engine,
                "time (s)": ledger.time,
                **{f"{term} (J)": values for term, values in ledger.terms.items()},
                "residual (of the largest work)": ledger.residual,
            }
        )
        for ledger in ledgers
    ).reset_index(drop=True)


def drawn_terms(ledgers: list[Ledger]) -> list[str]:
    """Return the terms that are not zero throughout, in the order of the legend."""
    return [t for t in TERMS if any(t in x.terms and x.terms[t].any() for x in ledgers)]
