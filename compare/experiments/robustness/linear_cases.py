"""Hard cases of elastic joints: steps, stiffness contrasts, layers, damping, very many steps."""

from __future__ import annotations

from typing import Any

from compare.experiments.robustness.case import STEP, Case
from compare.experiments.robustness.criteria import accuracy, energies, layers, steps

SHORT = "hard/short-pillar"
NO_LIMIT = {"implicit": "implicit steps have no critical step"}
#: A blow with its peak at 1 kHz, above the 860 Hz that the blocks pass, so that all modes ring.
BLOW = {"load.period": 1e-3, "numerics.continuum.elements_per_block": 1}
JOINT = 8.748e9  # Pa/m, K'_n of an ordinary joint of the short pillar
SECOND_ORDER = "misfit from the exact solution, at most the phase error of a second-order scheme"


def _steps() -> list[Case]:
    bounded = "fastest block or node, m/s, at most what the impulse gives at this step"
    found = [
        Case(
            f"step at {x} of the critical",
            SHORT,
            bounded,
            steps.impulse_bound,
            {STEP: x} | BLOW,
            NO_LIMIT,
        )
        for x in (0.9, 0.999, 1.0)
    ]
    caught = "refused; forced, stopped before it can have passed all numbers"
    above = {STEP: 1.001} | BLOW
    found.append(
        Case("step at 1.001 of the critical", SHORT, caught, steps.caught, above, NO_LIMIT)
    )
    only = {
        "dem": "explicit steps alone, see the step at 1.001",
        "explicit": "see the step at 1.001",
    }
    long = {
        "numerics.continuum.steps_per_period": 0.5,
        "record.interval": 2e-3,
        "load.period": 1e-3,
        "time.duration": 20.0,
        "numerics.continuum.elements_per_block": 1,
    }
    grows = "energy after the load, over that at its end"
    found.append(
        Case("implicit steps far above the critical", SHORT, grows, steps.never_grows, long, only)
    )
    return found


def _contrasts() -> list[Case]:
    found = []
    every_second = [0.5 + i for i in range(10)]
    rigid = {"rock.intact_modulus": 1e29, "time.duration": 0.02, STEP: 0.9}
    for c in ("1e-8", "1e-4", "1e4", "1e8"):
        joints = {
            "soft_layers": [{"y": y, "normal_stiffness": float(c) * JOINT} for y in every_second]
        }
        found.append(
            Case(
                f"every second joint {c} as stiff, rigid blocks",
                SHORT,
                SECOND_ORDER,
                layers.as_chain,
                joints | rigid,
                {
                    "continuum-jointed": "its rock deforms: see the case of deformable blocks",
                    "continuum-equivalent": "its rock deforms: see the case of deformable blocks",
                },
            )
        )
        found.append(
            Case(
                f"every second joint {c} as stiff",
                SHORT,
                SECOND_ORDER,
                accuracy.near_exact,
                joints | {"time.duration": 0.02, STEP: 0.9, "record.velocity": []},
                {"dem": "stiff joints of blocks as stiff as rock: see the case of rigid blocks"},
            )
        )
    return found


def _layers() -> list[Case]:
    def layer(stiffness: float) -> dict[str, Any]:
        return {"soft_layers": [{"y": 5.0, "normal_stiffness": stiffness}]}

    free = "misfit in front of it from a pillar that ends there, at most what the layer leaks"
    weld = "misfit from the exact bar without it, at most its delay and the phase error"
    block = "misfit from the chain in which the two blocks are one"
    rigid = {
        "continuum-jointed": "see the layer of deformable rock",
        "continuum-equivalent": "see the layer of deformable rock",
    }
    rocks = {
        "dem": "blocks are rigid: see the two blocks that are one",
        "continuum-equivalent": "its ordinary joint would have to be taken out",
    }
    return [
        Case(
            "soft layer of 1e-12 of a joint's stiffness",
            SHORT,
            free,
            layers.free_end,
            layer(1e-12 * JOINT),
        ),
        Case("soft layer of 1e-30 Pa/m", SHORT, free, layers.free_end, layer(1e-30)),
        Case(
            "layer 1e5 as stiff as a joint",
            SHORT,
            weld,
            layers.no_layer,
            layer(1e5 * JOINT) | {STEP: 0.9},
            rocks,
        ),
        Case(
            "layer 1e12 as stiff as a joint",
            SHORT,
            weld,
            layers.no_layer,
            layer(1e12 * JOINT),
            rocks | {"continuum-jointed explicit": "takes 1e9 steps: see the layer 1e5 as stiff"},
        ),
        Case(
            "two blocks on a joint 1e8 as stiff",
            SHORT,
            block,
            layers.welded_blocks,
            layer(1e8 * JOINT) | {"rock.intact_modulus": 1e29, "time.duration": 0.02, STEP: 0.9},
            rigid,
        ),
    ]


def _damping() -> list[Case]:
    return [
        Case(
            f"damping ratio {zeta:g}",
            SHORT,
            SECOND_ORDER,
            accuracy.near_exact,
            {"joints.damping_ratio": zeta, STEP: 0.9 if zeta > 1 else 0.1},
        )
        for zeta in (0.0, 0.1, 1.0, 10.0)
    ]


TINY = BLOW | {
    STEP: 0.9,
    "pillar.length": 2.0,
    "record.stress": [1.0],
    "record.velocity": [],
    "numerics.continuum.spectral_radius": 1.0,
}
TREND = "linear trend of the energy, at most a random walk of round-off and the fit's own error"
MILLION = Case(
    "a million undamped steps",
    SHORT,
    TREND,
    energies.no_trend(1_000_000),
    TINY,
    {"implicit": "a million implicit steps take minutes: see the hundred thousand"},
)
IMPLICIT_LONG = Case(
    "a hundred thousand undamped implicit steps",
    SHORT,
    TREND,
    energies.no_trend(100_000),
    TINY,
    {"dem": "its steps are explicit: see the million", "explicit": "see the million"},
    slow=True,
)


LINEAR = [*_steps(), *_contrasts(), *_layers(), *_damping(), MILLION, IMPLICIT_LONG]
