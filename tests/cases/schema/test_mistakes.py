"""Every contradiction of a rock mass, in the plane and in space, as one line.

A mistake is changes to a good scene, with the words that the line must hold, ... between them,
behind the key and its value as they are changed last, or behind those that follow an arrow."""

import tomllib

import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.read import load_tables

LAW = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
ROCK = {"density": 2600.0, "intact_modulus": 5e10}
PLANE = {
    "title": "plane",
    "domain": {
        "size": [60.0, 40.0],
        "openings": [[[25.0, 15.0], [35.0, 15.0], [35.0, 22.0], [25.0, 22.0]]],
        "non_convex": "cut",
    },
    "rock": ROCK,
    "joint_sets": [
        {"name": "bedding", "dip": 35.0, "spacing": 2.0, "through": [30.0, 20.0]}
        | {"scatter": 0.2, "seed": 1}
        | LAW,
        {"name": "cross", "dip": -55.0, "spacing": 3.0, "ends_at": ["bedding"], "offset": 0.5}
        | {"normal_stiffness": 2e10, "shear_stiffness": 8e9},
    ],
    "waves": [
        {"kind": "P", "direction": [0.0, 1.0], "shape": "ricker", "amplitude": 1e6, "period": 0.01}
    ],
    "loads": [{"kind": "pressure", "opening": 0, "shape": "step", "amplitude": 1e5}],
    "boundaries": dict.fromkeys(("left", "right", "bottom"), "quiet"),
    "prestress": {"xx": 5e6, "yy": 1e7},
    "gravity": {"static": False},
    "time": {"duration": 0.1},
    "record": {"points": [[40.0, 30.0]], "joints": [[31.0, 10.5]]},
}
SPACE = {
    "title": "space",
    "domain": {"size": [8.0, 6.0, 4.0]},
    "rock": ROCK,
    "joint_sets": [{"name": "bed", "dip": 0.0, "spacing": 1.0} | LAW],
    "waves": [{"kind": "P", "direction": [0.0, 0.0, 1.0], "shape": "step", "amplitude": 1e6}],
    "boundaries": {"bottom": "quiet"},
    "time": {"duration": 0.1},
    "record": {"points": [[1.0, 1.0, 1.5]]},
}
UPPER = "regions = [{ name = 'upper', through = [0.0, 25.0] }]"
OUTLINE = "no domain.size; domain.outline"
SIDE = "no loads[0].opening; loads[0].side"
FORCE = "no loads[0].opening; loads[0].kind = 'force'"
DOWN = "loads[0].direction = [0.0, -1.0]"
PUSH = f"{FORCE}; {DOWN}; loads[0].quantity = 'force'; loads[0].at"
PERIODIC = "boundaries.front = 'periodic'; boundaries.back = 'periodic'"
BOX = "domain.openings = [[[1.0, 1.0, 1.0], [3.0, 3.0, 2.0]]]"
PRISM = "domain.prisms = [{ axis = 'x', polygon"

