"""Hard cases of joints that open, close, slide and break."""

from __future__ import annotations

from typing import Any

from compare.stability import contact, extremes, layers
from compare.stability.case import STEP, Case
from compare.stability.linear import SHORT

BARRED: dict[str, Any] = {"joints.tension": False, "time.duration": 0.03}
BRITTLE: dict[str, Any] = {"joints.tensile_strength": 5e5, "time.duration": 0.06}
SNAP = 5e5**2 / (2 * 8.7482e9)  # J/m2, least fracture energy of these joints
ALL = "hard/everything-fails"
HOMOGENEOUS = {"continuum-equivalent": "a homogenised bar has no joints that open, slide or break"}


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
            HOMOGENEOUS,
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
    cost = "fracture energy spent, in joints' worth, at most that of all joints"
    return [
        Case(
            "softening just short of a snap-back",
            SHORT,
            cost,
            contact.fracture_bounded,
            BRITTLE | {"joints.fracture_energy": 1.00001 * SNAP},
            HOMOGENEOUS,
        ),
        Case(
            "softening that snaps back",
            SHORT,
            "refused in one line that names the key",
            extremes.refused,
            BRITTLE | {"joints.fracture_energy": 0.99 * SNAP},
            HOMOGENEOUS,
        ),
        Case(
            "joints that open, close, slip and break",
            ALL,
            "fall of what is spent, over the work",
            contact.second_law,
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
    return [Case("stick-slip at the exact threshold", ALL, words, contact.just_held, strong)]


FAILING = [*_opening(), *_breaking(), *_sliding()]
