"""Explicit or implicit steps: which a scene asks for, or which cost less, and why."""

from math import ceil
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee

from jointwave.cases.errors import SceneError
from jointwave.cases.sampling import MOST_STEPS, Clock, clock, sample_times
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.mesh.size import resolved_period
from jointwave.continuum.stepping.problem import Problem

STEPS_PER_IMPLICIT = 20  # explicit steps that one implicit step must replace to be looked into
#: Entries that a step takes in a second: of products, and of triangular factors.
PRODUCT_RATE, FACTOR_RATE = 1e9, 3e8
#: Operations a second of a factorisation, and what an implicit step costs besides, s.
FACTORISATION_RATE, OVERHEAD = 1e9, 1e-3
ITERATIONS = 3  # of Newton's method where joints open, slide or break


class Choice(NamedTuple):
    """How a scene is stepped: "explicit" or "implicit", its clock, and the reason in a phrase."""

    scheme: str
    time: Clock
    reason: str


def choose(scene: AnyScene, problem: Problem, critical: float) -> Choice:
    """Return the scheme of a scene; critical : the critical step of explicit steps, s.

    Raises SceneError for a step that cannot be taken.
    """
    given = scene.numerics.continuum.scheme
    if given == "auto":
        return _cheaper(scene, problem, critical)
    steps = _explicit if given == "explicit" else _implicit
    return Choice(given, steps(scene, critical), f"numerics.continuum.scheme = '{given}'")


def _explicit(scene: AnyScene, critical: float) -> Clock:
    numerics = scene.numerics.continuum
    return clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "continuum")


def _implicit(scene: AnyScene, critical: float = 0.0) -> Clock:
    many = scene.numerics.continuum.steps_per_period
    stride = max(1, ceil(scene.interval * many / resolved_period(scene) * (1 - 1e-12)))
    time = Clock(scene.interval / stride, stride, len(sample_times(scene)))
    if time.steps > MOST_STEPS:
        key = "numerics.continuum.steps_per_period"
        raise SceneError(scene.where, key, many, f"gives {time.steps:.3g} steps")
    return time


def _cheaper(scene: AnyScene, problem: Problem, critical: float) -> Choice:
    """Return the faster scheme, by operation counts."""
    implicit = _implicit(scene)
    many = scene.time.duration / (critical * scene.numerics.continuum.step_fraction)
    few = implicit.steps
    if many < STEPS_PER_IMPLICIT * few:
        few_more = f"{STEPS_PER_IMPLICIT} x {few:,} implicit ones"
        reason = f"{many:,.0f} explicit steps are fewer than {few_more}"
        return Choice("explicit", _explicit(scene, critical), reason)
    stiffness, bends = problem.stiffness, problem.parts is not None and any(problem.parts[1:3])
    bends = bends or (problem.parts is not None and problem.parts.slip)
    cheap = many * (stiffness.nnz + 10 * stiffness.shape[0]) / PRODUCT_RATE
    costly = _implicit_seconds(stiffness, bends, few)
    reason = (
        f"{many:,.0f} explicit steps, some {cheap:.2g} s, against {few:,} implicit ones, some "
        f"{costly:.2g} s"
    )
    if cheap <= costly:
        return Choice("explicit", _explicit(scene, critical), reason)
    return Choice("implicit", implicit, reason)


def _implicit_seconds(stiffness: csr_matrix, bends: bool, steps: int) -> float:
    """Return a guess of the seconds of implicit steps, whose triangular factors fill the envelope
    of a narrow numbering."""
    order = reverse_cuthill_mckee(stiffness, symmetric_mode=True)
    narrow = stiffness[order][:, order].tocoo()
    reach = np.zeros(stiffness.shape[0], dtype=np.int64)
    np.maximum.at(reach, narrow.row, narrow.row - narrow.col)
    entries = float(2 * reach.sum() + reach.size)
    solve = entries / FACTOR_RATE + OVERHEAD
    factorise = entries**2 / max(stiffness.shape[0], 1) / FACTORISATION_RATE
    return steps * ITERATIONS * (solve + factorise) if bends else steps * solve + factorise
