"""The properties of a pillar of equal blocks, whose joints are equal but for soft layers."""

from math import inf

import numpy as np

from jointwave.cases.material.dashpots import dashpots
from jointwave.cases.material.properties import Properties, of_bar
from jointwave.cases.material.stiffness import rock_mass, stiffness
from jointwave.cases.material.strength import strength
from jointwave.cases.schema.scene import Scene


def calibrate_uniform(scene: Scene) -> Properties:
    """Return the properties of a scene without segments and random joints."""
    pillar, intact = scene.pillar, scene.rock.intact_modulus
    count, spacing = pillar.block_count, pillar.length / pillar.block_count
    mass = rock_mass(scene, spacing)
    soft = np.array([round(layer.y / spacing) - 1 for layer in scene.soft_layers], dtype=np.int64)
    springs = stiffness(scene, soft, spacing, mass)
    eta, joint_eta = dashpots(scene, soft, mass.modulus / spacing, springs.stiffness)
    tension = np.full(count - 1, scene.joints.tension is not False)
    tension[soft] = [layer.tension is not False for layer in scene.layers]
    return Properties(
        block_count=count,
        poisson=mass.poisson,
        intact_modulus=intact,
        mass_damping=scene.damping.alpha,
        local_damping=scene.damping.local or None,
        contact_y=spacing * np.arange(count + 1),
        time_constant=eta,
        joint_time_constant=joint_eta,
        own_time_constant=joint_eta,
        tension=tension,
        soft=soft,
        weld=np.broadcast_to(False, count - 1),
        regular=mass.modulus / spacing,
        rock_between=spacing / (intact or inf),
        segment=np.broadcast_to(0, count),
        **of_bar(scene.rock.density, pillar.side, spacing, mass.modulus, mass.shear_modulus),
        **springs._asdict(),
        **vars(strength(scene, soft)),
    )
