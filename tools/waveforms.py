"""Waveforms of a few scenes as a file, or against such a file from another machine or environment.

    usage: python tools/waveforms.py FILE     (writes FILE; where it is there already, compares)

The scenes are linear and stable, so that round-off stays round-off: whatever dolfinx, numpy and
compiler made them, waveforms agree to 1e-9 of their largest value. Exit 1 where they do not.
"""

import sys
from pathlib import Path

import numpy as np

import cases
from compare.engines import solve

LARGEST = 1e-9
PILLAR = Path(cases.__file__).parent / "guo-li-2002" / "fig-03.toml"
SHORT = {
    "variants": [],
    "pillar.length": 5.0,
    "record.stress": [0.0, 1.3, 2.5],
    "record.velocity": [0.0, 1.75],
    "record.interval": 1e-4,
    "time.duration": 1e-2,
    "load.period": 2e-3,
    "joints.damping_ratio": 0.02,
    "ends.end": "quiet",
}
SPACE = {"load.direction": [0.6, 0.8, 0.0], "numerics.continuum.elements_per_block": 1}

#: What solves a scene, and what is changed in it.
SCENES = {
    "rigid blocks": ("dem", {}),
    "rigid blocks in space": ("dem", SPACE),
    "bar, explicit": ("continuum-jointed", {"numerics.continuum.scheme": "explicit"}),
    "bar, implicit": ("continuum-jointed", {"numerics.continuum.scheme": "implicit"}),
    "homogenised bar, order 4": ("continuum-equivalent", {"numerics.continuum.order": 4}),
    "plane stress, explicit": (
        "continuum-jointed",
        SPACE | {"numerics.continuum.dim": 2, "numerics.continuum.scheme": "explicit"},
    ),
    "column of tetrahedra, implicit": (
        "continuum-equivalent",
        SPACE
        | {
            "numerics.continuum.dim": 3,
            "numerics.continuum.cell": "simplex",
            "numerics.continuum.scheme": "implicit",
        },
    ),
}


def main(file: Path) -> int:
    """Write or compare; return the exit status."""
    found = {f"{name}: {key}": x for name in SCENES for key, x in waveforms(name).items()}
    if not file.exists():
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("wb") as out:
            np.savez(out, **found)
        print(f"{len(found)} waveforms written to {file}")
        return 0
    with np.load(file, allow_pickle=False) as held:
        apart = {name: distance(x, held[name]) for name, x in found.items()}
    for name, far in apart.items():
        print(f"{name:50s} {far:.1e}{'' if far <= LARGEST else '   beyond 1e-9'}")
    return int(not all(far <= LARGEST for far in apart.values()))


def waveforms(name: str) -> dict[str, np.ndarray]:
    """Return what a scene's receivers record, by quantity."""
    solver, changes = SCENES[name]
    result = solve(solver, cases.load_variant(PILLAR, "", SHORT | changes))
    return {key: result[key].values for key in ("stress", "velocity", "displacement")}


def distance(one: np.ndarray, other: np.ndarray) -> float:
    """Return the largest difference over the largest value; infinite for other shapes."""
    if one.shape != other.shape or not np.abs(other).max() > 0:
        return np.inf
    return float(np.abs(one - other).max() / np.abs(other).max())


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(str(__doc__))
    sys.exit(main(Path(sys.argv[1])))
