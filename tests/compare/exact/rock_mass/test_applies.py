"""Which exact solution of rock masses answers yes to which scene, and the reason of every no."""

import numpy as np
import pytest

from jointwave.compare.engines import applies

LAW = {"normal_stiffness": 4e10, "shear_stiffness": 2e10}
FORCE = {"kind": "force", "quantity": "force", "at": [20.0, 15.0], "direction": [0.0, 1.0]}
FORCE |= {"shape": "ricker", "amplitude": 1e6, "period": 0.002}
PRESSURE = {"kind": "pressure", "side": "top", "shape": "step", "amplitude": 1.0}
STEP = {"kind": "P", "direction": [0.0, 1.0], "shape": "step", "amplitude": 1.0}
HOLE = {"openings": [[[1, 1], [2, 1], [2, 2], [1, 2]]]}
RAYLEIGH = {"rayleigh": {"frequencies": [100, 200], "ratios": [0.01, 0.02]}}
NO_POINT = {"points": [], "fields": 1e-3, "joints": []}
SPACED = {"spacing": 6.0, "through": [0.0, 3.0]}
SLIT = {"spacing": 0.5, "dip": 0.0, "through": [0.0, 1.0]}
STACKS = ("oblique-joint", "parallel-joints")
WAVES = (*STACKS, "block-lattice", "effective-medium")
ALL = (*WAVES, "line-force")
LATTICE, LINE, LEAVE = ("block-lattice",), ("line-force",), (*STACKS, "effective-medium")

#: Changes of a scene that a solution holds for, the reason why it does not then, and the solutions.
NO = [
    ({"gravity": {"static": False}}, "gravity acts", ALL),
    ({"damping": {"mass_proportional": 1.0}}, "the damping is proportional to mass", ALL),
    ({"damping": RAYLEIGH}, "the rock is damped", ALL),
    ({"damping": {"local": 0.1}}, "the damping is local and not linear", ALL),
    ({"waves": []}, "no wave enters", WAVES),
    ({"loads": [PRESSURE]}, "a load acts", WAVES),
    ({"loads": [FORCE]}, "a load acts", LEAVE),
    ({"domain": HOLE}, "the domain has openings", LEAVE),
    ({"joint_sets": []}, "there is no joint", LEAVE),
    ({"boundaries": {"left": "free"}}, "the left is free and reflects waves", LEAVE),
    ({"boundaries": {"top": "fixed"}}, "the top is fixed and reflects waves", LEAVE),
    ({"boundaries": {"top": "fixed"}}, "a side is fixed", LATTICE),
    ({"boundaries": {"top": "roller"}}, "a side is roller", LATTICE),
    ({"prestress": {"xx": 1e6, "yy": 1e6}}, "the rock is prestressed", LATTICE),
    ({"numerics": {"dem": {"block": 0.5}}}, "intact rock is subdivided into blocks", LATTICE),
    ({"domain": {"size": [60.0, 60.0]}}, "more than 1,000 blocks", LATTICE),
    ({"record": NO_POINT}, "no point is recorded", (*LATTICE, *LINE)),
    ({"waves": [STEP]}, "a wave has no period", LATTICE),
    ({"waves": [STEP]}, "a wave enters", LINE),
    ({"loads": []}, "no force acts", LINE),
    ({"loads": [FORCE | {"shape": "step", "period": None}]},
     "a force jumps, so that velocities at its arrivals are unbounded", LINE),
    ({"loads": [PRESSURE]}, "a load other than a force acts", LINE),
    ({"domain": HOLE}, "the domain is not convex, or has openings", LINE),
    ({"record": {"points": [[20.0, 15.0]], "joints": []}}, "a receiver lies on a force", LINE),
    ({"record": {"points": [[40.0, 15.0]], "joints": []}},
     "a side reflects before any receiver is reached", LINE),
    ({"boundaries": dict.fromkeys(("left", "right"), "periodic")}, "a side is periodic", LINE),
]  # fmt: skip
#: Keys of a joint set that a solution does not hold for, and the reason.
LAWS = [
    ({"tension": False}, " carries no tension"),
    ({"maximum_closure": 1e-3}, ": a joint stiffens as it closes"),
    ({"friction_angle": 30.0}, " can slip"),
    ({"cohesion": 1e6}, " can slip"),
    ({"tensile_strength": 1e5, "fracture_energy": 10.0}, ": a joint has a tensile strength"),
]


@pytest.fixture
def held(rock_mass, joint, wave):
    """Return a function that gives a scene that a solution holds for, with tables changed."""
    grid = [joint(**LAW, name="cross", dip=90.0, spacing=1.0), joint(**LAW | SLIT)]
    crossed = [joint(**LAW, name=name, dip=dip, spacing=1.0) for name, dip in (("a", 0), ("b", 80))]
    points = {"points": [[20.0, 20.0], [26.0, 15.0]], "joints": []}
    own = {
        "oblique-joint": {},
        "parallel-joints": {"joint_sets": [joint(**SPACED)]},
        "block-lattice": {"joint_sets": grid, "domain": {"size": [3.0, 6.0]}},
        "effective-medium": {"joint_sets": crossed},
        "line-force": {"joint_sets": [], "waves": [], "loads": [FORCE]},
    }
    own["block-lattice"]["record"] = {"points": [[1.5, 0.25]], "joints": []}
    own["line-force"] |= {"time": {"duration": 0.008}}
    return lambda name, **changes: rock_mass(**{"record": points} | own[name] | changes)


@pytest.mark.parametrize("name", ALL)
def test_it_holds_and_says_why_it_does_not(held, name):
    assert applies(name, held(name)).reason == ""
    for changes, reason, names in NO:
        if name in names:
            assert applies(name, held(name, **changes)).reason == reason


