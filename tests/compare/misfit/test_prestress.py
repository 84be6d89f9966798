"""A prestress that nothing feels changes no distance, and every solution starts from it."""

import numpy as np
import pytest

from jointwave.compare.engines import ENGINES, applies, names, solve
from jointwave.compare.misfit.metrics import worst

RECORD = {"record__stress": [5.0, 9.75], "record__velocity": [5.25]}
SHORT = {"pillar__length": 15.0, "time__duration": 0.02, **RECORD}
SHEAR = {"load__direction": [1.0, 0.0, 0.0], "motion__rotation": "none"}


def solved(scene, chosen=None):
    chosen = chosen or [name for name in names() if applies(name, scene)]
    return {name: solve(name, scene) for name in chosen}


@pytest.mark.parametrize("ends", ["free", "fixed", "matched"])
def test_all_start_from_the_same_state(pillar, ends):
    """Stress is the prestress and displacement zero at the first sample, to 1e-10."""
    results = solved(pillar(prestress={"normal": 1e6}, ends__end=ends, **SHORT))
    assert {*ENGINES, "lattice", "jointed-bar", "equivalent-bar"} <= set(results)
    for name, result in results.items():
        np.testing.assert_allclose(result.stress.values[:, 0], 1e6, rtol=1e-10, err_msg=name)
        moved = np.abs(result.displacement.values)
        assert moved[:, 0].max() <= 1e-10 * moved.max(), name


def distances(results, against):
    """Return the misfit of the rigid blocks from each of these."""
    return [worst(results["dem"], results[name]).misfit for name in against]


def test_distances_of_an_axial_scene_do_not_depend_on_its_prestress(pillar):
    """Linear, so the prestress is a constant beside the motion."""
    against = ("lattice", "continuum-equivalent", "jointed-bar")
    free = distances(solved(pillar(**SHORT), ["dem", *against]), against)
    for normal in (1e5, 1e7):
        pressed = solved(pillar(prestress={"normal": normal}, **SHORT), ["dem", *against])
        assert distances(pressed, against) == pytest.approx(free, rel=1e-6)


def test_distances_of_a_shear_wave_at_a_cohesive_joint_do_not_depend_on_its_prestress(pillar):
    """A joint of fixed cohesion without friction feels no normal stress."""
    layer = {"y": 7.5, "cohesion": 2e5}
    changes = SHORT | SHEAR | {"soft_layers": [layer], "ends__start": "matched"}
    found = []
    for normal in (1e5, 1e7):
        scene = pillar(prestress={"normal": normal}, ends__end="matched", **changes)
        furthest = worst(*solved(scene, ["dem", "continuum-equivalent"]).values())
        assert furthest.where.split()[0] in ("shear", "velocity", "displacement")
        found.append(furthest.misfit)
    assert found[1] == pytest.approx(found[0], rel=1e-6)
