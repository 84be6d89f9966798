"""The table of points: a row each, what is missing or failed included."""

import os
import platform

import pandas as pd

from jointwave.compare.runs.timings import processor
from jointwave.compare.studies.summary import cell

#: The columns that all studies share, then those of the peers.
COLUMNS = (
    *("curve", "method", "settings", "state", "message", "misfit", "steps", "work", "bytes"),
    *("seconds", "spread", "setup", "compile", "whole"),
    *("solves", "reference", "total_misfit", "freedoms", "rate", "whole_spread", "beside"),
    *("stepping_over_ours", "stepping_over_ours_least", "stepping_over_ours_most"),
    *("whole_over_ours", "whole_over_ours_least", "whole_over_ours_most", "machine"),
)


def missing_row(curve: str, solves: str, reason: str) -> dict:
    """Return the row of a peer that cannot be had."""
    return {"curve": curve, "solves": solves, "state": "missing", "message": reason}


def frame(rows: list[dict]) -> pd.DataFrame:
    """Return the rows as a table; a value that a row does not have stays empty."""
    cells = [{key: cell(value) for key, value in row.items()} for row in rows]
    return pd.DataFrame(cells, columns=list(COLUMNS))


def machine() -> str:
    """Return what the seconds were taken on."""
    load = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    return f"{processor()}, {os.cpu_count()} cores, one used{load}, {platform.platform()}"
