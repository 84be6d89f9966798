"""What each effect costs: ns per block-step, alone on top of the plain kernel, then all."""

from compare.experiments.cost.scenes import ACROSS, EVERYTHING, changed
from compare.experiments.cost.step_cost import nanoseconds

PLAIN = {"record.energy": False}
LEDGER = {"record.energy": True}

ALONG = {
    "plain: springs alone": {},
    "dashpots": {"joints.damping_ratio": 0.02},
    "no tension": {"joints.tension": False},
    "joints that differ": {"soft_layers": [{"y": 20.0, "spacing_stiffness": 4.375e8}]},
    "softening": {"joints.tensile_strength": 1e9, "joints.fracture_energy": 1e9},
    "closure": {"joints.maximum_closure": 1e-3},
    "constant Q of the rock": {"rock.quality_factor": 20.0},
    "quiet end": {"ends.end": "quiet"},
    "matched end": {"ends.end": "matched"},
    "mass-proportional damping": {"damping.mass_proportional": 1.0},
    "gravity": {"gravity": {"direction": [0, 1, 0], "static": False}},
    "energy ledger": LEDGER,
}
ALL_ALONG = {
    "joints.damping_ratio": 0.02,
    "joints.tensile_strength": 1e9,
    "joints.fracture_energy": 1e9,
    "soft_layers": [{"y": 20.0, "spacing_stiffness": 4.375e8}],
    "ends.end": "matched",
    "damping.mass_proportional": 1.0,
    "gravity": {"direction": [0, 1, 0], "static": False},
    **LEDGER,
}

IN_SPACE = {
    "plain: translation and rotation": {},
    "translation alone": {"motion.rotation": "none", "load.at": [0.0, 0.0]},
    "dashpots": {"joints.damping_ratio": 0.02},
    "slip that nothing reaches": {"joints.friction_angle": 30.0, "joints.cohesion": 1e12},
    "slip": {"joints.friction_angle": 5.0, "joints.cohesion": 1e3},
    "slip that weakens": {
        "joints.friction_angle": 5.0,
        "joints.cohesion": 1e3,
        "joints.dynamic_friction_angle": 2.0,
        "joints.weakening_distance": 1e-3,
    },
    "slip that lifts": {
        "joints.friction_angle": 5.0,
        "joints.cohesion": 1e3,
        "joints.dilation_angle": 2.0,
        "joints.dilation_distance": 1e-3,
    },
    "slip by rate and state": {
        "joints.friction_angle": 5.0,
        "joints.cohesion": 1e3,
        "joints.direct_effect": 0.01,
        "joints.evolution_effect": 0.015,
        "joints.critical_slip_distance": 1e-4,
        "joints.reference_rate": 1e-6,
    },
    "no tension": {"joints.tension": False},
    "softening": {"joints.tensile_strength": 1e9, "joints.fracture_energy": 1e9},
    "closure": {"joints.maximum_closure": 1e-3},
    "3 x 3 points (with slip)": {
        "joints.friction_angle": 30.0,
        "joints.cohesion": 1e12,
        "joints.contact_points": 3,
    },
    "energy ledger": LEDGER,
    "finite rotation": {"motion.rotation": "finite"},
}


def table(title: str, rows: dict[str, dict], base: dict, whole: float) -> None:
    """Print what each row costs by itself and as a share of everything."""
    print(title)
    plain = None
    for name, changes in rows.items():
        cost = nanoseconds(changed({**PLAIN, **base, **changes}))
        plain = cost if plain is None else plain
        added = "" if cost == plain else f"{cost - plain:+8.2f}"
        print(f"  {name:34s} {cost:8.2f} ns {added:>9s} {100 * cost / whole:7.1f} %", flush=True)


def main() -> None:
    """Print both tables, for 1000 blocks, one thread, recording on."""
    print("cost of a block-step, 1000 blocks, one thread; 100 % is everything at once in space")
    whole = nanoseconds(changed(EVERYTHING))
    table("along the axis, one freedom a block", {**ALONG, "all of these": ALL_ALONG}, {}, whole)
    everything = {**IN_SPACE, "everything": EVERYTHING | LEDGER}
    table("in space, six freedoms a block", everything, ACROSS, whole)


if __name__ == "__main__":
    main()
