"""Every mistake in a scene is one line that names file, key, value and what is allowed.

A mistake is a change to a good scene, with words that the line must hold.
"""

import io
import os
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from unittest.mock import patch

import pytest

from jointwave.cases import load
from jointwave.compare.cli.program import main

GOOD = """\
title = "good"

[pillar]
length = 50.0
side = 0.5
block = 0.5

[rock]
density = 2400.0
p_speed = 2200.0
s_speed = 800.0
intact_modulus = 8.64e10

[joints]
damping_ratio = 0.02

[[soft_layers]]
y = 20.0
spacing_stiffness = 4.375e8

[load]
shape = "sine"
amplitude = 1.0e6
period = 0.01

[ends]
end = "quiet"

[time]
duration = 0.002

[record]
stress = [20.0]
velocity = [19.75, 20.25]

[expect]
"dem ~ lattice" = 2e-3

[[variants]]
name = "undamped"
"""

SINE = 'shape = "sine"\namplitude = 1.0e6\nperiod = 0.01'
STIFFNESS = "spacing_stiffness = 4.375e8"
MESH = '[numerics.continuum]\nmesh = "pillar.msh"\n'

MISTAKES = {
    "pillar.length = '50'": "pillar.length = '50' ... a number",
    "pillar.length = true": "pillar.length = true ... a number",
    "rock.density = 2400-01-01": "rock.density = 2400-01-01 ... a number",
    "pillar.side = [0.5, 0.5]": "pillar.side = [0.5, 0.5]",
    "title = 3": "title = 3 ... must be a string",
    "no time": "time ... is required",
    "gravity = 'down'": "gravity = 'down' ... must be a table",
    "record.stress = 20.0": "record.stress = 20.0 ... a list",
    "record.stress = ['20']": "record.stress[0] = '20' ... a number",
    "no joints.damping_ratio; joints.tension = 0": "joints.tension = 0 ... or false",
    "load.cycles = 1.5": "load.cycles = 1.5 ... a whole number",
    "soft_layers = { y = 20.0, spacing_stiffness = 437500000.0 }": (
        "soft_layers ... [[soft_layers]]"
    ),
    # unknown keys
    "loads = {}": "loads: unknown key ... load, ends",
    "no pillar.side; pillar.width = 0.5": "pillar. ... side",
    "rock.speed = 1": "rock.speed = 1 ... p_speed, s_speed",
    "joints.zeta = 1": "joints.zeta ... damping_ratio",
    "soft_layers[0].K = 1": "soft_layers[0].K = 1 ... thickness",
    "load.force = 1": "load.force = 1 ... amplitude",
    "ends.top = 1": "ends.top = 1 ... start, end",
    "time.step = 1": "time.step = 1 ... duration",
    "record.strain = [1]": "record.strain ... velocity",
    "numerics.dem.dt = 1": "numerics.dem.dt = 1 ... step_fraction",
    "name = 'x'": "name = 'x' ... [[variants]]",
    # missing
    "no pillar": "pillar ... required",
    "no pillar.length": "pillar.length ... is required",
    "no title": "title ... is required",
    "no load.amplitude": "load.amplitude ... is required",
    "no record.stress; no record.velocity": "record ... at least one of record.stress and velocity",
    # numbers
    "pillar.side = nan": "pillar.side = nan ... finite",
    "load.amplitude = nan": "load.amplitude = nan ... finite",
    "time.duration = inf": "time.duration = inf ... finite",
    "rock.density = 0.0": "rock.density = 0.0 ... greater than 0",
    "pillar.length = -50.0": "pillar.length = -50.0 ... greater than 0",
    "joints.damping_ratio = -0.02": "joints.damping_ratio = -0.02 ... at least 0",
    "pillar.side = 1e+200": "pillar.side = 1e+200 ... 1e30",
    "numerics.continuum.order = 9": "numerics.continuum.order = 9 ... at most 4",
    "no rock.p_speed; no rock.s_speed; rock.equivalent_modulus = 4400000000.0; "
    "rock.equivalent_poisson = 0.5": "rock.equivalent_poisson = 0.5 ... less than 0.5",
    # the pillar and what lies on it
    "pillar.block = 0.3": "pillar.block = 0.3 ... whole number",
    "pillar.block = 60.0": "pillar.block = 60.0 ... 2 to",
    "pillar.block = 5e-11": "pillar.block = 5e-11 ... 10,000,000 blocks",
    "soft_layers[0].y = 20.1": "soft_layers[0].y = 20.1 ... multiple of 0.5",
    "soft_layers[0].y = 50.0": "soft_layers[0].y = 50.0 ... from 0.5 to 49.5",
    "soft_layers[1] = { y = 20.0, spacing_stiffness = 437500000.0 }": (
        "soft_layers[1].y = 20.0 ... already"
    ),
    "soft_layers[0].normal_stiffness = 1000000000.0": (
        "soft_layers[0].spacing_stiffness = 437500000.0 ... not both"
    ),
    "record.stress = [20.0, 50.1]": "record.stress = 50.1 ... 0 and 50 m",
    "record.stress = [-1.0]": "record.stress[0] = -1.0 ... at least 0",
    "record.stress = [20.0, 20.0]": "record.stress = [20.0, 20.0] ... repeat",
    "record.interval = 1.0": "record.interval = 1.0 ... time.duration = 0.002",
    "record.interval = 1e-12": "record.interval = 1e-12 ... 10,000,000 samples",
    # the rock
    "rock.equivalent_modulus = 4000000000.0; rock.equivalent_poisson = 0.4": (
        "rock = [ ... exactly one pair"
    ),
    "no rock.s_speed": "rock = ['p_speed'] ... exactly one pair",
    "no rock.s_speed; rock.equivalent_modulus = 4000000000.0": (
        "rock = ['p_speed', 'equivalent_modulus'] ... exactly one pair"
    ),
    "no rock.p_speed; no rock.s_speed": "rock ... exactly one pair",
    "rock.p_speed = 900.0": "rock.p_speed = 900.0 ... sqrt(4/3)",
    "rock.intact_modulus = 4000000000.0": "rock.intact_modulus = 4000000000.0 ... 4.374e+09",
    # the load
    "load.shape = 'square'": "load.shape = 'square' ... 'ricker', 'gabor'",
    "ends.end = 'open'": "ends.end = 'open' ... 'matched'",
    "no load.period": "load.period ... load.shape = 'sine'",
    "no load.period; load.shape = 'ricker'; load.amplitude = 1.0": (
        "load.period ... is required for load.shape = 'ricker'"
    ),
    "load.shape = 'step'": "load.period = 0.01 ... no meaning",
    "load.shape = 'gabor'; load.amplitude = 1.0": (
        "load.cycles ... is required for load.shape = 'gabor'"
    ),
    "no load.period; load.shape = 'triangle'; load.amplitude = 1.0; load.rise = 0.01": (
        "load.decay ... is required for load.shape = 'triangle'"
    ),
    "load.rise = 0.1": "load.rise = 0.1 ... has no meaning for shape 'sine'",
    "no load.period; load.shape = 'table'; load.amplitude = 1.0": "load.file ... is required",
    "load.direction = [0, 0, 0]": "load.direction = [0, 0, 0] ... unit vector",
    "load.direction = [0, 1]": "load.direction = [0, 1] ... 3 numbers",
    "load.quantity = 'force'": (
        "load.quantity = 'force' ... 'stress', 'incident-stress', 'velocity'"
    ),
    "load.at = [0.0, 0.3]": "load.at = [0.0, 0.3] ... on the face, within 0.25 m",
    "load.at = [0.1, 0.0]; load.arm = 0.2": "load.arm = 0.2 ... takes no load.at",
    "motion.rotation = 'none'; load.at = [0.1, 0.0]": (
        "load.at = [0.1, 0.0] ... motion.rotation = 'none'"
    ),
    "motion.rotation = 'none'; load.arm = 0.1": "load.arm = 0.1 ... motion.rotation = 'none'",
    "ends.start = 'fixed'": "ends.start = 'fixed' ... 'velocity' or 'acceleration'",
    "load.quantity = 'velocity'": "load.quantity = 'velocity' ... ends.start = 'fixed'",
    "load.quantity = 'velocity'; load.direction = [0.6, 0.8, 0]; ends.start = 'quiet'": (
        "load.direction = [0.6, 0.8, 0 ... along or across the axis"
    ),
    "load.quantity = 'velocity'; load.at = [0.1, 0.0]": (
        "load.at = [0.1, 0.0] ... no meaning for load.quantity 'velocity'"
    ),
    "load.quantity = 'acceleration'; load.arm = 0.1": (
        "load.arm = 0.1 ... no meaning for load.quantity 'acceleration'"
    ),
    # the strength of joints
    "joints.tensile_strength = 100000.0": (
        "joints.fracture_energy ... is required with joints.tensile_strength"
    ),
    "soft_layers[0].fracture_energy = 10.0": (
        "soft_layers[0].tensile_strength ... is required with soft_layers[0].fracture_energy"
    ),
    "joints.tension = false; joints.tensile_strength = 100000.0; joints.fracture_energy = 1.0": (
        "joints.tension = false ... contradicts tensile_strength"
    ),
    "joints.tension = true; joints.tensile_strength = 100000.0; joints.fracture_energy = 1.0": (
        "joints.tension = true ... contradicts tensile_strength"
    ),
    "no joints.damping_ratio; joints.tensile_strength = 100000.0; "
    "joints.fracture_energy = 1.0; soft_layers[0].tension = false": (
        "soft_layers[0].tension = false ... contradicts tensile_strength"
    ),
    "joints.tensile_strength = 100000.0; joints.fracture_energy = 0.5": (
        "joints.fracture_energy = 0.5 ... snaps back ... at least 0.5716 J/m2"
    ),
    "joints.tensile_strength = 100000.0; joints.fracture_energy = 1.0": (
        "soft_layers[0].fracture_energy = 1.0 ... snaps back ... at least 5.744 J/m2"
    ),
    "joints.residual_cohesion = 10000.0": "joints.residual_cohesion = 10000.0 ... needs a cohesion",
    "joints.cohesion = 10000.0; joints.residual_cohesion = 20000.0": (
        "joints.residual_cohesion = 20000.0 ... at most the cohesion 10000 Pa"
    ),
    "no joints.damping_ratio; joints.cohesion = 10000.0; "
    "soft_layers[0].residual_cohesion = 20000.0": (
        "soft_layers[0].residual_cohesion = 20000.0 ... at most the cohesion 10000 Pa"
    ),
    "joints.friction_angle = 30.0; joints.weakening_distance = 0.001": (
        "joints.dynamic_friction_angle ... is required with joints.weakening_distance"
    ),
    "joints.dynamic_friction_angle = 20.0; joints.weakening_distance = 0.001": (
        "joints.dynamic_friction_angle = 20.0 ... needs a friction_angle"
    ),
    "joints.friction_angle = 20.0; joints.dynamic_friction_angle = 30.0; "
    "joints.weakening_distance = 0.001": (
        "joints.dynamic_friction_angle = 30.0 ... at most friction_angle = 20"
    ),
    "joints.friction_angle = 30.0; joints.initial_state = 1.0": (
        "joints.direct_effect ... is required with joints.initial_state"
    ),
    "joints.friction_angle = 30.0; joints.direct_effect = 0.01": (
        "joints.evolution_effect ... is required with joints.direct_effect"
    ),
    "joints.direct_effect = 0.01; joints.evolution_effect = 0.015; "
    "joints.critical_slip_distance = 0.0001; joints.reference_rate = 1e-06": (
        "joints.direct_effect = 0.01 ... needs a friction_angle"
    ),
    "joints.friction_angle = 30.0; joints.direct_effect = 0.01; "
    "joints.evolution_effect = 0.015; joints.critical_slip_distance = 0.0001; "
    "joints.reference_rate = 1e-06; joints.dynamic_friction_angle = 20.0; "
    "joints.weakening_distance = 0.001": (
        "joints.dynamic_friction_angle = 20 ... contradicts direct_effect"
    ),
    "joints.friction_angle = 30.0; joints.direct_effect = 0.01; "
    "joints.evolution_effect = 0.015; joints.critical_slip_distance = 0.0001; "
    "joints.reference_rate = 1e-06; joints.dilation_angle = 5.0; "
    "joints.dilation_distance = 0.01": "joints.dilation_angle = 5 ... contradicts direct_effect",
    "joints.dilation_angle = 5.0; joints.dilation_distance = 0.001": (
        "joints.dilation_angle = 5 ... needs a friction_angle"
    ),
    "joints.friction_angle = 20.0; joints.dilation_angle = 21.0; "
    "joints.dilation_distance = 0.001": (
        "joints.dilation_angle = 21 ... at most friction_angle = 20"
    ),
    "joints.friction_angle = 30.0; joints.dilation_angle = 15.0; "
    "joints.dilation_distance = 1.0; joints.dynamic_friction_angle = 10.0; "
    "joints.weakening_distance = 0.001": (
        "joints.dilation_angle = 15 ... must be at most 10.01 ... "
        "friction at dynamic_friction_angle = 10"
    ),
    "joints.friction_angle = 90.0": "joints.friction_angle = 90.0 ... less than 90",
    "soft_layers[0].contact_points = 3": (
        "soft_layers[0].contact_points = 3 ... applies to all joints"
    ),
    "joints.contact_points = 3": (
        "joints.contact_points = 3 ... needs point_rule = 'midpoint' or 'gauss'"
    ),
    "soft_layers[0].point_rule = 'gauss'": (
        "soft_layers[0].point_rule = 'gauss' ... applies to all joints"
    ),
    # damping and gravity
    "damping.rayleigh.frequencies = [10.0, 20.0]; damping.rayleigh.ratios = [0.02, 0.02]": (
        "joints.damping_ratio = 0.02 ... damping.rayleigh already sets ... give one"
    ),
    "no joints.damping_ratio; soft_layers[0].damping_ratio = 0.1; "
    "damping.rayleigh.frequencies = [10.0, 20.0]; damping.rayleigh.ratios = [0.02, 0.02]": (
        "soft_layers[0].damping_ratio = 0.1 ... damping.rayleigh already sets ... give one"
    ),
    "damping.mass_proportional = 3.0; damping.rayleigh.frequencies = [10.0, 20.0]; "
    "damping.rayleigh.ratios = [0.02, 0.02]": (
        "damping.mass_proportional = 3.0 ... damping.rayleigh already sets ... give one"
    ),
    "damping.rayleigh.frequencies = [10.0, 20.0]; damping.rayleigh.ratios = [0.01, 0.1]": (
        "damping.rayleigh.ratios = [0.01, 0.1] ... alpha = -6.702 1/s ... beta = 0.002016 s"
    ),
    "damping.rayleigh.frequencies = [20.0, 20.0]; damping.rayleigh.ratios = [0.1, 0.1]": (
        "damping.rayleigh.frequencies = [20.0, 20.0] ... increasing"
    ),
    "damping.local = 1.0": "damping.local = 1.0 ... less than 1",
    "gravity.direction = [0, 2, 0]": "gravity.direction = [0, 2, 0] ... unit vector",
    "gravity.direction = [0, -1, 0]": (
        "gravity.static = true ... needs a fixed end ... or gravity.static = false"
    ),
    "gravity.direction = [0, -1, 0]; gravity.static = false": (
        "ends.end = 'quiet' ... pulls the pillar off it ... needs a fixed"
    ),
    "segments = [{ y = [10.0, 30.0] }, {}]": "segments[1].y ... is required",
    "segments = [{ y = [10.0, 30.0] }, { y = [40.0, 35.0] }]": (
        "segments[1].y = [40.0, 35.0] ... increasing"
    ),
    "segments = [{ y = [10.0, 30.0] }, { y = [40.0, 51.0] }]": (
        "segments[1].y = [40.0, 51.0] ... within pillar.length = 50"
    ),
    "segments = [{ y = [10.0, 30.0] }, { y = [29.5, 40.0] }]": (
        "segments[1].y = [29.5, 40.0] ... ends at 30 m ... overlaps the segment"
    ),
    "segments = [{ y = [10.0, 30.0], block = 1e-09 }]": (
        "segments[0].block = 1e-09 ... at most 10,000,000 blocks"
    ),
    "segments = [{ y = [10.0, 30.0], block = 0.3 }]": "segments[0].block = 0.3 ... 10 to 30 m",
    "segments = [{ y = [10.0, 30.0] }, { y = [30.0, 40.2] }]": (
        "segments[1].y = [30.0, 40.2] ... 0.5 m must divide ... 30 to 40.2 m"
    ),
    "segments = [{ y = [10.0, 30.0], modulus = 1000000000.0 }]": (
        "segments[0].modulus ... intact_modulus"
    ),
    "segments = [{ y = [10.0, 30.0], p_speed = 3000.0 }]": (
        "segments[0].p_speed = 3000.0 ... one pair or none"
    ),
    "segments = [{ y = [10.0, 30.0], p_speed = 900.0, s_speed = 800.0 }]": (
        "segments[0].p_speed = 900.0 ... sqrt(4/3) times s_speed = 800"
    ),
    "segments = [{ y = [10.0, 30.0], intact_modulus = 1000000000.0 }]": (
        "segments[0].intact_modulus = 1000000000.0 ... exceed the equivalent modulus ... joints"
    ),
    "segments = [{ y = [10.0, 30.0], joints = false, normal_stiffness = 1000000000.0 }]": (
        "segments[0].normal_stiffness ... segments[0].joints = false give intact_modulus"
    ),
    # segments
    "segments = [{ y = [10.0, 30.0] }]; gravity.direction = [0, 1, 0]; gravity.static = false": (
        "gravity.acceleration = 9.81 ... is not supported with segments or scatter"
    ),
    "segments = [{ y = [10.0, 30.0] }]; load.direction = [1, 0, 0]": (
        "segments = 1 ... axial motion only ... a component across"
    ),
    "segments = [{ y = [10.0, 30.0] }]; motion.rotation = 'none'": (
        "motion.rotation = 'none' ... segments"
    ),
    "segments = [{ y = [10.0, 30.0] }]; numerics.dem.scheme = 'fourth-order'": (
        "numerics.dem.scheme = 'fourth-order' ... 'leapfrog'"
    ),
    "no joints.damping_ratio; no soft_layers[0].spacing_stiffness; "
    "segments = [{ y = [10.0, 30.0], joints = false }]": (
        "soft_layers[0].y = 20.0 ... needs a normal_stiffness"
    ),
    "soft_layers[0].thickness = 0.1; segments = [{ y = [10.0, 30.0] }]": (
        "soft_layers[0].thickness = 0.1 ... must be a segment"
    ),
    "soft_layers[0].y = 20.25": "soft_layers[0].y = 20.25 ... must be on a joint",
    # scatter
    "scatter.seed = 1": "scatter: ... give scatter.spacing",
    "scatter.spacing = 0.2": "scatter.seed ... is required",
    "scatter.compliance = 0.6; scatter.seed = 1": "scatter.compliance = 0.6 ... at most 0.5",
    "gravity.direction = [0, 1, 0]; gravity.static = false; scatter.spacing = 0.2; "
    "scatter.seed = 1": "gravity.acceleration = 9.81 ... is not supported with segments or scatter",
    # variants and expectations
    "variants = { zeta = 1 }": "variants ... [[variants]]",
    "no variants[0].name": "variants[0].name ... must be a string",
    "variants[0].name = '../x'": "variants[0].name = '../x' ... /",
    "variants[0].name = 'a'; variants[1] = { name = 'a' }": "variants[1].name = 'a' ... unique",
    "variants[0].joints.zeta = 1": "[undamped] ... joints.zeta = 1 ... damping_ratio",
    "variants[0].joints.damping_ratio = 'none'": (
        "[undamped] ... joints.damping_ratio = 'none' ... a number"
    ),
    "no expect.dem ~ lattice; expect.dem ~ truth = 0.002": (
        "expect.dem ~ truth ... 'a ~ b' ... jointed-bar"
    ),
    "no expect.dem ~ lattice; expect.dem = 0.002": "expect.dem ... 'a ~ b'",
    "no expect.dem ~ lattice; expect.dem ~ dem = 0.002": "expect.dem ~ dem ... 'a ~ b'",
    "expect.dem ~ lattice = -0.002": "expect.dem ~ lattice = -0.002 ... greater than 0",
    "no soft_layers[0].spacing_stiffness; soft_layers[0].thickness = 0.1": (
        "soft_layers[0].thickness = 0.1 ... needs a spacing_stiffness or normal_stiffness"
    ),
    # the elements
    "numerics.continuum.order = 3; numerics.continuum.cell = 'simplex'": (
        "numerics.continuum.order = 3 ... 1 or 2 ... 'simplex'"
    ),
    "numerics.continuum.cell = 'cube'": "numerics.continuum.cell = 'cube' ... 'simplex'",
    "numerics.continuum.dim = 4": "numerics.continuum.dim = 4 ... at most 3",
    "numerics.continuum.elements_across = 0": (
        "numerics.continuum.elements_across = 0 ... at least 1"
    ),
    # a file
    "numerics.continuum.mesh = 'gone.msh'": "numerics.continuum.mesh = 'gone.msh' ... no such file",
    "numerics.continuum.mesh = ''": "numerics.continuum.mesh = '' ... must be a file",
    "numerics.continuum.mesh = 'pipe'": "numerics.continuum.mesh = 'pipe' ... must be a file",
    "numerics.continuum.mesh = 'pillar.msh'; numerics.continuum.dim = 1": (
        "numerics.continuum.dim = 1 ... is a bar"
    ),
    "numerics.continuum.mesh = 'pillar.msh'; numerics.continuum.cell = 'simplex'": (
        "numerics.continuum.cell = 'simplex' ... no meaning with numerics.continuum.mesh"
    ),
    "numerics.continuum.mesh = 'pillar.msh'; numerics.continuum.elements_per_block = 2": (
        "numerics.continuum.elements_per_block = 2 ... no meaning"
    ),
    "numerics.continuum.mesh = 'pillar.msh'; numerics.continuum.elements_across = 2": (
        "numerics.continuum.elements_across = 2 ... no meaning"
    ),
    "soft_layers[0].thickness = 0.5": (
        "soft_layers[0].thickness = 0.5 ... less than pillar.block = 0.5"
    ),
    "soft_layers[0].thickness = 0.1; soft_layers[0].friction_angle = 30.0": (
        "soft_layers[0].friction_angle = 30.0 ... a layer with thickness is rock"
    ),
    "soft_layers[0].thickness = 0.1; soft_layers[0].cohesion = 0.0": (
        "soft_layers[0].cohesion = 0.0 ... a layer with thickness is rock"
    ),
    "soft_layers[0].thickness = 0.1; soft_layers[0].shear_stiffness = 1000000000.0": (
        "soft_layers[0].shear_stiffness = 1000000000.0 ... a layer with thickness is rock"
    ),
    "soft_layers[0].thickness = 0.1; soft_layers[0].tension = false": (
        "soft_layers[0].tension = false ... a layer with thickness is rock"
    ),
    "soft_layers[0].thickness = 0.1; soft_layers[0].tensile_strength = 100000.0; "
    "soft_layers[0].fracture_energy = 100.0": (
        "soft_layers[0].tensile_strength = 100000.0 ... a layer with thickness is rock"
    ),
}

