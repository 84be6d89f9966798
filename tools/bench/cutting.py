"""Cutting a domain into blocks, in the plane and in space: time and memory per block."""

import resource
from time import process_time

import numpy as np

from jointwave.cases.partition.scene import blocks_of_domain
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet

LAW = {"normal_stiffness": 1e10, "shear_stiffness": 4e9, "spacing": 1.0}
ANGLES = np.linspace(0, 2 * np.pi, 32, endpoint=False)
HOLE = np.stack([150 + 8 * np.cos(ANGLES), 150 + 8 * np.sin(ANGLES)], axis=1).tolist()


def sets(dim: int, **keys: object) -> list[JointSet]:
    """Return two or three oblique joint sets; keys : of the last set."""
    attitudes = [{"dip": 5.0}, {"dip": 80.0}]
    if dim == 3:
        attitudes = [
            {"dip": dip, "dip_direction": turn} for dip, turn in ((8, 40), (85, 95), (82, 5))
        ]
    tables = [{"name": str(k), **LAW, **one} for k, one in enumerate(attitudes)]
    tables[-1] |= keys
    return [JointSet.model_validate(one, context={"dimension": dim}) for one in tables]


def main() -> None:
    """Print a line for each domain."""
    rows = {"ends_at": ["0"], "scatter": 0.2, "seed": 1}
    wide = {"size": [316.0, 316.0], "non_convex": "cut"}
    for name, dim, domain, keys in (
        ("plane", 2, wide, {}),
        ("plane, scattered rows", 2, wide, rows),
        ("plane, an opening of 32 faces", 2, wide | {"openings": [HOLE]}, {}),
        ("space", 3, {"size": [46.0] * 3}, {"ends_at": ["0"], "offset": 0.5}),
    ):
        whole, start = Domain.model_validate(domain, context={"dimension": dim}), process_time()
        found = blocks_of_domain(whole, sets(dim, **keys))
        spent = process_time() - start
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        print(
            f"{name}: {found.count:,} blocks in {spent:.1f} s, {1e6 * spent / found.count:.0f} us"
        )
        print(f"  peak memory of the process so far {peak / found.count:.1f} kB a block")
