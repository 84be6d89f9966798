"""Hard cases of rock masses: thin blocks, short contacts, contrasts, grazing waves, sliding."""

from functools import partial
from math import cos, radians, sin
from typing import Any

from cases.schema.joint import PARTS
from compare.experiments.robustness.case import STEP, HardCase, rock_is_spared
from compare.experiments.robustness.criteria import energies, rock_masses

at_one_joint = partial(HardCase, scene="rock-mass/one-joint")
in_brickwork = partial(HardCase, scene="rock-mass/brickwork")
SIDES = ("left", "right", "bottom", "top")
PULSE = {"shape": "ricker", "amplitude": 1e6, "period": 5e-3}
RIGID = rock_is_spared("its rock deforms: see the ledger, or the case of rock")
ROCK = {"dem": "see the cases of rigid blocks"}
PLANE = {
    "dem fourth-order": "rigid blocks in the plane support leapfrog only",
    "continuum-equivalent": "a homogenised rock mass has no such blocks",
}
EXPLICIT = PLANE | {"implicit": "see the explicit steps"}


def _set(name: str, dip: float, **keys: Any) -> dict[str, Any]:
    law = {"normal_stiffness": 2e10, "shear_stiffness": 8e9}
    return {"name": name, "dip": dip, **law, **keys}


BEDS, CROSS = _set("bed", 0.0, spacing=1.0), _set("cross", 90.0, spacing=1.0)


def _bricks(offset: float, **keys: Any) -> list[dict[str, Any]]:
    """Return the sets of brickwork, keys changed in both: vertical joints of neighbouring courses
    are offset by this fraction of their spacing."""
    cross = {"spacing": 2.0, "ends_at": ["bed"], "offset": offset}
    return [BEDS | keys, _set("cross", 90.0, **cross, **keys)]


def _struck(sets: list[dict[str, Any]], **domain: Any) -> dict[str, Any]:
    """Return the changes that make 6 m x 4 m of these joints a free body under a force."""
    force = {"kind": "force", "quantity": "force", "at": [0.4, 0.3], "direction": [0.8, 0.6]}
    return {
        "domain": {"size": [6.0, 4.0], "least_width": 1e-4, "least_angle": 0.01} | domain,
        "joint_sets": sets,
        "waves": [],
        "loads": [force | PULSE | {"period": 2e-3}],
        "boundaries": {},
        "time.duration": 0.01,
        "record": {"points": [[0.4, 0.3], [1.6, 0.3]], "interval": 2e-5},
        "numerics.dem": {"step_fraction": 0.9},
        "numerics.continuum.size": 2.0,
    }


def _shapes() -> list[HardCase]:
    thin = _set("thin", 0.0, through=[0.0, 2.001])
    pointed = _set("pointed", 1.0, through=[0.0, 1.98])
    corner = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.999], [1.5, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]
    held = {"size": None, "outline": corner}
    bodies = {
        "blocks a thousandth as thin as their neighbours": _struck([BEDS, CROSS, thin]),
        "blocks that end in a point of one degree": _struck([BEDS, CROSS, pointed]),
        "contacts a thousandth as long as their blocks": _struck(_bricks(0.0005)),
        "a block held by one corner": _struck([CROSS], **held),
        "T-junctions of brickwork under shear": _struck(_bricks(0.5)),
    }
    judged, ledger = rock_masses.as_leapfrog, rock_masses.balanced
    return [
        *(at_one_joint(n, judged, x, EXPLICIT | RIGID) for n, x in bodies.items()),
        *(at_one_joint(f"the ledger of {n}", ledger, x, EXPLICIT) for n, x in bodies.items()),
    ]


def _contrast() -> list[HardCase]:
    stiff = _set("stiff", 90.0, spacing=2.0, point_rule="gauss")
    stiff |= {"normal_stiffness": 2e18, "shear_stiffness": 8e17}
    changes = _struck([BEDS | {"point_rule": "gauss"}, stiff], size=[4.0, 2.0])
    rigid = changes | {"rock.intact_modulus": 1e29}
    coarse = changes | {"numerics.continuum.size": 1.0}
    name, judge = "one set 1e8 as stiff as the other", rock_masses.without_stiff_set
    exact = rock_masses.as_leapfrog
    many = PLANE | ROCK | {"explicit": "takes 1e4 times as many steps: see the implicit ones"}
    return [
        at_one_joint(f"{name}, rigid blocks", judge, rigid, EXPLICIT | RIGID),
        at_one_joint(name, judge, coarse, many),
        at_one_joint(f"{name}, in closed form", exact, rigid, EXPLICIT | RIGID),
    ]