#: The same of the text of a file: (what is replaced, by what, words).
IN_TEXT = {
    "an integer of 400 digits": ("side = 0.5", "side = 1" + "0" * 400, ["pillar.side", "bits"]),
    "not TOML": ("[pillar]", "[pillar", ["not valid TOML", "line 3"]),
    "the same key twice": ("side = 0.5", "side = 0.5\nside = 0.5", ["not valid TOML", "line 6"]),
    "an integer of 5000 digits": ("side = 0.5", "side = 1" + "0" * 5000, ["not valid TOML"]),
    "a key of many parts": (
        "side = 0.5",
        "a." * 40_000 + "b = 1",
        ["a key has more than 64 parts"],
    ),
    "a quoted key of many parts": ("side = 0.5", '"a" . ' * 70 + "b = 1", ["more than 64 parts"]),
    "nested too deep": ("side = 0.5", "side = " + "[" * 5000 + "]" * 5000, ["not valid TOML"]),
}

HISTORIES = {
    "empty history": ("", ["two or more numbers"]),
    "header only": ("time,stress\n", ["two or more numbers"]),
    "history of one row": ("0,0\n", ["at least 2 samples, not 1"]),
    "unsorted history": ("0,0\n2,1\n1,0\n", ["line 3: time = 1", "later than", "2"]),
    "a time twice": ("s,Pa\n0,0\n0,1\n", ["line 3: time = 0", "is repeated"]),
    "three columns": ("0,0,0\n1,1,1\n", ["two columns", "not 3"]),
    "a column short": ("0;0\n1\n2;1\n", ["line 2", "2 numbers", "not 1"]),
    "an empty cell": ("0;0\n1;\n2;1\n", ["line 2: value = nan or empty", "finite number"]),
    "a unit of another quantity": ("t,v (mm/s)\n0,0\n1,1\n", ["unit of v = 'mm/s'", "MPa"]),
    "text in a history": ("0,0\n1,high\n", ["line 2: value = 'high'", "must be a number"]),
    "NaN in a history": ("# blast\n0,0\n1,nan\n", ["line 3: value = 'nan'", "a number"]),
    "binary history": (b"\x93NUMPY\xff\x00", ["neither text (line 1", "nor a seismogram in SAC"]),
    "history in Latin-1": ("Zeit (\xb5s),p\n0,0\n1,1\n".encode("latin-1"), ["not UTF-8 text"]),
}

