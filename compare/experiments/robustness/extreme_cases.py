"""Hard cases of loads, sizes and shapes."""

from __future__ import annotations

from typing import Any

from compare.experiments.robustness.case import STEP, Case
from compare.experiments.robustness.criteria import accuracy, extremes, layers
from compare.experiments.robustness.linear_cases import SECOND_ORDER, SHORT

CUT_OFF = 1.1636e-3  # s, pi d / c of the short pillar: the blocks pass no shorter period
RESONANCE = 0.0148146  # s, 2 L / c of the short pillar

ROCKS = {
    "continuum-jointed": "it has no lattice cut-off; its waves at these periods are below",
    "continuum-equivalent": "it has no lattice cut-off; its waves at these periods are below",
}
BLOCKS = {"dem": "its chain passes no such wave: see the rigid blocks above"}


def _periods() -> list[Case]:
    fine: dict[str, Any] = {
        "numerics.dem.step_fraction": 0.02,
        "numerics.continuum.step_fraction": 0.1,
        "numerics.continuum.steps_per_period": 400,
        "time.duration": 0.01,
    }
    found = []
    for words, period in (("at", CUT_OFF), ("twice", CUT_OFF / 2)):
        name = f"load {words} the lattice cut-off"
        changes = fine | {"load.period": period}
        cycles = {"load.shape": "sine", "load.cycles": 10}
        chain = Case(
            f"{name}, rigid blocks", SHORT, SECOND_ORDER, layers.as_chain, changes | cycles, ROCKS
        )
        rock = Case(
            f"{name}, deformable rock", SHORT, SECOND_ORDER, accuracy.near_exact, changes, BLOCKS
        )
        found += [chain, rock]
    ringing = {
        "load.shape": "sine",
        "load.cycles": 20,
        "load.period": RESONANCE,
        "time.duration": 0.3,
    }
    found.append(
        Case(
            "load at the first resonance of the free bar",
            SHORT,
            SECOND_ORDER,
            accuracy.near_exact,
            ringing,
        )
    )
    return found


def _loads() -> list[Case]:
    step = {"load": {"shape": "step", "amplitude": 1e6}, "time.duration": 0.02}
    front = "misfit from the exact solution, at most the dispersion of a second-order front"
    still = "largest number of the result"
    return [
        Case("step in stress", SHORT, front, extremes.shock, step),
        *(
            Case(
                f"amplitude {text} Pa",
                SHORT,
                "misfit from the result of 1 Pa times the amplitude",
                extremes.scaled,
                {"load.amplitude": float(text), "record.energy": False},
            )
            for text in ("1e-300", "1e-200", "1e200", "1e300")
        ),
        Case(
            "amplitude 1e300 Pa on joints with a strength",
            SHORT,
            "refused in one line that names the key",
            extremes.refused,
            {
                "load.amplitude": 1e300,
                "joints.tensile_strength": 1e5,
                "joints.fracture_energy": 1e2,
            },
            {"continuum-equivalent": "it has no joints that break"},
        ),
        Case("zero load", SHORT, still, extremes.nothing, {"load.amplitude": 0.0}),
    ]


def _sizes() -> list[Case]:
    causal = "misfit from a pillar of a thousand blocks before any wave is back"
    many = {"pillar.length": 5e5, "time.duration": 0.01, "record.velocity": [], STEP: 0.9}
    return [
        Case(
            "a million blocks",
            SHORT,
            causal,
            extremes.untouched_far_end,
            many,
            {
                "implicit": "implicit steps pass on all blocks at once",
                "continuum-jointed": "see the hundred thousand",
                "continuum-equivalent": "see the hundred thousand",
            },
        ),
        Case(
            "a hundred thousand blocks",
            SHORT,
            causal,
            extremes.untouched_far_end,
            many | {"pillar.length": 5e4},
            {"implicit": "implicit steps pass on all blocks at once", "dem": "see the million"},
            slow=True,
        ),
    ]


def _shapes() -> list[Case]:
    bar = "misfit from the exact bar, at most Love's correction and the phase error"
    soft = {
        "rock": {
            "density": 2400.0,
            "equivalent_modulus": 4.374e9,
            "equivalent_poisson": 0.49999,
            "intact_modulus": 8.64e10,
            "intact_poisson": 0.49999,
        }
    }
    solid = {
        "numerics.continuum.dim": 3,
        "record.velocity": [],
        STEP: 0.9,
        "numerics.continuum.elements_per_block": 1,
    }
    axial = {"dem": "its blocks along the axis have no section"}
    shape = "misfit from the exact row of blocks in space"
    rock = {k: "see the slender hexahedra" for k in ("continuum-jointed", "continuum-equivalent")}
    found = [
        Case(
            "Poisson's ratio 0.49999",
            SHORT,
            bar,
            extremes.as_bar,
            solid
            | soft
            | {
                "pillar.side": 0.05,
                "pillar.length": 4.0,
                "record.stress": [2.0],
                "time.duration": 0.01,
            },
            axial,
        ),
        Case(
            "hexahedra of aspect 1000",
            SHORT,
            bar,
            extremes.as_bar,
            solid
            | {
                "pillar.side": 0.0005,
                "pillar.length": 2.0,
                "record.stress": [1.0],
                "time.duration": 0.01,
            },
            axial,
        ),
    ]
    for ratio in (0.01, 0.1, 10, 100):
        side = 0.5 * ratio
        turned = {
            "pillar.side": side,
            "load.at": [0.2 * side, 0.0],
            "load.amplitude": 1.0,
            "pillar.length": 4.0,
            "time.duration": 0.02,
            "record.stress": [2.0],
            "record.velocity": [3.75],
        }
        found.append(
            Case(
                f"blocks {ratio:g} as wide as thick, pushed off their axis",
                SHORT,
                shape,
                extremes.in_space,
                turned,
                rock,
            )
        )
    return found


EXTREME = [*_periods(), *_loads(), *_sizes(), *_shapes()]
