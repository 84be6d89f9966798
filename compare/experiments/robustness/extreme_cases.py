"""Hard cases of loads, sizes and shapes."""

from typing import Any

from compare.experiments.robustness.case import STEP, HardCase, rock_is_spared
from compare.experiments.robustness.criteria import accuracy, extremes, layers

CUT_OFF = 1.1636e-3  # s, pi d / c of the short pillar: shortest period that the blocks transmit
RESONANCE = 0.0148146  # s, 2 L / c of the short pillar


def _periods() -> list[HardCase]:
    fine: dict[str, Any] = {
        "numerics.dem.step_fraction": 0.02,
        "numerics.continuum.step_fraction": 0.1,
        "numerics.continuum.steps_per_period": 400,
        "time.duration": 0.01,
    }
    rock = rock_is_spared("it has no lattice cut-off; its waves at these periods are below")
    blocks = {"dem": "its chain transmits no such wave: see the rigid blocks above"}
    found = []
    for words, period in (("at", CUT_OFF), ("twice", CUT_OFF / 2)):
        name, changes = f"load {words} the lattice cut-off", fine | {"load.period": period}
        cycles = {"load.shape": "sine", "load.cycles": 10}
        found += [
            HardCase(f"{name}, rigid blocks", layers.as_chain, changes | cycles, rock),
            HardCase(f"{name}, deformable rock", accuracy.near_exact, changes, blocks),
        ]
    ringing = {
        "load.shape": "sine",
        "load.cycles": 20,
        "load.period": RESONANCE,
        "time.duration": 0.3,
    }
    found.append(
        HardCase("load at the first resonance of the free bar", accuracy.near_exact, ringing)
    )
    return found


def _loads() -> list[HardCase]:
    step = {"load": {"shape": "step", "amplitude": 1e6}, "time.duration": 0.02}
    broken = {"joints.tensile_strength": 1e5, "joints.fracture_energy": 1e2}
    scaled = [
        HardCase(
            f"amplitude {text} Pa",
            extremes.scaled,
            {"load.amplitude": float(text), "record.energy": False},
        )
        for text in ("1e-300", "1e-200", "1e200", "1e300")
    ]
    return [
        HardCase("step in stress", extremes.shock, step),
        *scaled,
        HardCase(
            "amplitude 1e300 Pa on joints with a strength",
            extremes.refused,
            {"load.amplitude": 1e300} | broken,
            {"continuum-equivalent": "it has no joints that break"},
        ),
        HardCase("zero load", extremes.nothing, {"load.amplitude": 0.0}),
    ]


def _sizes() -> list[HardCase]:
    many = {"pillar.length": 5e5, "time.duration": 0.01, "record.velocity": [], STEP: 0.9}
    implicit = {"implicit": "implicit steps couple all blocks"}
    rock, blocks = rock_is_spared("see the hundred thousand"), {"dem": "see the million"}
    fewer = many | {"pillar.length": 5e4}
    return [
        HardCase("a million blocks", extremes.untouched_far_end, many, implicit | rock),
        HardCase(
            "a hundred thousand blocks",
            extremes.untouched_far_end,
            fewer,
            implicit | blocks,
            slow=True,
        ),
    ]


def _shapes() -> list[HardCase]:
    solid = {
        "numerics.continuum.dim": 3,
        "record.velocity": [],
        STEP: 0.9,
        "numerics.continuum.elements_per_block": 1,
        "time.duration": 0.01,
    }
    incompressible = solid | {
        "rock": {
            "density": 2400.0,
            "equivalent_modulus": 4.374e9,
            "equivalent_poisson": 0.49999,
            "intact_modulus": 8.64e10,
            "intact_poisson": 0.49999,
        },
        "pillar.side": 0.05,
        "pillar.length": 4.0,
        "record.stress": [2.0],
    }
    slender = solid | {"pillar.side": 0.0005, "pillar.length": 2.0, "record.stress": [1.0]}
    axial = {"dem": "its blocks along the axis have no section"}
    return [
        HardCase("Poisson's ratio 0.49999", extremes.as_bar, incompressible, axial),
        HardCase("hexahedra of aspect 1000", extremes.as_bar, slender, axial),
        *(_off_axis(ratio) for ratio in (0.01, 0.1, 10, 100)),
    ]


def _off_axis(ratio: float) -> HardCase:
    side = 0.5 * ratio
    changes = {
        "pillar.side": side,
        "load.at": [0.2 * side, 0.0],
        "load.amplitude": 1.0,
        "pillar.length": 4.0,
        "time.duration": 0.02,
        "record.stress": [2.0],
        "record.velocity": [3.75],
    }
    name = f"blocks {ratio:g} as wide as thick, loaded off their axis"
    return HardCase(name, extremes.in_space, changes, rock_is_spared("see the slender hexahedra"))


EXTREME = [*_periods(), *_loads(), *_sizes(), *_shapes()]
