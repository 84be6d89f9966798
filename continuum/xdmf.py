"""Snapshots as XDMF files for dolfinx, ParaView and VisIt."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.gmsh_file import FROM_GMSH
from jointwave.continuum.space import compat
from jointwave.continuum.space.fenicsx import dolfinx
from jointwave.results.snapshots import snapshots_of
from jointwave.results.subcells import KINDS

fem, io = dolfinx.fem, dolfinx.io


def write_xdmf(path: str | Path, result: xr.Dataset) -> Path:
    """Write the snapshots of a result as NAME.xdmf and NAME.h5; return the path of NAME.xdmf.

    The mesh, "mesh", is the unloaded body, x, y, z in m; blocks share no nodes. Functions over
    time, s: "displacement", m, and "velocity", m/s, linear in cells; constant in cells, "block", at
    t = 0, and the components of the stress, Pa, compression positive.

    Raises ValueError for a result without snapshots.
    """
    s = snapshots_of(result)
    if s is None:
        raise ValueError("the result has no snapshots: give record.fields")
    kind = next(basix for basix, meshio in KINDS.items() if meshio == s.kind)
    cells = s.cells[:, FROM_GMSH[kind]].astype(np.int64)
    domain = compat.make_mesh(kind, s.points, cells)
    cell, space = compat.input_cells(domain), compat.lagrange(domain, 1, 3)
    node = np.empty(len(s.points), np.int64)
    node[compat.cell_nodes(space)] = cells[cell]
    motion = {"displacement": s.displacement, "velocity": s.velocity}
    names, stress = ["axial stress"], s.stress
    if stress is not None and stress.ndim == 3:
        names = [f"stress {one}" for one in result["stress_component"].values]
    with io.XDMFFile(domain.comm, str(path), "w") as file:
        file.write_mesh(domain)
        file.write_function(_of_cells(domain, "block", s.block[cell]), 0.0)
        for i, t in enumerate(s.time.tolist()):
            for name, values in motion.items():
                found = fem.Function(space, name=name, dtype=np.float64)
                found.x.array[:] = values[i][node].ravel()
                file.write_function(found, t)
            rows = [] if stress is None else stress[i][cell].reshape(len(cell), -1).T
            for name, values in zip(names, rows, strict=stress is not None):
                file.write_function(_of_cells(domain, name, values), t)
    return Path(path)


def _of_cells(domain: Any, name: str, values: np.ndarray) -> Any:
    found = fem.Function(compat.of_cells(domain), name=name, dtype=np.float64)
    found.x.array[:] = values
    return found