IN_PLANE = {
    # regions
    "regions = [{ name = 'upper' }] -> regions[0].through": "give through or outline",
    f"{UPPER}; regions[0].outline = [[4, 1], [5, 1]] -> regions[0].through": "through or outline",
    "regions = [{ name = 'a', outline = [[40, 1], [50, 1]] }] -> regions[0].outline": "a polygon",
    "regions = [{ name = 'a', outline = [[40, 1], [50, 1], [50, 0]] }] -> regions[0].outline = [": (
        "inside the domain"
    ),
    "regions = [{ name = 'a', outline = [[1, 1, 1]] }] -> regions[0].outline": "2 numbers a corner",
    f"{UPPER}; regions[0].densty = 2300.0": "unknown key",
    "regions = [{ name = 'rock', through = [0, 25] }] -> regions[0].name = 'rock'": "not 'rock'",
    f"{UPPER}; regions[1] = {{ name = 'upper', through = [0, 30] }} -> regions[1].name": "unique",
    "regions = [{ name = 'a', through = [0, 45] }] -> regions[0].through": "region empty",
    f"{UPPER}; regions[1] = {{ name = 'over', through = [0, 20] }} -> regions[0].through": (
        "region empty ... later regions"
    ),
    "regions = [{ name = 'a', through = [0, -1] }] -> regions = 1": "leave part of the domain",
    "joint_sets[1].regions = ['low'] -> joint_sets[1].regions = 'low'": "name regions: rock",
    f"{UPPER}; regions[0].density = 2300.0; joint_sets[0].damping_ratio = 0.02": "of one density",
    # the domain
    "tme = {} -> tme": "unknown key ... did you mean time",
    "pillar = {} -> pillar": "give [pillar] or [domain]",
    "no domain.size -> domain": "give exactly one of domain.size",
    "domain.outline = [[0.0, 0.0]] -> domain": "give exactly one of domain.size",
    "domain.size = [60.0]": "have 2 numbers",
    f"{OUTLINE} = [[0, 0], [60, 40], [60, 0], [0, 40]] -> domain.outline": (
        "does not cross itself ... Self-intersection[30 20]"
    ),
    f"{OUTLINE} = [[0, 0], [60, 40]] -> domain.outline": "it has no area",
    "domain.openings = [[[25, 15], [95, 15], [35, 22], [25, 22]]] -> domain.openings[0]": (
        "must lie in the domain"
    ),
    "domain.openings = [[[25, 15], [35, 15], [30, 15]]] -> domain.openings[0]": "must be a polygon",
    "domain.openings[1] = [[30, 20], [50, 20], [50, 30]] -> domain.openings[1]": (
        "must not overlap openings[0]"
    ),
    "domain.openings = [[[0, 0], [60, 0], [60, 40], [0, 40]]] -> domain.openings[0]": "leave rock",
    f"{PRISM} = [[1, 1], [2, 1], [2, 2]] }}] -> domain.prisms = [{{polygon = [[1.0": (
        "2.0]], axis = 'x'}]: has no meaning in the plane"
    ),
    "rock.p_speed = 2000.0": "unknown key",
    "no prestress.yy": "is required",
    "prestress.zz = 1000000.0": "no meaning in the plane",
    # joint sets
    "joint_sets[0].dipp = 1": "name, dip",
    "joint_sets[0].dip_direction = 0.0": "no meaning in the plane",
    "joint_sets[1].name = 'bedding'": "must be unique",
    "joint_sets[1].ends_at = ['fault'] -> joint_sets[1].ends_at = 'fault'": "bedding",
    "joint_sets[1].ends_at = ['cross'] -> joint_sets[1].ends_at = 'cross'": "bedding",
    "joint_sets[1].ends_at = ['bedding', 'bedding']": "not repeat a set",
    "joint_sets[1].dip = -145.0 -> joint_sets[1].ends_at = 'bedding'": "the two sets are parallel",
    "joint_sets[0].ends_at = ['cross'] -> joint_sets": "sets end at each other: bedding, cross",
    "no joint_sets[1].ends_at -> joint_sets[1].offset = 0.5": "without joint_sets[1].ends_at",
    "no joint_sets[1].spacing": "or through",
    "no joint_sets[0].spacing -> joint_sets[0].scatter = 0.2": "no meaning",
    "no joint_sets[0].seed": "is required with",
    "no joint_sets[0].scatter -> joint_sets[0].seed = 1": "no meaning without",
    "no joint_sets[0].shear_stiffness": "required",
    "joint_sets[1].tensile_strength = 1e5; joint_sets[1].fracture_energy = 0.1": (
        "at least 0.2501 J/m2"
    ),
    "damping.rayleigh = { frequencies = [1.0, 9.0], ratios = [0.1, 0.1] }; "
    "joint_sets[1].damping_ratio = 0.1": "damping.rayleigh",
    "joint_sets[1].damping_ratio = 0.1; joint_sets[1].viscosity = 1e6 -> joint_sets[1].damping": (
        "contradicts viscosity: give one of them"
    ),
    # receivers
    "record.points = [[40.0, 41.0]] -> record.points[0] = [40.0, 41.0]": "lie in the domain",
    "record.points = [[1, 1], [30, 20]] -> record.points[1] = [30.0, 20.0]": "outside its openings",
    "record.joints = [[31.0, 20.0]] -> record.joints[0]": "outside its openings",
    "record.points = [[40, 30], [40, 30]] -> record.points[1]": "not repeat a position",
    "record.points = [[4.0, 3.0, 1.0]] -> record.points[0]": "2 numbers",
    "no record.points; no record.joints -> record": "give at least one of record.points",
    # waves, loads and sides
    "boundaries.bottom = 'fixed'": "waves[0]",
    "no waves[0].direction": "is required",
    "waves[0].direction = [1.0, 1.0]": "unit vector",
    "waves[0].kind = 'R'": "'P', 'S' or 'SV'",
    "loads[0].opening = 1": "of the 1 ",
    "no loads[0].opening -> loads[0].side": "exactly one of side and opening",
    "loads[0].side = 'top'": "exactly one of side and",
    f"{SIDE} = 'top'; loads[0].between = [[10, 40], [20, 39]] -> loads[0].between = [20.0, 39.0]": (
        "must lie on top"
    ),
    f"{FORCE} -> loads[0].at": "loads[0].kind = 'force'",
    f"{PUSH} = [30.0, 20.0]": "outside its openings",
    f"{FORCE}; {DOWN}; loads[0].at = [30, 10] -> loads[0].quantity = 'stress'": "be 'force' here",
    f"{PUSH} = [30, 40]; boundaries.top = 'fixed' -> loads[0].at = [30.0, 40.0]": (
        "must not push on a fixed side, which bears it"
    ),
    f"{PUSH} = [30, 40]; boundaries.top = 'roller' -> loads[0].at = [30.0, 40.0]": (
        "must not push on a roller side, which bears it"
    ),
    f"{DOWN}; loads[0].kind = 'base'; loads[0].quantity = 'velocity'; {SIDE} = 'top'": (
        "needs boundaries.top = 'fixed' or 'quiet', not 'free'"
    ),
    f"{SIDE} = 'outline'": "which has left, right, bottom, top",
    "boundaries.front = 'fixed'": "is not a side of this domain",
    "boundaries.left = 'periodic'": "needs boundaries.right = 'periodic'",
    "no gravity.static; gravity.direction = [0, 1] -> gravity.static = true": "needs a fixed side",
    "gravity.direction = [0.0, 1.0] -> boundaries.left = 'quiet'": (
        "does not bear the weight ... needs a fixed side"
    ),
}
IN_SPACE = {
    "record.points = [[1.0, 1.0]] -> record.points[0] = [1.0, 1.0]": (
        "must have 3 numbers: the domain is in space"
    ),
    "joint_sets[0].dip = 90.0 -> joint_sets[0].dip_direction": "is required in space",
    "waves[0].kind = 'S' -> waves[0].polarisation": "is required for an S wave in space",
    "waves[0].kind = 'S'; waves[0].polarisation = [0.0, 0.0, -1.0]": (
        "is required for an S wave in space: not along"
    ),
    "waves[0].polarisation = [1.0, 0.0, 0.0]": "is of S waves",
    "prestress.xx = 1e6; prestress.yy = 1e6 -> prestress.zz": "is required in space",
    "regions = [{ name = 'a', outline = [[1, 1, 1]] }] -> regions[0].outline = [[1.0": "no meaning",
    "regions = [{ name = 'a', outline = [[1, 1], [2, 1]] }] -> regions[0].outline": "no meaning in",
    "domain.openings = [[[1, 1, 1], [2, 1, 1], [2, 2, 1]]] -> domain.openings[0]": (
        "must be two opposite corners of a box"
    ),
    "domain.openings = [[[1, 1, 1], [2, 2, 9]]] -> domain.openings[0]": "in the domain, near [",
    f"{BOX}; {PRISM} = [[2.0, 0.5], [4.0, 1.5], [2.0, 1.5]] }}] -> domain.prisms[0]": (
        "must not overlap openings[0], near [2, 2."
    ),
    "domain.openings = [[[0, 0, 0], [8, 6, 4]]] -> domain.openings[0]": "leave rock, near [4, 3, 2",
    "numerics.continuum.cell = 'triangle'": "has no meaning in space",
    f"{PRISM} = [[1, 1], [2, 2], [2, 1], [1, 2]] }}] -> domain.prisms[0].polygon": (
        "must be a polygon that does not cross itself"
    ),
    f"{PRISM} = [[1, 1], [2, 1], [2, 2]] }}]; domain.prisms[0].ends = [3.0, 2.0]": (
        "must be two increasing numbers"
    ),
    f"{PERIODIC}; regions = [{{ name = 'cap', through = [0, 0, 2], dip_direction = 0.0 }}]; "
    "regions[0].dip = 10.0": "must be parallel to the y axis: boundaries.front is periodic",
    "no joint_sets[0].spacing; joint_sets[0].through = [0, 0, 7] -> joint_sets[0].through": (
        "must lie in the domain, near [0, 0, 7]"
    ),
    "domain.openings = [[[0, 0, 1], [2, 2, 2]]] -> record.points[0] = [1.0, 1.0, 1.5]": (
        "must lie in the domain and outside its openings"
    ),
    "loads = [{ kind = 'pressure', side = 'bottom', shape = 'step', amplitude = 1.0 }]; "
    "loads[0].between = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]": "has no meaning in space",
}
CASES = [(PLANE, *one) for one in IN_PLANE.items()] + [(SPACE, *one) for one in IN_SPACE.items()]


@pytest.mark.parametrize(("good", "mistake", "words"), CASES, ids=[one[1] for one in CASES])
def test_a_mistake_is_one_line(spoilt, in_toml, good, mistake, words):
    text, named = spoilt(in_toml(good), mistake)
    with pytest.raises(SceneError) as error:
        load_tables(tomllib.loads(text))
    line = str(error.value)
    assert line.startswith(f"scene: {named}") and "\n" not in line and len(line) < 550
    for word in words.split(" ... "):
        assert word in line


def test_an_entry_of_a_list_may_be_named_as_messages_name_it():
    """`joint_sets[0].spacing` is `joint_sets.0.spacing`; a list without entries says so."""
    for key in ("joint_sets[0].spacing", "joint_sets.0.spacing"):
        assert load_tables(SPACE, "", {key: 0.5}).joint_sets[0].spacing == 0.5
    with pytest.raises(SceneError, match="the list, which is empty"):
        load_tables(SPACE | {"joint_sets": []}, "", {"joint_sets[0].spacing": 0.5})
