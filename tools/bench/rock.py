"""The cases of the continuum's benchmark: for the engine, and in plain numbers."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from plain_dolfinx import Pillar, Steps, in_order
from rows import changed

from jointwave import cases
from jointwave.cases.read import load
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.build import Discrete, build_model
from jointwave.continuum.explicit.march import run
from jointwave.continuum.model import Model
from jointwave.continuum.run import discrete_and_steps
from jointwave.continuum.state import Samples, State, empty_samples, state_at_rest

BLOCKS = 100
SAME_STEPS = 200  # of the motion that all must share
SAME = 1e-10  # of its largest displacement
DIRECTION = (0.6, 0.8, 0.0)

#: Elements in each direction of a block, and their order.
CASES = {"linear": (4, 1), "cubic": (1, 3)}


SCENE = Path(cases.__file__).parent / "rock-mass" / "random-network.toml"
LARGE = {"domain.size": [60.0, 60.0], "record.energy": False, "numerics.continuum.size": 0.5}


def network(**changes) -> RockMass:
    """Return a network of joints, 60 m x 60 m in elements of 0.5 m, with dotted keys changed."""
    return load(SCENE, {**LARGE, **changes})[0]  # type: ignore[return-value]


class Engine(NamedTuple):
    """A scene ready to run."""

    discrete: Discrete
    model: Model
    state: State
    samples: Samples
    time: Clock

    def march(self, first: int, last: int) -> None:
        """Take steps first .. last - 1."""
        run(self.model, self.state, self.samples, self.time.stride, first, last)

    @property
    def displacement(self) -> np.ndarray:
        """Displacements of all nodes [nodes, 3] by block, y, z and x, m."""
        body = self.discrete.body
        block = np.empty(len(body.x), dtype=np.int64)
        centre = body.corners[:, :, 1].mean(axis=1)
        block[body.cells] = (centre // self.discrete.properties.spacing)[:, None]
        nodes = in_order(body.x, block)
        return np.stack([self.state.u[body.freedom(nodes, c)] for c in range(3)], axis=1)


def scene_of(case: str, **changes) -> Scene:
    """Return the scene of a case: undamped rock and joints, struck obliquely."""
    elements, order = CASES[case]
    return changed(
        {
            "load.direction": list(DIRECTION),
            "record.energy": False,
            "record.stress": [],
            "record.velocity": [20.25],
            "numerics.continuum.dim": 3,
            "numerics.continuum.scheme": "explicit",
            "numerics.continuum.order": order,
            "numerics.continuum.elements_per_block": elements,
            "numerics.continuum.elements_across": elements,
            **changes,
        },
        BLOCKS,
    )


def engine_of(case: str) -> Engine:
    """Return the engine on a case, at rest."""
    scene = scene_of(case)
    discrete, choice, _ = discrete_and_steps(scene, "jointed", 3)
    time = choice.time
    model = build_model(scene, discrete, "jointed", time)
    state = state_at_rest(model, False)
    return Engine(discrete, model, state, empty_samples(model, state, time.samples), time)


def pillar_of(case: str, engine: Engine) -> Pillar:
    """Return the same scene in plain numbers."""
    elements, order = CASES[case]
    rock, law = engine.discrete.materials[0], engine.model.interfaces.law
    return Pillar(
        blocks=BLOCKS,
        d=engine.discrete.properties.spacing,
        n=elements,
        p=order,
        modulus=rock.modulus,
        poisson=rock.poisson,
        density=rock.density,
        normal=law.normal_stiffness,
        shear=law.shear_stiffness,
        dt=engine.time.dt,
        pressure=engine.model.ends.loaded.pressure,
        direction=DIRECTION,
    )


def assert_same(engine: Engine, others: list[Steps]) -> None:
    """Stop unless all come to the same displacements."""
    engine.march(0, SAME_STEPS)
    own = engine.displacement
    for other in others:
        other.march(SAME_STEPS)
        found = other.u.reshape(-1, 3)[in_order(other.x, other.block)]
        error = np.abs(found - own).max() / np.abs(own).max()
        assert error < SAME, f"not the same motion: {error:.1e}"
