"""Rigid blocks of regions of unlike rock: layers against the exact waves in them."""

import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.schema.rock_mass import Boundaries
from jointwave.compare.engines import solve
from jointwave.compare.exact.rock_mass.field import field_of
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.dem import simulate
from jointwave.results.dataset import energy_residual

SOFT = {"name": "soft", "through": [0.0, 8.0], "density": 2200.0, "intact_modulus": 2e10}
HARD = {"name": "hard", "through": [0.0, 14.0], "density": 2900.0, "intact_modulus": 7e10}
LAW = {"normal_stiffness": 1e10, "shear_stiffness": 5e9}
BED = {"name": "bed", "dip": 0.0, "through": [0.0, 14.0]} | LAW


def layers(rock_mass, wave, kind, block, **changes):
    """Return 2 m by 20 m of three rocks without a Poisson effect: a joint along the second of their
    boundaries, the first one welded. The sides along the travel are periodic, by joints there that
    are as good as none."""
    stiff = dict.fromkeys(LAW, 1e16)
    seam = {"name": "seam", "dip": 90.0, "spacing": 1.0} | stiff
    tables = {
        "domain": {"size": [2.0, 20.0]},
        "rock": {"intact_poisson": 0.0},
        "regions": [SOFT, HARD],
        "joint_sets": [BED, seam],
        "waves": [wave(kind=kind)],
        "boundaries": {"left": "periodic", "right": "periodic"},
        "numerics": {"dem": {"block": block}},
        "time": {"duration": 0.02},
        "record": {"points": [[1.2, 3.0], [1.2, 11.0], [1.2, 18.0]], "joints": [[1.2, 14.0]]},
    }
    return rock_mass(**tables | changes)


def misfits(scene):
    """Return those of the velocity along the motion and of the joint's jump, and the ledger's."""
    exact = solve("parallel-joints", alone(scene))
    found = simulate(scene, incident=field_of(alone(scene)))
    axis, jump = (1, "gap") if scene.waves[0].kind == "P" else (0, "slip")
    moved = relative_l2(found.velocity.values[..., axis], exact.velocity.values[..., axis])
    return moved, relative_l2(found[jump].values, exact[jump].values), energy_residual(found)


def alone(scene):
    """Return a scene without its seams, and quiet all around."""
    quiet = Boundaries(**dict.fromkeys(("left", "right", "bottom", "top"), "quiet"))
    return scene.model_copy(update={"joint_sets": scene.joint_sets[:1], "boundaries": quiet})


@pytest.mark.parametrize("kind, least", [("P", 3.6), ("S", 3.0)])
def test_waves_in_layers_are_the_exact_ones(rock_mass, wave, kind, least):
    """Blocks of half the size leave a quarter, of S somewhat more, as in one rock, whose blocks
    turn at a quiet side (3.4 there). The ledger closes at round-off."""
    coarse, fine = (misfits(layers(rock_mass, wave, kind, block)) for block in (0.5, 0.25))
    for one, other in zip(coarse[:2], fine[:2], strict=True):
        assert least < one / other < 4.6
        assert other < 0.02
    assert fine[2] < 1e-11


@pytest.mark.parametrize(
    ("regions", "words"),
    [
        ([SOFT | {"dip": 10.0}], r"regions\[0\].dip = 10.0: must be parallel to the x"),
        ([SOFT, HARD], "waves = 1: cross several rocks"),  # the engine alone knows those of one
    ],
)
def test_what_layers_cannot_be(rock_mass, wave, regions, words):
    with pytest.raises(SceneError, match=words):
        simulate(layers(rock_mass, wave, "P", 1.0, regions=regions))


def test_every_region_needs_blocks(rock_mass, wave):
    seam = {"name": "seam", "dip": 90.0, "spacing": 1.0, "regions": ["rock"]} | LAW
    numerics = {"dem": {"block": None}}
    with pytest.raises(SceneError, match="and region 'soft' has no joints"):
        simulate(rock_mass(regions=[SOFT], joint_sets=[seam], numerics=numerics, waves=[wave()]))


def test_boundaries_that_are_not_parallel_know_no_field(rock_mass, wave):
    changes = {"regions": [SOFT, HARD | {"dip": 20.0}]}
    changes |= {"boundaries": {"left": "quiet", "right": "quiet"}}
    with pytest.raises(SceneError, match="field is not known: joints are not parallel"):
        field_of(layers(rock_mass, wave, "P", 1.0, **changes))


def test_an_outline_in_a_lattice_closes_its_ledger(rock_mass, wave):
    """A soft hexagon in triangles, by which a P wave passes; the same rock within it leaves the
    wave as it is in one lattice, to what the lattices' seam costs."""
    corners = [[4.0, 3.0], [7.0, 3.0], [8.5, 5.5], [7.0, 8.0], [4.0, 8.0], [2.5, 5.5]]
    tables = {
        "joint_sets": [],
        "waves": [wave()],
        "domain": {"size": [12.0, 10.0], "non_convex": "cut"},
        "record": {"points": [[4.3, 2.1], [5.2, 5.0]], "joints": []},
        "numerics": {"dem": {"block": 0.5}},
    }
    lens = {"name": "lens", "outline": corners}
    regions = ([], [lens], [lens | {"intact_modulus": 1e10}])
    scenes = (rock_mass(**tables, regions=one) for one in regions)
    plain, same, soft = (simulate(x, incident=field_of(x)) for x in scenes)
    assert relative_l2(same.velocity.values, plain.velocity.values) < 0.06
    assert relative_l2(soft.velocity.values, plain.velocity.values) > 0.3
    assert energy_residual(soft) < 1e-11
