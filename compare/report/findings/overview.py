"""Finding of the whole page: how much of a distance is error, and how much is physics."""

from compare.exact.bar import equivalent_bar, jointed_bar
from compare.exact.blocks import lattice
from compare.misfit.metrics import misfit
from compare.misfit.pairs import Comparison
from compare.report.findings.finding import Finding, share
from compare.solvers.dem import DEM


def mostly_dispersion(comparison: Comparison) -> Finding:
    """Say what the rigid blocks' distance from the homogenised bar is made of.

    It holds when rock with its joints resolved explains more than half of it: the rigid blocks are
    less than half as far from the jointed bar as from the homogenised one.
    """
    r, scene = comparison.results, comparison.scene
    blocks, homogenised, jointed = (
        r[one.name] for one in (DEM, equivalent_bar.SOLVER, jointed_bar.SOLVER)
    )
    total, own = misfit(blocks, homogenised), misfit(blocks, r[lattice.SOLVER.name])
    rigid, joints = misfit(blocks, jointed), misfit(jointed, homogenised)
    holds = rigid < 0.5 * total
    end = (
        "So most of what looks like the rigid-block model's error against the homogenised series "
        "is the joints' own dispersion, which a homogenised bar does not have."
        if holds
        else "So the joints' own dispersion does not explain most of that distance."
    )
    return Finding(
        "the distance to the homogenised series is mostly the joints' own dispersion",
        f"On the paper's free pillar (y = {scene.record.stress[0]:g} m, "
        f"0 to {1e3 * scene.time.duration:g} ms) the rigid blocks lie {share(total)} from the "
        f"homogenised bar. The engine itself errs by only {share(own, 2)} (dem ~ lattice), and "
        f"rigid instead of deformable blocks cost {share(rigid)} (dem ~ jointed-bar). Elastic rock "
        f"with its {scene.block_count - 1} joints resolved lies {share(joints)} from the "
        f"homogenised bar as well. {end}",
        holds,
    )
