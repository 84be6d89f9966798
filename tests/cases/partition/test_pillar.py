"""The blocks of pillars in one dimension and in space, against formulas and against each other."""

import numpy as np
import pytest

from jointwave import load_variants, shipped
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.partition.pillar import blocks_of_pillar

SCENES = (scene for name in shipped() for scene in load_variants(name) if scene.is_column)
#: One of each kind of pillar, by all that its blocks depend on.
PILLARS = {repr((s.pillar, s.parts, s.soft_layers, s.scatter)): s for s in SCENES}.values()


@pytest.mark.parametrize("scene", PILLARS, ids=lambda one: f"{one.title} {one.name}")
def test_shipped_pillars_are_the_same_in_one_dimension_and_in_space(scene):
    """Faces of a^2 with second moments a^4 / 12, cuboids a x d x a; one dimension has lengths."""
    chain, row, p = blocks_of_pillar(scene), blocks_of_pillar(scene, 3), calibrate(scene)
    side, number = scene.pillar.side, np.arange(scene.block_count)
    for blocks in (chain, row):
        assert blocks.contacts.blocks.tolist() == np.stack([number[:-1], number[1:]], 1).tolist()
        np.testing.assert_array_equal(blocks.body.region, p.segment)
        np.testing.assert_array_equal(blocks.contacts.joint_set == NO_SET, p.weld)
    np.testing.assert_array_equal(chain.contacts.joint_set, row.contacts.joint_set)
    np.testing.assert_array_equal(chain.contacts.centroid[:, 0], p.joint_y)
    assert (chain.contacts.normal == 1).all() and (chain.contacts.area == 1).all()
    assert (row.contacts.normal == [0, 1, 0]).all()

    shortest = chain.volume.min()
    assert row.volume == pytest.approx(side**2 * chain.volume, rel=1e-12)
    assert row.centroid[:, 1] == pytest.approx(chain.centroid[:, 0], rel=1e-12)
    assert np.abs(row.centroid[:, [0, 2]]).max() < 1e-12 * side
    assert np.abs(row.contacts.centroid - np.outer(p.joint_y, [0, 1, 0])).max() < 1e-12 * shortest
    assert row.contacts.area == pytest.approx(side**2, rel=1e-12)
    flat = np.diag([side**4 / 12, 0, side**4 / 12])
    assert np.abs(row.contacts.second_moment - flat).max() < 1e-12 * side**4

    masses = np.full(p.block_count, p.block_mass) if p.masses is None else p.masses
    density = np.array([one.density for one in p.each])[chain.body.region]
    assert density * row.volume == pytest.approx(masses, rel=1e-11)
    if p.is_uniform:
        (xx, yy, zz), off = np.einsum("nii->in", row.second_moment), ~np.eye(3, dtype=bool)
        assert p.density * (xx + yy) == pytest.approx(p.inertia_across, rel=1e-11)
        assert p.density * (xx + zz) == pytest.approx(p.inertia_along, rel=1e-11)
        assert np.abs(row.second_moment[:, off]).max() < 1e-12 * xx.max()


@pytest.mark.parametrize("dim", [1, 3])
def test_blocks_follow_each_other_whatever_the_section(pillar, dim):
    """Also where centroids across the pillar differ by round-off."""
    for k, side in enumerate(np.geomspace(0.01, 100.0, 40)):
        scene = pillar(pillar__length=47.9 + k, pillar__block=(47.9 + k) / 51, pillar__side=side)
        found = blocks_of_pillar(scene, dim)
        assert (np.diff(found.contacts.blocks, axis=1) == 1).all() and len(found.contacts) == 50
        assert (np.diff(found.centroid[:, dim // 2]) > 0).all()


def test_joints_know_their_law(pillar):
    """Joints of a soft layer by its number, contacts within intact rock by none."""
    scene = pillar(
        rock__intact_modulus=1e11,
        segments=[{"y": [10.0, 20.0], "joints": False}],
        soft_layers=[{"y": 30.0}, {"y": 12.0, "normal_stiffness": 1e9}],
    )
    found = blocks_of_pillar(scene)
    laws = dict(zip(found.contacts.centroid[:, 0], found.contacts.joint_set.tolist(), strict=True))
    expected = {10.0: 0, 11.0: NO_SET, 12.0: 2, 20.0: 0, 30.0: 1, 40.0: 0}
    assert {y: laws[y] for y in expected} == expected
    assert found.body.region[[0, 19, 20, 39, 40, 99]].tolist() == [0, 0, 1, 1, 2, 2]