@pytest.mark.parametrize("name", WAVES)
def test_it_holds_for_linear_joints_alone(held, name):
    scene = held(name)
    *others, last = [one.model_dump(exclude_none=True) for one in scene.joint_sets]
    for law, reason in LAWS:
        answer = applies(name, held(name, joint_sets=[*others, last | law]))
        assert answer.reason == f"joint set {last['name']!r}{reason}"


def test_attitudes_spacings_and_dashpots_decide_which_one_holds(held, joint, pillar):
    def reason(name, *sets, **changes):
        return applies(name, held(name, joint_sets=list(sets), **changes)).reason

    several, crossed = joint(**SPACED), [joint(), joint(name="other", dip=26.0)]
    assert reason("parallel-joints", joint()) == "there is one joint"
    assert reason("oblique-joint", several) == "there are 8 joints: see parallel-joints"
    assert reason("parallel-joints", *crossed) == "joints are not parallel"
    assert reason("oblique-joint", joint(dip=90.0)) == "waves[0] travels along the joints"
    assert not applies("oblique-joint", pillar())
    one, other = joint(**LAW, name="a", spacing=1.0), joint(**LAW, name="b", dip=80.0, spacing=2.0)
    assert reason("effective-medium", one, other) == ""
    parallel, lone = other | {"dip": 25.0}, joint(**LAW, name="b", dip=80.0)
    assert reason("effective-medium", one, parallel) == "joints are parallel: see parallel-joints"
    assert reason("effective-medium", one, lone) == "a joint has no spacing"
    assert reason("effective-medium", one, other | {"damping_ratio": 0.1}) == (
        "the joints are damped"
    )
    bed = joint(**LAW | SLIT)
    assert reason("block-lattice", bed | {"damping_ratio": 0.1}) == "the joints are damped"
    assert reason("block-lattice", joint(**LAW, dip=0.0, through=[0.0, 1.0])) == (
        "no joint set has a spacing"
    )
    assert reason("line-force", joint()) == "there are joints"


def test_domains_with_bays_and_pulses_that_have_begun_are_refused(rock_mass, held, wave):
    bay = [[0, 0], [40, 0], [40, 30], [20, 28], [0, 30]]
    domain = {"size": None, "outline": bay, "non_convex": "cut"}
    scene = rock_mass(domain=domain, boundaries={"outline": "quiet", "top": None})
    assert applies("oblique-joint", scene).reason == "the domain is not convex"
    begun = [wave(through=[0.0, 5.0])]
    expected = "a pulse is inside the domain before t = 0"
    assert applies("effective-medium", held("effective-medium", waves=begun)).reason == expected


def test_a_pulse_that_has_met_the_joint_is_told_where_to_begin(rock_mass, joint, wave):
    """S waves at 34 degrees make P waves at 75.6 degrees, which run ahead of them: those made far
    to the left are at the lower left corner first, at the least time of all ways by the joint."""
    x = np.linspace(-100, 0, 100_001)
    y = 5 + (x - 20) * np.tan(np.radians(34))
    first = (y / np.sqrt(8e6) + np.hypot(x, y) / np.sqrt(2.4e7)).min()
    low, s_wave = joint(dip=34.0, through=[20.0, 5.0]), wave(kind="S")
    reason = applies("oblique-joint", rock_mass(joint_sets=[low], waves=[s_wave])).reason
    place = [float(x) for x in reason.split("[")[-1].split("]")[0].split(",")]
    assert "reaches a joint before t = 0" in reason
    assert place == pytest.approx([0, np.sqrt(8e6) * first], abs=1e-4)
    back = s_wave | {"through": [place[0], place[1] - 1e-4]}
    assert applies("oblique-joint", rock_mass(joint_sets=[low], waves=[back]))


CLOSES = {"maximum_closure": 1e-4}
SLIPS = {"friction_angle": 30.0, "cohesion": 2e5}
WEAKENS = {"dynamic_friction_angle": 10.0, "weakening_distance": 1e-5}
PRESSED, S, UP = {"xx": 1e6, "yy": 1e6}, {"kind": "S"}, {"direction": [0.0, 1.0]}
STRAIGHT = [
    ({}, {}, {}, "no joint has closure or can slip: see oblique-joint"),
    (CLOSES | {"damping_ratio": 0.1}, {}, {}, "the joint is damped"),
    (CLOSES | {"friction_angle": 30.0}, {}, {}, "joint set 'joint' can slip"),
    (CLOSES, UP, {}, "a wave is not one at normal incidence"),
    (CLOSES, S, {}, "the joint cannot slip under an S wave: see oblique-joint"),
    (SLIPS, S | UP, PRESSED, "a wave is not one at normal incidence"),
    (SLIPS, S, PRESSED | {"xx": 4e6}, "the prestress exceeds the joint's strength"),
    (SLIPS, S, {"xx": -1e5, "yy": -1e5}, "no normal stress closes the joint at all times"),
    (SLIPS | {"tension": False}, S, {}, "no normal stress closes the joint at all times"),
    (SLIPS | WEAKENS, S, PRESSED, "friction falls with slip faster than the joint unloads"),
    (SLIPS | {"dilation_angle": 5.0, "dilation_distance": 1e-3}, S, PRESSED,
     "joint set 'joint': a joint dilates as it slips"),
]  # fmt: skip


def test_normal_incidence_holds_for_one_joint_that_stiffens_or_slips(straight):
    assert applies("normal-incidence", straight(CLOSES, {}))
    assert applies("normal-incidence", straight(SLIPS, S, PRESSED))
    for law, one, pressed, reason in STRAIGHT:
        assert applies("normal-incidence", straight(law, one, pressed)).reason == reason