OVERRIDES = {
    "unknown --set key": ("pillar.width=1", ["pillar.width = 1", "length, side, block"]),
    "--set of a wrong type": ("pillar.side=wide", ["pillar.side = 'wide'", "a number"]),
    "--set below a number": ("pillar.side.half=1", ["pillar.side.half = 1", "not a table"]),
    "--set without a value": ("pillar.side", ["pillar.side", "must be key=value"]),
    "--set without a key": ("=1", ["=1", "must be key=value"]),
    "--set of a nest": ("pillar.side=" + "[" * 5000, ["pillar.side = '[[[", "a number"]),
    "--set of 5000 digits": ("pillar.side=" + "1" * 5000, ["pillar.side = '1111", "a number"]),
    "a step above the critical one": (
        "numerics.dem.step_fraction=1.5",
        ["numerics.dem.step_fraction = 1.5", "critical step", "allow_unstable"],
    ),
    "a step too short to ever end": (
        "numerics.dem.step_fraction=1e-15",
        ["numerics.dem.step_fraction = 1e-15", "steps of", "at most 1e+12"],
    ),
}


def mistaken(name: str) -> str:
    """Return the good scene with one mistake in its text."""
    old, new, _ = IN_TEXT[name]
    assert GOOD.count(old), f"{old!r} is not in the good scene"
    return GOOD.replace(old, new, 1)