def _wave(degrees: float, kind: str = "P") -> list[dict[str, Any]]:
    angle = radians(degrees)
    return [PULSE | {"kind": kind, "direction": [sin(angle), cos(angle)]}]


def _met(sets: list[dict[str, Any]], size: float, waves: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the changes for a square with these joints, crossed by waves."""
    return {
        "domain": {"size": [size, size], "least_width": 1e-3},
        "joint_sets": sets,
        "waves": waves,
        "boundaries": dict.fromkeys(SIDES, "quiet"),
        "time.duration": 0.016,
        "record": {"points": [[1.5, 1.5], [4.5, 4.5]], "joints": [[3.0, size / 2]]},
        "numerics.dem": {},
        "numerics.continuum.size": 1.25,
    }


def _grazing() -> list[HardCase]:
    joint = [_set("joint", 0.0, through=[0.0, 5.0])]
    near = _met([*joint, _set("next", 0.0, through=[0.0, 5.01])], 10.0, _wave(30))
    lattice, exact = rock_masses.near_lattice, rock_masses.near_joints
    found = [at_one_joint("two joints a hundredth of a metre apart", exact, near, EXPLICIT | ROCK)]
    for angle in (80, 88):
        name, waves = f"a wave at {angle} degrees", _wave(angle)
        blocks, rock = _met([BEDS, CROSS], 6.0, waves), _met(joint, 10.0, waves)
        found += [
            at_one_joint(f"{name}, rigid blocks", lattice, blocks, EXPLICIT | RIGID),
            at_one_joint(f"{name} on a joint", exact, rock, EXPLICIT | ROCK),
        ]
    return found


def _sliding() -> list[HardCase]:
    strong = _wave(90, "S")
    strong[0]["amplitude"] = 4e6
    changes = _met(_bricks(0.5, friction_angle=15.0), 6.0, strong)
    changes |= {"prestress": {"xx": 8e6, "yy": 8e6}, "numerics.continuum.size": 1.0}
    lifts = {"dilation_angle": 8.0, "dilation_distance": 1e-3}
    lifted = changes | {"joint_sets": _bricks(0.5, friction_angle=15.0, **lifts)}
    name = "T-junctions of brickwork that slide"
    return [
        at_one_joint(name, rock_masses.within_friction, changes, EXPLICIT),
        at_one_joint(f"the ledger of {name}", rock_masses.balanced, changes, EXPLICIT),
        *(
            at_one_joint(
                f"{name}; {part.words}",
                energies.passive,
                changes | {"joint_sets": _bricks(0.5, friction_angle=15.0, **part.hard)},
                EXPLICIT,
            )
            for part in PARTS
            if part.hard
        ),
        at_one_joint(
            f"the ledger of {name}, lifted by slip", rock_masses.balanced, lifted, EXPLICIT
        ),
    ]


def _long() -> list[HardCase]:
    force = _struck([])["loads"][0] | {"at": [1.2, 0.7], "period": 1e-3}
    patch = {
        "domain.size": [4.0, 2.0],
        "boundaries": {"bottom": "periodic", "top": "periodic"},
        "waves": [],
        "loads": [force],
        "record": {"points": [[1.2, 0.7]]},
        "numerics.continuum.size": 2.0,
        STEP: 0.9,
    }
    blocks = EXPLICIT | rock_is_spared("see the hundred thousand steps of rock")
    million, fewer = energies.no_trend(1_000_000), energies.no_trend(100_000)
    fewer_steps = "a hundred thousand undamped steps of bricks of rock"
    return [
        in_brickwork("a million undamped steps of bricks", million, patch, blocks),
        in_brickwork(fewer_steps, fewer, patch, EXPLICIT | ROCK),
    ]


def _regions() -> list[HardCase]:
    """Return bricks crossed by the boundaries of rock a millionth as stiff and a hundredth as
    heavy."""
    soft = {"intact_modulus": 5e4, "density": 26.0}
    stratum = {"name": "stratum", "dip": 3.0, "through": [3.0, 2.3]} | soft
    lens = {"name": "lens", "outline": [[1.2, 0.7], [4.4, 0.9], [3.1, 2.6]]} | soft
    cases = {
        "bricks of rock and of a millionth of it": _struck(_bricks(0.5)) | {"regions": [stratum]},
        "a soft wedge in bricks": _struck(_bricks(0.5), non_convex="cut") | {"regions": [lens]},
    }
    return [
        at_one_joint(f"the ledger of {name}", rock_masses.balanced, changes, EXPLICIT)
        for name, changes in cases.items()
    ]


ROCK_MASSES = [*_regions(), *_shapes(), *_contrast(), *_grazing(), *_sliding(), *_long()]
