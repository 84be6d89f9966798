"""The properties of a pillar of equal blocks, whose joints are equal but for soft layers."""

from math import inf, sqrt

import numpy as np

from jointwave.cases.material.dashpots import dashpots
from jointwave.cases.material.properties import Properties
from jointwave.cases.material.stiffness import rock_mass, stiffness
from jointwave.cases.material.strength import strength
from jointwave.cases.schema.scene import Scene


def calibrate_uniform(scene: Scene) -> Properties:
    """Return the properties of a scene without segments and random joints."""
    pillar, density = scene.pillar, scene.rock.density
    count, spacing = pillar.block_count, pillar.length / pillar.block_count
    block_mass, mass = density * pillar.area * spacing, rock_mass(scene, spacing)
    soft = np.array([round(layer.y / spacing) - 1 for layer in scene.soft_layers], dtype=np.int64)
    springs = stiffness(scene, soft, spacing, mass)
    eta = dashpots(scene, soft, mass.modulus / spacing, springs.stiffness)
    tension = np.full(count - 1, scene.joints.tension is not False)
    tension[soft] = [layer.tension is not False for layer in scene.layers]
    speed, shear_speed = sqrt(mass.modulus / density), sqrt(mass.shear_modulus / density)
    return Properties(
        block_count=count,
        spacing=spacing,
        side=pillar.side,
        area=pillar.area,
        density=density,
        block_mass=block_mass,
        inertia_across=block_mass * (pillar.side**2 + spacing**2) / 12,
        inertia_along=block_mass * pillar.side**2 / 6,
        intact_modulus=scene.rock.intact_modulus,
        bar_speed=speed,
        shear_speed=shear_speed,
        impedance=density * speed,
        shear_impedance=density * shear_speed,
        mass_damping=scene.damping.alpha,
        local_damping=scene.damping.local or None,
        contact_y=spacing * np.arange(count + 1),
        own_time_constant=eta.joint_time_constant,
        tension=tension,
        soft=soft,
        weld=np.broadcast_to(False, count - 1),
        regular=mass.modulus / spacing,
        rock_between=spacing / (scene.rock.intact_modulus or inf),
        segment=np.broadcast_to(0, count),
        **mass._asdict(),
        **springs._asdict(),
        **eta._asdict(),
        **vars(strength(scene, soft)),
    )