def write(path: Path, content: str | bytes) -> Path:
    """Write a text or bytes and return the path."""
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def line_of(path: Path) -> str:
    """Return the first line of what `jointwave run` says of a scene: exit 2, every line names the
    file, no output.

    The command runs in this process, for speed; a few mistakes below go through a process.
    """
    out, said, silent = path.parent / "out", io.StringIO(), io.StringIO()
    arguments = ["jointwave", "run", str(path), "--out", str(out)]
    with (
        patch.object(sys, "argv", arguments),
        redirect_stderr(said),
        redirect_stdout(silent),
        pytest.raises(SystemExit) as end,
    ):
        main()
    lines = said.getvalue().splitlines()
    message = lines[0].removeprefix("jointwave: ")
    assert end.value.code == 2 and silent.getvalue() == "" and not out.exists()
    assert all(line.startswith(f"jointwave: {path}") for line in lines) and len({*lines}) == len(
        lines
    )
    assert len(message) < len(str(path)) + 500
    return message


def test_the_good_scene_is_good(tmp_path):
    assert [s.name for s in load(write(tmp_path / "good.toml", GOOD))] == ["", "undamped"]


@pytest.mark.parametrize("changes", MISTAKES)
def test_mistake_is_one_line(changes, tmp_path, changed):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "pillar.msh").touch()
    message = line_of(write(tmp_path / "scene.toml", changed(GOOD, changes)))
    for word in MISTAKES[changes].split(" ... "):
        assert word in message


