"""The table of a study: one row a point, as CSV and as NetCDF, and what it says of the machine."""

import json
import os
import platform
from pathlib import Path

import numpy as np
import pandas as pd

from compare.experiments.study.measure import Row
from compare.experiments.study.study import Study
from compare.runs.output import write, write_csv


def frame(rows: list[Row]) -> pd.DataFrame:
    """Return the rows as numbers, SI, settings as JSON."""
    table = pd.DataFrame(rows, columns=list(Row._fields))
    return table.assign(settings=[json.dumps(row.settings) for row in rows])


def write_table(folder: Path, name: str, study: Study, rows: list[Row]) -> tuple[Path, Path]:
    """Write NAME.csv and NAME.nc into a folder; return both."""
    table = frame(rows)
    csv = write_csv(folder / f"{name}.csv", table)
    data = table.rename_axis("point").to_xarray()
    data = data.assign({k: v.astype(str) for k, v in data.items() if v.dtype == object})
    data.attrs = {"title": study.title, "study": study.model_dump_json(), **machine()}
    nc = write(folder / f"{name}.nc", lambda path: data.to_netcdf(path, engine="scipy"))
    return csv, nc


def machine() -> dict[str, str]:
    """Return what seconds depend on: processor, cores, versions."""
    import numba

    return {
        "processor": processor(),
        "cores": str(os.cpu_count()),
        "system": platform.platform(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


def processor() -> str:
    """Return the processor's name."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
