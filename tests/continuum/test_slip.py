"""Where joints slide: rigid blocks, deformable rock and the exact joint tend to each other."""

import numpy as np

from jointwave import cases, dem
from jointwave.compare.exact.joint import sliding_joint
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.scenes import SHIPPED
from jointwave.continuum import simulate

SCENE = SHIPPED / "beyond" / "slip-three-cohesions.toml"


def sliding(block: float):
    """Return the shipped scene with its shear wave and blocks of this length, m."""
    changes = {
        "pillar.block": block,
        "rock.intact_modulus": 8.64e10,
        "numerics.continuum.elements_per_block": 1,
        "record.interval": 2e-4,
        "expect": {},
    }
    return cases.load_variant(SCENE, "", changes)


def test_blocks_and_rock_tend_to_the_exact_sliding_joint():
    """Blocks of 1, 0.5 and 0.25 m in a wave of 32 m, one joint at half the strength that it needs.

    Both engines disperse waves by the square of the block over the wavelength, and put as much
    rock in series with the joint as a block has: a misfit of first order. At every halving
    both lose at least 40 % of theirs; extrapolated to no block length, half a percent is left.
    """
    misfits = []
    for block in (1.0, 0.5, 0.25):
        scene = sliding(block)
        blocks, rock = dem.simulate(scene), simulate(scene, "jointed", dim=1)
        exact = sliding_joint.solve(scene)
        waves = [result["shear"].values[..., 0] for result in (blocks, rock, exact)]
        misfits.append(
            [
                relative_l2(waves[0], waves[2]),
                relative_l2(waves[1], waves[2]),
                relative_l2(waves[0], waves[1]),
            ]
        )
    misfits = np.array(misfits)
    assert (misfits[1:, :2] < 0.6 * misfits[:-1, :2]).all()
    assert (misfits[1:, 2] < 0.7 * misfits[:-1, 2]).all()
    assert (np.abs(2 * misfits[-1] - misfits[-2]) < 0.005).all()