@pytest.mark.parametrize("name", IN_TEXT)
def test_mistake_in_the_text_is_one_line(name, tmp_path):
    message = line_of(write(tmp_path / "scene.toml", mistaken(name)))
    for word in IN_TEXT[name][2]:
        assert word in message


def meshed(folder: Path, text: str = GOOD) -> Path:
    """Write a scene whose continuum has its mesh from a file, which is empty."""
    (folder / "pillar.msh").touch()
    return write(folder / "scene.toml", text.replace("[time]", f"{MESH}[time]"))


def test_a_layer_beside_a_file_is_one_line(tmp_path):
    thick = GOOD.replace(STIFFNESS, f"{STIFFNESS}\nthickness = 0.1")
    message = line_of(meshed(tmp_path, thick))
    assert "soft_layers[0].thickness = 0.1: cannot be meshed with numerics" in message


def test_the_mesh_is_found_beside_the_scene(tmp_path, monkeypatch):
    """Whatever the folder that the command runs in, also as the scene is passed on."""
    path = meshed(tmp_path)
    monkeypatch.chdir(tmp_path.parent)
    numerics = load(path.relative_to(tmp_path.parent))[0].numerics.continuum
    assert numerics.mesh == "pillar.msh"
    assert numerics.mesh_path == tmp_path / "pillar.msh"
    assert numerics.model_copy().mesh_path == tmp_path / "pillar.msh"


