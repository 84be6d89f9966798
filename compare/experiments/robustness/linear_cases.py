"""Hard cases of elastic joints: steps, stiffness contrasts, layers, damping, very many steps."""

from typing import Any

from compare.experiments.robustness.case import STEP, HardCase, rock_is_spared
from compare.experiments.robustness.criteria import accuracy, energies, layers, steps

#: A blow with its peak at 1 kHz, above the cut-off of 860 Hz, so that all modes ring.
BLOW = {"load.period": 1e-3, "numerics.continuum.elements_per_block": 1}
JOINT = 8.748e9  # Pa/m, K'_n of an ordinary joint of the short pillar
RIGID = {"rock.intact_modulus": 1e29, "time.duration": 0.02, STEP: 0.9}


def _steps() -> list[HardCase]:
    no_limit = {"implicit": "implicit steps have no critical step"}
    below = [
        HardCase(f"step at {x} of the critical", steps.impulse_bound, {STEP: x} | BLOW, no_limit)
        for x in (0.9, 0.999, 1.0)
    ]
    above = {STEP: 1.001} | BLOW
    long = {
        "numerics.continuum.steps_per_period": 0.5,
        "record.interval": 2e-3,
        "load.period": 1e-3,
        "time.duration": 5.0,
        "numerics.continuum.elements_per_block": 1,
    }
    explicit = {
        "dem": "explicit steps only, see the step at 1.001",
        "explicit": "see the step at 1.001",
    }
    return [
        *below,
        HardCase("step at 1.001 of the critical", steps.caught, above, no_limit),
        HardCase("implicit steps far above the critical", steps.never_grows, long, explicit),
    ]


def _contrasts() -> list[HardCase]:
    deforms = rock_is_spared("its rock deforms: see the case of deformable blocks")
    stiff = {"dem": "stiff joints of blocks as stiff as rock: see the case of rigid blocks"}
    rock = {"time.duration": 0.02, STEP: 0.9, "record.velocity": []}
    found = []
    for c in ("1e-8", "1e-4", "1e4", "1e8"):
        k = float(c) * JOINT
        joints = {"soft_layers": [{"y": 0.5 + i, "normal_stiffness": k} for i in range(10)]}
        name = f"every second joint {c} as stiff"
        found += [
            HardCase(f"{name}, rigid blocks", layers.as_chain, joints | RIGID, deforms),
            HardCase(name, accuracy.near_exact, joints | rock, stiff),
        ]
    return found


def _layer(stiffness: float) -> dict[str, Any]:
    return {"soft_layers": [{"y": 5.0, "normal_stiffness": stiffness}]}


def _layers() -> list[HardCase]:
    whole = {
        "dem": "blocks are rigid: see the two blocks that are one",
        "continuum-equivalent": "its ordinary joint would have to be removed",
    }
    many = {"continuum-jointed explicit": "takes 1e9 steps: see the layer 1e5 as stiff"}
    stiff, welded = _layer(1e5 * JOINT) | {STEP: 0.9}, _layer(1e8 * JOINT) | RIGID
    rock = rock_is_spared("see the layer of deformable rock")
    soft = "soft layer of 1e-12 of a joint's stiffness"
    return [
        HardCase(soft, layers.free_end, _layer(1e-12 * JOINT)),
        HardCase("soft layer of 1e-30 Pa/m", layers.free_end, _layer(1e-30)),
        HardCase("layer 1e5 as stiff as a joint", layers.no_layer, stiff, whole),
        HardCase(
            "layer 1e12 as stiff as a joint", layers.no_layer, _layer(1e12 * JOINT), whole | many
        ),
        HardCase("two blocks on a joint 1e8 as stiff", layers.welded_blocks, welded, rock),
    ]


def _damping() -> list[HardCase]:
    return [
        HardCase(
            f"damping ratio {zeta:g}",
            accuracy.near_exact,
            {"joints.damping_ratio": zeta, STEP: 0.9 if zeta > 1 else 0.1},
        )
        for zeta in (0.0, 0.1, 1.0, 10.0)
    ]


def _attenuation() -> list[HardCase]:
    blocks = {"dem": "its exact solution is of the chain without: see the tests of its modes"}
    return [
        HardCase(
            f"rock of Q = {quality:g}",
            accuracy.near_exact,
            {"rock.quality_factor": quality, STEP: 0.9},
            blocks,
        )
        for quality in (5.0, 1e5)
    ]


TINY = BLOW | {
    STEP: 0.9,
    "pillar.length": 2.0,
    "record.stress": [1.0],
    "record.velocity": [],
    "numerics.continuum.spectral_radius": 1.0,
}
MILLION = HardCase(
    "a million undamped steps",
    energies.no_trend(1_000_000),
    TINY,
    {"implicit": "a million implicit steps take minutes: see the hundred thousand"},
)
IMPLICIT_LONG = HardCase(
    "a hundred thousand undamped implicit steps",
    energies.no_trend(100_000),
    TINY,
    {"dem": "its steps are explicit: see the million", "explicit": "see the million"},
    slow=True,
)

LINEAR = [
    *_steps(),
    *_contrasts(),
    *_layers(),
    *_damping(),
    *_attenuation(),
    MILLION,
    IMPLICIT_LONG,
]
