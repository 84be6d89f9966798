"""Hard cases of joints that open, close, slide and break."""

from functools import partial
from typing import Any

from cases.schema.joint import PARTS
from compare.experiments.robustness.case import STEP, HardCase, rock_is_spared
from compare.experiments.robustness.criteria import chatter, contact, energies, extremes, layers

BARRED: dict[str, Any] = {"joints.tension": False, "time.duration": 0.03}
#: With a least fracture energy of s_t^2 / (2 K'_n) = 14.29 J/m2.
BRITTLE: dict[str, Any] = {"joints.tensile_strength": 5e5, "time.duration": 0.06}
ALL = "hard/everything-fails"
HOMOGENEOUS = {"continuum-equivalent": "a homogenised bar has no joints that open, slide or break"}
STAGES = {
    "fourth-order": "it meets the joints four times a step, where their stress is not recorded"
}


def _opening() -> list[HardCase]:
    thin = {"soft_layers": [{"y": 5.0, "normal_stiffness": 8.7482e4, "thickness": 0.05}]}
    return [
        HardCase(
            "prestress that cancels the wave",
            contact.just_closed,
            BARRED | {STEP: 0.5},
            HOMOGENEOUS | STAGES,
        ),
        HardCase("gap of the smallest float", contact.one_ulp, BARRED, HOMOGENEOUS),
        HardCase(
            "joints that open and close by 1e-40 m", contact.scales_by_two, BARRED, HOMOGENEOUS
        ),
        HardCase("thin meshed layer a millionth as stiff as the rock", layers.free_end, thin),
    ]


def _breaking() -> list[HardCase]:
    tough, brittle = (BRITTLE | {"joints.fracture_energy": g} for g in (14.3, 14.2))
    words = "joints that open, close, slip and break"
    mixed = partial(HardCase, spared=HOMOGENEOUS, scene=ALL)
    return [
        HardCase("softening just short of a snap-back", contact.whole_joints, tough, HOMOGENEOUS),
        HardCase("softening that snaps back", extremes.refused, brittle, HOMOGENEOUS),
        mixed(words, energies.passive, {}),
        mixed(f"the ledger of {words}", contact.ledger, {}),
        *(
            mixed(
                f"{words}; {part.words}",
                energies.passive,
                {f"joints.{key}": value for key, value in part.hard.items()},
            )
            for part in PARTS
            if part.hard
        ),
    ]


def _sliding() -> HardCase:
    strong = {"soft_layers": [{"y": 2.0, "cohesion": 1e12}], "joints": {"damping_ratio": 0.05}}
    same = {"continuum-equivalent": "its joint is that of the jointed rock: see there"}
    return HardCase("stick-slip at the exact threshold", contact.just_held, strong, same, scene=ALL)


def _chatter() -> list[HardCase]:
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
    hours = {"implicit": "forty million implicit steps would take hours"}
    rock = hours | rock_is_spared("see the loose block of rock")
    blocks = hours | {"dem": "see the loose rigid block"}
    impacts = chatter.restitution
    return [
        HardCase("a loose rigid block between walls", impacts, changes, rock),
        HardCase("a loose block of rock between walls", impacts, changes, blocks, slow=True),
    ]


FAILING = [*_chatter(), *_opening(), *_breaking(), _sliding()]