def test_a_scene_without_a_mesh_has_no_path(tmp_path):
    scene, _ = load(write(tmp_path / "scene.toml", GOOD))
    assert scene.numerics.continuum.mesh_path is None


@pytest.mark.parametrize("name", HISTORIES)
def test_bad_history_is_one_line(name, tmp_path):
    content, words = HISTORIES[name]
    write(tmp_path / "blast.csv", content)
    message = line_of(table_scene(tmp_path, "blast.csv"))
    for word in ["load.file = 'blast.csv'", *words]:
        assert word in message


def test_more_variants_than_a_scene_may_have(tmp_path):
    many = "".join(f'[[variants]]\nname = "{i}"\n' for i in range(1001))
    scene = write(tmp_path / "scene.toml", f"{GOOD}{many}")
    assert "variants: 1,002 variants given; at most 1,000" in line_of(scene)


def test_dots_in_a_text_or_a_list_make_no_key(tmp_path):
    """Only a key of many parts is refused, whatever else a line holds."""
    places = ", ".join(f"{0.5 * i}" for i in range(1, 100))
    text = GOOD.replace('title = "good"', f'title = "{"..." * 100} {"a b. " * 100}"')
    scene = write(tmp_path / "scene.toml", text.replace("[20.0]", f"[{places}]"))
    assert len(load(scene)[0].record.stress) == 99


