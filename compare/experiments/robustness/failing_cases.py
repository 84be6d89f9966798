"""Hard cases of joints that open, close, slide and break."""

from __future__ import annotations

from typing import Any

from compare.experiments.robustness.case import STEP, Case
from compare.experiments.robustness.criteria import chatter, contact, energies, extremes, layers
from compare.experiments.robustness.linear_cases import SHORT

BARRED: dict[str, Any] = {"joints.tension": False, "time.duration": 0.03}
#: Whose least fracture energy is s_t^2 / (2 K'_n) = 14.29 J/m2.
BRITTLE: dict[str, Any] = {"joints.tensile_strength": 5e5, "time.duration": 0.06}
ALL = "hard/everything-fails"
HOMOGENEOUS = {"continuum-equivalent": "a homogenised bar has no joints that open, slide or break"}

STAGES = {
    "fourth-order": "it meets the joints four times a step, where their stress is not recorded"
}


def _opening() -> list[Case]:
    same = "misfit from elastic joints under the same prestress"
    digits = "misfit from a load 2^99 times as large, over that"
    free = "misfit in front of it from a pillar that ends there, at most what the layer leaks"
    thin = {"soft_layers": [{"y": 5.0, "normal_stiffness": 8.7482e4, "thickness": 0.05}]}
    return [
        Case(
            "prestress that cancels the wave",
            SHORT,
            same,
            contact.just_closed,
            BARRED | {STEP: 0.5},
            HOMOGENEOUS | STAGES,
        ),
        Case(
            "gap of the smallest number",
            SHORT,
            "traction that should not be there, Pa",
            contact.one_ulp,
            BARRED,
            HOMOGENEOUS,
        ),
        Case(
            "joints that open and close by 1e-40 m",
            SHORT,
            digits,
            contact.scales_by_two,
            BARRED,
            HOMOGENEOUS,
        ),
        Case(
            "thin meshed layer a millionth as stiff as the rock", SHORT, free, layers.free_end, thin
        ),
    ]


def _breaking() -> list[Case]:
    cost = "fracture energy spent over that of a joint, off a whole number"
    return [
        Case(
            "softening just short of a snap-back",
            SHORT,
            cost,
            contact.whole_joints,
            BRITTLE | {"joints.fracture_energy": 14.3},
            HOMOGENEOUS,
        ),
        Case(
            "softening that snaps back",
            SHORT,
            "refused in one line that names the key",
            extremes.refused,
            BRITTLE | {"joints.fracture_energy": 14.2},
            HOMOGENEOUS,
        ),
        Case(
            "joints that open, close, slip and break",
            ALL,
            "fall of what is spent, over the work",
            energies.passive,
            {},
            HOMOGENEOUS,
        ),
        Case(
            "the ledger of joints that open, close, slip and break",
            ALL,
            "imbalance over the work",
            contact.ledger,
            {},
            HOMOGENEOUS,
        ),
    ]


def _sliding() -> list[Case]:
    strong = {"soft_layers": [{"y": 2.0, "cohesion": 1e12}], "joints": {"damping_ratio": 0.05}}
    words = "misfit from a joint that cannot slide, where the cohesion is just the largest shear"
    return [Case("stick-slip at the exact threshold", ALL, words, contact.just_held, strong, SAME)]


#: The rock around the one joint is not what is hard.
SAME = {"continuum-equivalent": "its joint is that of the jointed rock: see there"}


def _chatter() -> list[Case]:
    loose = {"normal_stiffness": 8.7482e3, "tension": False, "damping_ratio": 1e-4}
    changes = {
        "pillar.length": 1.5,
        "soft_layers": [{"y": y} | loose for y in (0.5, 1.0)],
        "ends": {"start": "fixed", "end": "fixed"},
        "load.amplitude": 0.0,
        "record.stress": [0.5],
        "record.velocity": [],
        "record.energy": False,
        "numerics.continuum.elements_per_block": 1,
        STEP: 0.5,
    }
    words = "logarithm of the last speed over the first, off that of ten thousand dashpots' impacts"
    hours = {"implicit": "forty million implicit steps would take hours"}
    rock = dict.fromkeys(
        ("continuum-jointed", "continuum-equivalent"), "see the loose block of rock"
    )
    blocks = {"dem": "see the loose rigid block"}
    judge = chatter.restitution
    return [
        Case("a loose rigid block between walls", SHORT, words, judge, changes, hours | rock),
        Case(
            "a loose block of rock between walls",
            SHORT,
            words,
            judge,
            changes,
            hours | blocks,
            True,
        ),
    ]


FAILING = [*_chatter(), *_opening(), *_breaking(), *_sliding()]
