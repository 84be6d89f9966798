"""The templates of `jointwave new`: values, header and footer."""

from typing import NamedTuple

from pydantic import BaseModel

from cases.schema.rock_mass import RockMass
from cases.schema.scene import Scene


class Template(NamedTuple):
    """A scene to begin with.

    given : the keys that are set, as a file spells them. offered : keys that stand there to be
    chosen, with an example where they have no default. head, tail : what stands before and after
    the tables; {file} is the scene's name.
    """

    model: type[BaseModel]
    given: dict[str, str]
    offered: dict[str, str]
    head: str
    tail: str


PILLAR = Template(
    Scene,
    given={
        "pillar.length": "20.0",
        "pillar.side": "0.5",
        "pillar.block": "0.5",
        "rock.density": "2400.0",
        "rock.p_speed": "2200.0",
        "rock.s_speed": "800.0",
        "rock.intact_modulus": "8.64e10",
        "rock.intact_poisson": "0.25",
        "soft_layers.y": "8.0",
        "soft_layers.spacing_stiffness": "4.375e8",
        "load.shape": '"ricker"',
        "load.amplitude": "1.0e6",
        "load.quantity": '"incident-stress"',
        "load.period": "0.01",
        "ends.start": '"matched"',
        "ends.end": '"matched"',
        "time.duration": "0.05",
        "record.stress": "[4.0, 12.0]",
        "record.velocity": "[4.25]",
    },
    offered={
        "rock.equivalent_modulus": "4.26e9",
        "rock.equivalent_poisson": "0.42",
        "joints.damping_ratio": "0.02",
        "joints.tension": "false",
        "joints.friction_angle": "30.0",
        "joints.cohesion": "1.0e5",
        "soft_layers.damping_ratio": "0.02",
        "soft_layers.thickness": "0.05",
        "load.cycles": "2",
        "load.file": '"load.csv"',
        "load.direction": "",
        "load.at": "",
        "gravity.direction": "[0, 1, 0]",
        "gravity.acceleration": "",
        "gravity.static": "false",
        "prestress.normal": "1.0e5",
        "record.interval": "5.0e-5",
        "record.fields": "1.0e-3",
        "record.energy": "",
        "numerics.dem.step_fraction": "",
        "numerics.continuum.dim": "2",
        "numerics.continuum.order": "",
        "numerics.continuum.elements_per_block": "2",
        "numerics.continuum.scheme": "",
    },
    head="""\
A jointwave scene: rock, joints, load, duration and receivers.
SI units. y runs along the pillar from the loaded end, x and z across; compression is positive.
Optional keys are commented out: to set one, remove "# " from its line and its table's heading.
Effects not given are not computed. Numbers such as (10) are equations of Guo & Li (2002).
The scene reference lists all keys.
""",
    tail="""\
[expect]  # bounds on the relative L2 misfit of pairs, checked by `pytest {file}`
"dem ~ lattice" = 5e-3                    # rigid blocks, their exact solution
"continuum-jointed ~ jointed-bar" = 1e-2  # jointed rock, its exact solution

[[variants]]  # the same scene with changed keys; repeatable
name = "no layer"
soft_layers = []
""",
)

ROCK_MASS = Template(
    RockMass,
    given={
        "domain.size": "[20.0, 20.0]",
        "rock.density": "2600.0",
        "rock.intact_modulus": "5.0e10",
        "rock.intact_poisson": "0.25",
        "joint_sets.normal_stiffness": "1.0e10",
        "joint_sets.shear_stiffness": "4.0e9",
        "joint_sets.name": '"joint"',
        "joint_sets.dip": "30.0",
        "joint_sets.through": "[10.0, 10.0]",
        "waves.shape": '"ricker"',
        "waves.amplitude": "1.0e6",
        "waves.period": "0.005",
        "waves.kind": '"P"',
        "waves.direction": "[0.0, 1.0]",
        "boundaries.left": '"quiet"',
        "boundaries.right": '"quiet"',
        "boundaries.bottom": '"quiet"',
        "boundaries.top": '"quiet"',
        "time.duration": "0.02",
        "record.points": "[[10.0, 5.0], [10.0, 15.0]]",
        "record.joints": "[[10.0, 10.0]]",
        "numerics.dem.block": "0.5",
    },
    offered={
        "domain.openings": "[[[3.0, 3.0], [5.0, 3.0], [5.0, 5.0], [3.0, 5.0]]]",
        "domain.non_convex": '"cut"',
        "joint_sets.damping_ratio": "0.02",
        "joint_sets.tension": "false",
        "joint_sets.friction_angle": "30.0",
        "joint_sets.cohesion": "1.0e5",
        "joint_sets.spacing": "2.0",
        "joint_sets.ends_at": '["other"]',
        "joint_sets.scatter": "0.2",
        "joint_sets.seed": "1",
        "waves.quantity": "",
        "waves.cycles": "2",
        "waves.file": '"wave.csv"',
        "waves.through": "[10.0, 0.0]",
        "loads.shape": '"ricker"',
        "loads.amplitude": "1.0e6",
        "loads.period": "0.005",
        "loads.kind": '"pressure"',
        "loads.opening": "0",
        "gravity.direction": "",
        "gravity.acceleration": "",
        "gravity.static": "false",
        "prestress.xx": "1.0e6",
        "prestress.yy": "2.0e6",
        "prestress.xy": "",
        "record.interval": "2.5e-5",
        "record.fields": "1.0e-3",
        "record.energy": "",
        "numerics.dem.step_fraction": "",
        "numerics.continuum.order": "",
        "numerics.continuum.size": "0.8",
        "numerics.continuum.scheme": "",
    },
    head="""\
A jointwave rock mass: rock, joints, loads, duration and receivers.
SI units, plane strain. x to the right, y upwards; compression is positive.
Optional keys are commented out: to set one, remove "# " from its line and its table's heading.
Tables in double brackets are repeatable. Effects that are not given are not computed.
The scene reference lists all keys.
""",
    tail="""\
[expect]  # bounds on the relative L2 misfit of pairs, checked by `pytest {file}`
"continuum-jointed ~ oblique-joint" = 1e-3  # jointed rock, exact solution
"dem ~ oblique-joint" = 6e-2                # rigid blocks, the same solution

[[variants]]  # the same scene with changed keys; repeatable
name = "steeper"
joint_sets.0.dip = 35.0
""",
)