def table_scene(folder: Path, file: str) -> Path:
    """Write the good scene with its load from a file."""
    table = f'shape = "table"\namplitude = 1.0\nfile = "{file}"'
    return write(folder / "scene.toml", GOOD.replace(SINE, table))


@pytest.mark.parametrize(
    ("file", "word"),
    [("gone.csv", "No such file"), ("", "directory"), ("pipe", "regular file")],
)
def test_history_that_cannot_be_read(file, word, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert word in line_of(table_scene(tmp_path, file))


def test_scene_that_cannot_be_read(tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "dangling.toml").symlink_to("gone.toml")
    assert "no such scene" in line_of(tmp_path / "gone.toml")
    assert "No such file" in line_of(tmp_path / "dangling.toml")
    assert "directory" in line_of(tmp_path)
    assert "regular file" in line_of(tmp_path / "pipe.toml")
    assert "UTF-8" in line_of(write(tmp_path / "latin.toml", 'title = "Säule"'.encode("latin-1")))
    assert "10 MB" in line_of(write(tmp_path / "huge.toml", "#" * 10_000_001))
    assert "title: is required" in line_of(write(tmp_path / "empty.toml", ""))


@pytest.mark.parametrize("name", OVERRIDES)
def test_bad_override_on_the_command_line(name, tmp_path, jointwave, without_warnings):
    """What is unusual in the scene may have been warned of before its engines were built."""
    override, words = OVERRIDES[name]
    scene, out = write(tmp_path / "scene.toml", GOOD), tmp_path / "out"
    if "must be key=value" not in words:  # there the mistake is not in the file
        words = [str(scene), *words]
    said = jointwave("run", scene, "--set", override, "--out", out, code=2)
    (line,) = without_warnings(said.err)
    assert all(word in line for word in words), line
    assert said.out == "" and not out.exists()


def test_mistake_on_the_command_line(tmp_path):
    """As a user meets it, in a process of its own."""
    scene, out = write(tmp_path / "scene.toml", mistaken("not TOML")), tmp_path / "out"
    command = [sys.executable, "-m", "jointwave", "run", str(scene), "--out", str(out)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == 2 and done.stdout == "" and not out.exists()
    (line,) = done.stderr.splitlines()
    assert all(word in line for word in [str(scene), *IN_TEXT["not TOML"][2]]), line


def test_every_mistake_of_a_file_has_its_line(tmp_path, jointwave):
    """Of several tables, of one check and of the next, and of a variant; what all variants share
    stands there once."""
    wrong = GOOD.replace("side = 0.5", 'side = "thin"').replace(
        "density = 2400.0", "density = -1.0"
    )
    wrong += "time.duration = 0.0\n"
    said = jointwave("compare", scene := write(tmp_path / "scene.toml", wrong), code=2).err
    assert [line.partition(": must")[0] for line in said.splitlines()] == [
        f"jointwave: {scene}: pillar.side = 'thin'",
        f"jointwave: {scene}: rock.density = -1.0",
        f"jointwave: {scene} [undamped]: time.duration = 0.0",
    ]
    apart = GOOD.replace("[20.0]", "[60.0]").replace("y = 20.0", "y = 20.1")
    said = jointwave("explain", write(scene, apart), code=2).err
    keys = [
        line.removeprefix(f"jointwave: {scene}: ").split(" = ")[0] for line in said.splitlines()
    ]
    assert keys == ["soft_layers[0].y", "record.stress"]


def test_every_mistake_of_a_rock_mass_has_its_line(tmp_path, jointwave, one_joint, in_toml):
    """Of three checks of one scene whose tables are each right."""
    up, quiet = {"direction": [0.0, 1.0]}, dict.fromkeys(("left", "right", "bottom"), "quiet")
    record = {"points": [[30.0, 5.0]], "interval": 1.0}
    tables = one_joint(gravity=up, boundaries=quiet, record=record)
    text = in_toml(tables)
    said = jointwave("explain", scene := write(tmp_path / "scene.toml", text), code=2).err
    keys = [
        line.removeprefix(f"jointwave: {scene}: ").split(" = ")[0] for line in said.splitlines()
    ]
    assert keys == ["record.points[0]", "gravity.static", "record.interval"]


def test_of_very_many_mistakes_the_first_hundred_are_listed(tmp_path, jointwave):
    places = ", ".join(f'"{i}"' for i in range(300))
    scene = write(tmp_path / "scene.toml", GOOD.replace("[20.0]", f"[{places}]"))
    lines = jointwave("compare", scene, code=2).err.splitlines()
    assert len(lines) == 101 and lines[-1] == "jointwave: and 200 more"
