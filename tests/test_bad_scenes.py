"""Every mistake in a scene is one line that names file, key, value and what is allowed.

A mistake is a change to a good scene: (what is replaced, by what, words that the line must hold).
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

SPEEDS = "p_speed = 2200.0\ns_speed = 800.0"
SINE = 'shape = "sine"\namplitude = 1.0e6\nperiod = 0.01'
TENSILE = "tensile_strength = 1e5\nfracture_energy = 1.0"
RAYLEIGH = "rayleigh = { frequencies = [10.0, 20.0], ratios = [0.02, 0.02] }"
RATED = "direct_effect = 0.01\nevolution_effect = 0.015\ncritical_slip_distance = 1e-4\n"
RATED += "reference_rate = 1e-6"
STIFFNESS = "spacing_stiffness = 4.375e8"
CONTINUUM = "[numerics.continuum]\n"
MESH = 'mesh = "pillar.msh"\n'
LAYER = "[[soft_layers]]\ny = 20.0\nspacing_stiffness = 4.375e8\n"

SEGMENT = "[[segments]]\ny = [10.0, 30.0]\n"
WRONG_SEGMENTS = {
    "no place": ("[[segments]]", ["segments[1].y", "is required"]),
    "from end to start": (
        "[[segments]]\ny = [40.0, 35.0]",
        ["segments[1].y = [40.0, 35.0]", "increasing"],
    ),
    "beyond the pillar": (
        "[[segments]]\ny = [40.0, 51.0]",
        ["segments[1].y = [40.0, 51.0]", "within pillar.length = 50"],
    ),
    "overlap": (
        "[[segments]]\ny = [29.5, 40.0]",
        ["segments[1].y = [29.5, 40.0]", "ends at 30 m", "overlaps the segment"],
    ),
    "crumbs": ("block = 1e-9", ["segments[0].block = 1e-09", "at most 10,000,000 blocks"]),
    "blocks": ("block = 0.3", ["segments[0].block = 0.3", "10 to 30 m"]),
    "place": (
        "[[segments]]\ny = [30.0, 40.2]",
        ["segments[1].y = [30.0, 40.2]", "0.5 m must divide", "30 to 40.2 m"],
    ),
    "key": ("modulus = 1e9", ["segments[0].modulus", "intact_modulus"]),
    "half a pair": ("p_speed = 3000.0", ["segments[0].p_speed = 3000.0", "one pair or none"]),
    "speeds": (
        "p_speed = 900.0\ns_speed = 800.0",
        ["segments[0].p_speed = 900.0", "sqrt(4/3) times s_speed = 800"],
    ),
    "too soft": (
        "intact_modulus = 1e9",
        ["segments[0].intact_modulus = 1000000000.0", "exceed the equivalent modulus", "joints"],
    ),
    "intact and jointed": (
        "joints = false\nnormal_stiffness = 1e9",
        ["segments[0].normal_stiffness", "segments[0].joints = false give intact_modulus"],
    ),
}

MISTAKES = {
    # wrong types
    "text for a number": ("length = 50.0", 'length = "50"', ["pillar.length = '50'", "a number"]),
    "bool for a number": ("length = 50.0", "length = true", ["pillar.length = true", "a number"]),
    "date for a number": (
        "density = 2400.0",
        "density = 2400-01-01",
        ["rock.density = 2400-01-01", "a number"],
    ),
    "list for a number": ("side = 0.5", "side = [0.5, 0.5]", ["pillar.side = [0.5, 0.5]"]),
    "number for a text": ('title = "good"', "title = 3", ["title = 3", "must be a string"]),
    "number for a table": ("[time]\nduration = 0.002\n", "", ["time", "is required"]),
    "text for a table": (
        'title = "good"',
        'title = "good"\ngravity = "down"',
        ["gravity = 'down'", "must be a table"],
    ),
    "number for a list": ("stress = [20.0]", "stress = 20.0", ["record.stress = 20.0", "a list"]),
    "text in a list": ("[20.0]", '["20"]', ["record.stress[0] = '20'", "a number"]),
    "number for a bool": (
        "damping_ratio = 0.02",
        "tension = 0",
        ["joints.tension = 0", "or false"],
    ),
    "fraction for a whole number": (
        "period = 0.01",
        "period = 0.01\ncycles = 1.5",
        ["load.cycles = 1.5", "a whole number"],
    ),
    "one table for many": ("[[soft_layers]]", "[soft_layers]", ["soft_layers", "[[soft_layers]]"]),
    # unknown keys
    "unknown table": ("[time]", "[loads]\n[time]", ["loads: unknown key", "load, ends"]),
    "unknown key of pillar": ("side = 0.5", "width = 0.5", ["pillar.", "side"]),
    "unknown key of rock": ("[rock]", "[rock]\nspeed = 1", ["rock.speed = 1", "p_speed, s_speed"]),
    "unknown key of joints": ("[joints]", "[joints]\nzeta = 1", ["joints.zeta", "damping_ratio"]),
    "unknown key of a layer": (LAYER, LAYER + "K = 1\n", ["soft_layers[0].K = 1", "thickness"]),
    "unknown key of load": ("[load]", "[load]\nforce = 1", ["load.force = 1", "amplitude"]),
    "unknown key of ends": ("[ends]", "[ends]\ntop = 1", ["ends.top = 1", "start, end"]),
    "unknown key of time": ("[time]", "[time]\nstep = 1", ["time.step = 1", "duration"]),
    "unknown key of record": ("[record]", "[record]\nstrain = [1]", ["record.strain", "velocity"]),
    "unknown key of numerics": (
        "[time]",
        "[numerics]\ndem.dt = 1\n[time]",
        ["numerics.dem.dt = 1", "step_fraction"],
    ),
    "a name outside a variant": ('"good"', '"good"\nname = "x"', ["name = 'x'", "[[variants]]"]),
    # missing
    "no pillar": ("[pillar]\nlength = 50.0\nside = 0.5\nblock = 0.5\n", "", ["pillar", "required"]),
    "no length": ("length = 50.0\n", "", ["pillar.length", "is required"]),
    "no title": ('title = "good"\n', "", ["title", "is required"]),
    "no amplitude": ("amplitude = 1.0e6\n", "", ["load.amplitude", "is required"]),
    "no receivers": (
        "stress = [20.0]\nvelocity = [19.75, 20.25]",
        "",
        ["record", "at least one of record.stress and velocity"],
    ),
    # numbers
    "NaN": ("side = 0.5", "side = nan", ["pillar.side = nan", "finite"]),
    "NaN amplitude": ("amplitude = 1.0e6", "amplitude = nan", ["load.amplitude = nan", "finite"]),
    "infinite": ("duration = 0.002", "duration = inf", ["time.duration = inf", "finite"]),
    "zero": ("density = 2400.0", "density = 0.0", ["rock.density = 0.0", "greater than 0"]),
    "negative": ("length = 50.0", "length = -50.0", ["pillar.length = -50.0", "greater than 0"]),
    "negative ratio": ("= 0.02", "= -0.02", ["joints.damping_ratio = -0.02", "at least 0"]),
    "no unit explains it": ("side = 0.5", "side = 1e200", ["pillar.side = 1e+200", "1e30"]),
    "an integer of 400 digits": ("side = 0.5", "side = 1" + "0" * 400, ["pillar.side", "bits"]),
    "order 9": (
        "[time]",
        "[numerics]\ncontinuum.order = 9\n[time]",
        ["numerics.continuum.order = 9", "at most 4"],
    ),
    "Poisson's ratio": (
        SPEEDS,
        "equivalent_modulus = 4.4e9\nequivalent_poisson = 0.5",
        ["rock.equivalent_poisson = 0.5", "less than 0.5"],
    ),
    # the pillar and what lies on it
    "block does not divide": ("block = 0.5", "block = 0.3", ["pillar.block = 0.3", "whole number"]),
    "block longer than pillar": ("block = 0.5", "block = 60.0", ["pillar.block = 60.0", "2 to"]),
    "1e12 blocks": ("block = 0.5", "block = 5e-11", ["pillar.block = 5e-11", "10,000,000 blocks"]),
    "layer off a joint": ("y = 20.0", "y = 20.1", ["soft_layers[0].y = 20.1", "multiple of 0.5"]),
    "layer at the end": ("y = 20.0", "y = 50.0", ["soft_layers[0].y = 50.0", "from 0.5 to 49.5"]),
    "two layers on one joint": (LAYER, LAYER * 2, ["soft_layers[1].y = 20.0", "already"]),
    "two stiffnesses": (
        "spacing_stiffness = 4.375e8",
        "spacing_stiffness = 4.375e8\nnormal_stiffness = 1e9",
        ["soft_layers[0].spacing_stiffness = 437500000.0", "not both"],
    ),
    "receiver outside": ("[20.0]", "[20.0, 50.1]", ["record.stress = 50.1", "0 and 50 m"]),
    "receiver before the start": ("[20.0]", "[-1.0]", ["record.stress[0] = -1.0", "at least 0"]),
    "receiver twice": ("[20.0]", "[20.0, 20.0]", ["record.stress = [20.0, 20.0]", "repeat"]),
    "interval above duration": (
        "[record]",
        "[record]\ninterval = 1.0",
        ["record.interval = 1.0", "time.duration = 0.002"],
    ),
    "too many samples": (
        "[record]",
        "[record]\ninterval = 1e-12",
        ["record.interval = 1e-12", "10,000,000 samples"],
    ),
    # the rock
    "both pairs": (
        SPEEDS,
        SPEEDS + "\nequivalent_modulus = 4e9\nequivalent_poisson = 0.4",
        ["rock = [", "exactly one pair"],
    ),
    "half a pair": ("s_speed = 800.0\n", "", ["rock = ['p_speed']", "exactly one pair"]),
    "half of each pair": (
        "s_speed = 800.0",
        "equivalent_modulus = 4e9",
        ["rock = ['p_speed', 'equivalent_modulus']", "exactly one pair"],
    ),
    "neither pair": (SPEEDS, "", ["rock", "exactly one pair"]),
    "p_speed too low": (
        "p_speed = 2200.0",
        "p_speed = 900.0",
        ["rock.p_speed = 900.0", "sqrt(4/3)"],
    ),
    "intact rock too soft": (
        "intact_modulus = 8.64e10",
        "intact_modulus = 4e9",
        ["rock.intact_modulus = 4000000000.0", "4.374e+09"],
    ),
    # the load
    "unknown shape": ('"sine"', '"square"', ["load.shape = 'square'", "'ricker', 'gabor'"]),
    "unknown end": ('"quiet"', '"open"', ["ends.end = 'open'", "'matched'"]),
    "sine without period": ("period = 0.01\n", "", ["load.period", "load.shape = 'sine'"]),
    "ricker without period": (
        SINE,
        'shape = "ricker"\namplitude = 1.0',
        ["load.period", "is required for load.shape = 'ricker'"],
    ),
    "step with a period": ('"sine"', '"step"', ["load.period = 0.01", "no meaning"]),
    "gabor without cycles": (
        SINE,
        'shape = "gabor"\namplitude = 1.0\nperiod = 0.01',
        ["load.cycles", "is required for load.shape = 'gabor'"],
    ),
    "triangle without decay": (
        SINE,
        'shape = "triangle"\namplitude = 1.0\nrise = 0.01',
        ["load.decay", "is required for load.shape = 'triangle'"],
    ),
    "sine with a rise": (
        "period = 0.01",
        "period = 0.01\nrise = 0.1",
        ["load.rise = 0.1", "has no meaning for shape 'sine'"],
    ),
    "table without file": (SINE, 'shape = "table"\namplitude = 1.0', ["load.file", "is required"]),
    "zero direction": (
        "period = 0.01",
        "period = 0.01\ndirection = [0, 0, 0]",
        ["load.direction = [0, 0, 0]", "unit vector"],
    ),
    "direction in a plane": (
        "period = 0.01",
        "period = 0.01\ndirection = [0, 1]",
        ["load.direction = [0, 1]", "3 numbers"],
    ),
    "unknown quantity": (
        "[load]",
        '[load]\nquantity = "force"',
        ["load.quantity = 'force'", "'stress', 'incident-stress', 'velocity'"],
    ),
    "a load beside the face": (
        "[load]",
        "[load]\nat = [0.0, 0.3]",
        ["load.at = [0.0, 0.3]", "on the face, within 0.25 m"],
    ),
    "an eccentric couple": (
        "[load]",
        "[load]\nat = [0.1, 0.0]\narm = 0.2",
        ["load.arm = 0.2", "takes no load.at"],
    ),
    "an eccentric load on blocks that do not turn": (
        "[load]",
        '[motion]\nrotation = "none"\n[load]\nat = [0.1, 0.0]',
        ["load.at = [0.1, 0.0]", "motion.rotation = 'none'"],
    ),
    "a couple on blocks that do not turn": (
        "[load]",
        '[motion]\nrotation = "none"\n[load]\narm = 0.1',
        ["load.arm = 0.1", "motion.rotation = 'none'"],
    ),
    "a stress on a fixed start": (
        "[ends]",
        '[ends]\nstart = "fixed"',
        ["ends.start = 'fixed'", "'velocity' or 'acceleration'"],
    ),
    "a shaken start that is free": (
        "[load]",
        '[load]\nquantity = "velocity"',
        ["load.quantity = 'velocity'", "ends.start = 'fixed'"],
    ),
    "a compliant base at an angle": (
        "\n\n[ends]",
        '\nquantity = "velocity"\ndirection = [0.6, 0.8, 0]\n\n[ends]\nstart = "quiet"',
        ["load.direction = [0.6, 0.8, 0", "along or across the axis"],
    ),
    "an eccentric motion": (
        "[load]",
        '[load]\nquantity = "velocity"\nat = [0.1, 0.0]',
        ["load.at = [0.1, 0.0]", "no meaning for load.quantity 'velocity'"],
    ),
    "an acceleration with an arm": (
        "[load]",
        '[load]\nquantity = "acceleration"\narm = 0.1',
        ["load.arm = 0.1", "no meaning for load.quantity 'acceleration'"],
    ),
    # the strength of joints
    "strength without fracture energy": (
        "[joints]",
        "[joints]\ntensile_strength = 1e5",
        ["joints.fracture_energy", "is required with joints.tensile_strength"],
    ),
    "a layer's fracture energy without strength": (
        LAYER,
        LAYER + "fracture_energy = 10.0\n",
        ["soft_layers[0].tensile_strength", "is required with soft_layers[0].fracture_energy"],
    ),
    "strength where tension is barred": (
        "[joints]",
        f"[joints]\ntension = false\n{TENSILE}",
        ["joints.tension = false", "contradicts tensile_strength"],
    ),
    "strength where tension is carried": (
        "[joints]",
        f"[joints]\ntension = true\n{TENSILE}",
        ["joints.tension = true", "contradicts tensile_strength"],
    ),
    "a layer that inherits its strength": (
        f"damping_ratio = 0.02\n\n{LAYER}",
        f"{TENSILE}\n{LAYER}tension = false\n",
        ["soft_layers[0].tension = false", "contradicts tensile_strength"],
    ),
    "a fracture energy that snaps back": (
        "[joints]",
        "[joints]\ntensile_strength = 1e5\nfracture_energy = 0.5",
        ["joints.fracture_energy = 0.5", "snaps back", "at least 0.5716 J/m2"],
    ),
    "a soft layer that snaps back": (
        "[joints]",
        f"[joints]\n{TENSILE}",
        ["soft_layers[0].fracture_energy = 1.0", "snaps back", "at least 5.744 J/m2"],
    ),
    "residual cohesion alone": (
        "[joints]",
        "[joints]\nresidual_cohesion = 1e4",
        ["joints.residual_cohesion = 10000.0", "needs a cohesion"],
    ),
    "residual cohesion above cohesion": (
        "[joints]",
        "[joints]\ncohesion = 1e4\nresidual_cohesion = 2e4",
        ["joints.residual_cohesion = 20000.0", "at most the cohesion 10000 Pa"],
    ),
    "a layer's residual above the joints' cohesion": (
        f"damping_ratio = 0.02\n\n{LAYER}",
        f"cohesion = 1e4\n\n{LAYER}residual_cohesion = 2e4\n",
        ["soft_layers[0].residual_cohesion = 20000.0", "at most the cohesion 10000 Pa"],
    ),
    "a weakening distance alone": (
        "[joints]",
        "[joints]\nfriction_angle = 30.0\nweakening_distance = 1e-3",
        ["joints.dynamic_friction_angle", "is required with joints.weakening_distance"],
    ),
    "dynamic friction without friction": (
        "[joints]",
        "[joints]\ndynamic_friction_angle = 20.0\nweakening_distance = 1e-3",
        ["joints.dynamic_friction_angle = 20.0", "needs a friction_angle"],
    ),
    "friction that rises with slip": (
        "[joints]",
        "[joints]\nfriction_angle = 20.0\ndynamic_friction_angle = 30.0\nweakening_distance = 1e-3",
        ["joints.dynamic_friction_angle = 30.0", "at most friction_angle = 20"],
    ),
    "a state of no rate": (
        "[joints]",
        "[joints]\nfriction_angle = 30.0\ninitial_state = 1.0",
        ["joints.direct_effect", "is required with joints.initial_state"],
    ),
    "a direct effect alone": (
        "[joints]",
        "[joints]\nfriction_angle = 30.0\ndirect_effect = 0.01",
        ["joints.evolution_effect", "is required with joints.direct_effect"],
    ),
    "rate and state without friction": (
        "[joints]",
        f"[joints]\n{RATED}",
        ["joints.direct_effect = 0.01", "needs a friction_angle"],
    ),
    "rate and state that weakens": (
        "[joints]",
        f"[joints]\nfriction_angle = 30.0\n{RATED}\n"
        "dynamic_friction_angle = 20.0\nweakening_distance = 1e-3",
        ["joints.dynamic_friction_angle = 20", "contradicts direct_effect"],
    ),
    "rate and state that dilates": (
        "[joints]",
        f"[joints]\nfriction_angle = 30.0\n{RATED}\ndilation_angle = 5.0\ndilation_distance = 1e-2",
        ["joints.dilation_angle = 5", "contradicts direct_effect"],
    ),
    "dilation without friction": (
        "[joints]",
        "[joints]\ndilation_angle = 5.0\ndilation_distance = 1e-3",
        ["joints.dilation_angle = 5", "needs a friction_angle"],
    ),
    "dilation above friction": (
        "[joints]",
        "[joints]\nfriction_angle = 20.0\ndilation_angle = 21.0\ndilation_distance = 1e-3",
        ["joints.dilation_angle = 21", "at most friction_angle = 20"],
    ),
    "dilation above what friction falls to": (
        "[joints]",
        "[joints]\nfriction_angle = 30.0\ndilation_angle = 15.0\ndilation_distance = 1.0\n"
        "dynamic_friction_angle = 10.0\nweakening_distance = 1e-3",
        [
            "joints.dilation_angle = 15",
            "must be at most 10.01",
            "friction at dynamic_friction_angle = 10",
        ],
    ),
    "a vertical friction angle": (
        "[joints]",
        "[joints]\nfriction_angle = 90.0",
        ["joints.friction_angle = 90.0", "less than 90"],
    ),
    "contact points of one layer": (
        LAYER,
        LAYER + "contact_points = 3\n",
        ["soft_layers[0].contact_points = 3", "applies to all joints"],
    ),
    "a number of points with vertices": (
        "[joints]",
        "[joints]\ncontact_points = 3",
        ["joints.contact_points = 3", "needs point_rule = 'midpoint' or 'gauss'"],
    ),
    "point rule of one layer": (
        LAYER,
        LAYER + 'point_rule = "gauss"\n',
        ["soft_layers[0].point_rule = 'gauss'", "applies to all joints"],
    ),
    # damping and gravity
    "Rayleigh's damping and a damping ratio": (
        "[ends]",
        f"[damping]\n{RAYLEIGH}\n[ends]",
        ["joints.damping_ratio = 0.02", "damping.rayleigh already sets", "give one"],
    ),
    "Rayleigh's damping and a layer's ratio": (
        f"damping_ratio = 0.02\n\n{LAYER}",
        f"\n{LAYER}damping_ratio = 0.1\n[damping]\n{RAYLEIGH}\n",
        ["soft_layers[0].damping_ratio = 0.1", "damping.rayleigh already sets", "give one"],
    ),
    "two mass-proportional dampings": (
        "[ends]",
        f"[damping]\nmass_proportional = 3.0\n{RAYLEIGH}\n[ends]",
        ["damping.mass_proportional = 3.0", "damping.rayleigh already sets", "give one"],
    ),
    "Rayleigh's ratios too far apart": (
        "[ends]",
        "[damping]\nrayleigh = { frequencies = [10.0, 20.0], ratios = [0.01, 0.1] }\n[ends]",
        ["damping.rayleigh.ratios = [0.01, 0.1]", "alpha = -6.702 1/s", "beta = 0.002016 s"],
    ),
    "Rayleigh's frequencies not in order": (
        "[ends]",
        "[damping]\nrayleigh = { frequencies = [20.0, 20.0], ratios = [0.1, 0.1] }\n[ends]",
        ["damping.rayleigh.frequencies = [20.0, 20.0]", "increasing"],
    ),
    "local damping of one": (
        "[ends]",
        "[damping]\nlocal = 1.0\n[ends]",
        ["damping.local = 1.0", "less than 1"],
    ),
    "gravity along no unit vector": (
        "[ends]",
        "[gravity]\ndirection = [0, 2, 0]\n[ends]",
        ["gravity.direction = [0, 2, 0]", "unit vector"],
    ),
    "static gravity on a pillar that nothing holds": (
        "[ends]",
        "[gravity]\ndirection = [0, -1, 0]\n[ends]",
        ["gravity.static = true", "needs a fixed end", "or gravity.static = false"],
    ),
    "sudden gravity that pulls a pillar off its quiet end": (
        "[ends]",
        "[gravity]\ndirection = [0, -1, 0]\nstatic = false\n[ends]",
        ["ends.end = 'quiet'", "pulls the pillar off it", "needs a fixed"],
    ),
    # segments
    **{
        f"segments: {name}": ("[load]", f"{SEGMENT}{keys}\n[load]", words)
        for name, (keys, words) in WRONG_SEGMENTS.items()
    },
    "segments and gravity": (
        "[load]",
        f"{SEGMENT}[gravity]\ndirection = [0, 1, 0]\nstatic = false\n[load]",
        ["gravity.acceleration = 9.81", "is not supported with segments or scatter"],
    ),
    "segments and a shear wave": (
        "[load]",
        f"{SEGMENT}[load]\ndirection = [1, 0, 0]",
        ["segments = 1", "axial motion only", "a component across"],
    ),
    "segments and blocks that do not turn": (
        "[load]",
        f'{SEGMENT}[motion]\nrotation = "none"\n[load]',
        ["motion.rotation = 'none'", "segments"],
    ),
    "segments in a mesh": (
        "[load]",
        f'{SEGMENT}[numerics]\ndem.scheme = "fourth-order"\n[load]',
        ["numerics.dem.scheme = 'fourth-order'", "'leapfrog'"],
    ),
    "a layer within an intact segment": (
        f"damping_ratio = 0.02\n\n{LAYER}",
        f"\n[[soft_layers]]\ny = 20.0\n{SEGMENT}joints = false\n",
        ["soft_layers[0].y = 20.0", "needs a normal_stiffness"],
    ),
    "a thick layer beside a segment": (
        LAYER,
        f"{LAYER}thickness = 0.1\n{SEGMENT}",
        ["soft_layers[0].thickness = 0.1", "must be a segment"],
    ),
    "a layer off the joints of a segment": (
        "y = 20.0\n",
        "y = 20.25\n",
        ["soft_layers[0].y = 20.25", "must be on a joint"],
    ),
    # scatter
    "scatter of nothing": (
        "[load]",
        "[scatter]\nseed = 1\n[load]",
        ["scatter:", "give scatter.spacing"],
    ),
    "scatter without a seed": (
        "[load]",
        "[scatter]\nspacing = 0.2\n[load]",
        ["scatter.seed", "is required"],
    ),
    "scatter beyond the mean": (
        "[load]",
        "[scatter]\ncompliance = 0.6\nseed = 1\n[load]",
        ["scatter.compliance = 0.6", "at most 0.5"],
    ),
    "scatter and gravity": (
        "[load]",
        "[gravity]\ndirection = [0, 1, 0]\nstatic = false\n"
        "[scatter]\nspacing = 0.2\nseed = 1\n[load]",
        ["gravity.acceleration = 9.81", "is not supported with segments or scatter"],
    ),
    # variants and expectations
    "variants not tables": (
        '[[variants]]\nname = "undamped"',
        "[variants]\nzeta = 1",
        ["variants", "[[variants]]"],
    ),
    "variant without a name": ('name = "undamped"', "", ["variants[0].name", "must be a string"]),
    "variant that leaves its folder": ('"undamped"', '"../x"', ["variants[0].name = '../x'", "/"]),
    "two variants of one name": (
        'name = "undamped"',
        'name = "a"\n[[variants]]\nname = "a"',
        ["variants[1].name = 'a'", "unique"],
    ),
    "bad key in a variant": (
        'name = "undamped"',
        'name = "undamped"\njoints.zeta = 1',
        ["[undamped]", "joints.zeta = 1", "damping_ratio"],
    ),
    "bad value in a variant": (
        'name = "undamped"',
        'name = "undamped"\njoints.damping_ratio = "none"',
        ["[undamped]", "joints.damping_ratio = 'none'", "a number"],
    ),
    "expect of an unknown pair": (
        '"dem ~ lattice"',
        '"dem ~ truth"',
        ["expect.dem ~ truth", "'a ~ b'", "jointed-bar"],
    ),
    "expect of one alone": ('"dem ~ lattice"', '"dem"', ["expect.dem", "'a ~ b'"]),
    "expect of itself": ('"dem ~ lattice"', '"dem ~ dem"', ["expect.dem ~ dem", "'a ~ b'"]),
    "negative bound": ("= 2e-3", "= -2e-3", ["expect.dem ~ lattice = -0.002", "greater than 0"]),
    # the file itself
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
    "a layer of no stiffness": (
        STIFFNESS,
        "thickness = 0.1",
        ["soft_layers[0].thickness = 0.1", "needs a spacing_stiffness or normal_stiffness"],
    ),
}

#: How the continuum is meshed and stepped: lines of its table of [numerics].
MESHED = {
    # the elements
    "simplices of third order": (
        'order = 3\ncell = "simplex"\n',
        ["numerics.continuum.order = 3", "1 or 2", "'simplex'"],
    ),
    "consistent mass of hexahedra": (
        'mass = "consistent"\n',
        ["numerics.continuum.mass = 'consistent'", "needs cell 'simplex'"],
    ),
    "consistent mass in explicit steps": (
        'mass = "consistent"\ncell = "simplex"\nscheme = "explicit"\n',
        ["numerics.continuum.mass = 'consistent'", "'implicit' or 'auto'"],
    ),
    "unknown cell": ('cell = "cube"\n', ["numerics.continuum.cell = 'cube'", "'simplex'"]),
    "four dimensions": ("dim = 4\n", ["numerics.continuum.dim = 4", "at most 3"]),
    "no element across": (
        "elements_across = 0\n",
        ["numerics.continuum.elements_across = 0", "at least 1"],
    ),
    # a file
    "a file that is not there": (
        'mesh = "gone.msh"\n',
        ["numerics.continuum.mesh = 'gone.msh'", "no such file"],
    ),
    "a folder": ('mesh = ""\n', ["numerics.continuum.mesh = ''", "must be a file"]),
    "a pipe": ('mesh = "pipe"\n', ["numerics.continuum.mesh = 'pipe'", "must be a file"]),
    "a bar from a file": (
        MESH + "dim = 1\n",
        ["numerics.continuum.dim = 1", "is a bar"],
    ),
    "a cell beside a file": (
        MESH + 'cell = "simplex"\n',
        ["numerics.continuum.cell = 'simplex'", "no meaning with numerics.continuum.mesh"],
    ),
    "elements beside a file": (
        MESH + "elements_per_block = 2\n",
        ["numerics.continuum.elements_per_block = 2", "no meaning"],
    ),
    "elements across beside a file": (
        MESH + "elements_across = 2\n",
        ["numerics.continuum.elements_across = 2", "no meaning"],
    ),
}

#: A soft layer with a thickness: further lines of its table.
THICK = {
    "a layer as thick as a block": (
        "thickness = 0.5\n",
        ["soft_layers[0].thickness = 0.5", "less than pillar.block = 0.5"],
    ),
    "a layer with friction": (
        "thickness = 0.1\nfriction_angle = 30.0\n",
        ["soft_layers[0].friction_angle = 30.0", "a layer with thickness is rock"],
    ),
    "a layer with cohesion": (
        "thickness = 0.1\ncohesion = 0.0\n",
        ["soft_layers[0].cohesion = 0.0", "a layer with thickness is rock"],
    ),
    "a layer with a shear stiffness": (
        "thickness = 0.1\nshear_stiffness = 1e9\n",
        ["soft_layers[0].shear_stiffness = 1000000000.0", "a layer with thickness is rock"],
    ),
    "a layer that opens": (
        "thickness = 0.1\ntension = false\n",
        ["soft_layers[0].tension = false", "a layer with thickness is rock"],
    ),
    "a layer that breaks": (
        "thickness = 0.1\ntensile_strength = 1e5\nfracture_energy = 100.0\n",
        ["soft_layers[0].tensile_strength = 100000.0", "a layer with thickness is rock"],
    ),
}

MISTAKES |= {
    name: ("[time]", f"{CONTINUUM}{lines}[time]", w) for name, (lines, w) in MESHED.items()
}
MISTAKES |= {name: (STIFFNESS, f"{STIFFNESS}\n{lines}", w) for name, (lines, w) in THICK.items()}

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
    """Return the good scene with one mistake in it."""
    old, new, _ = MISTAKES[name]
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


def test_there_are_at_least_forty_distinct_mistakes():
    assert len({mistaken(name) for name in MISTAKES}) >= 40


@pytest.mark.parametrize("name", MISTAKES)
def test_mistake_is_one_line(name, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "pillar.msh").touch()
    message = line_of(write(tmp_path / "scene.toml", mistaken(name)))
    for word in MISTAKES[name][2]:
        assert word in message


def meshed(folder: Path, text: str = GOOD) -> Path:
    """Write a scene whose continuum has its mesh from a file, which is empty."""
    (folder / "pillar.msh").touch()
    return write(folder / "scene.toml", text.replace("[time]", f"{CONTINUUM}{MESH}[time]"))


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
    assert all(word in line for word in [str(scene), *MISTAKES["not TOML"][2]]), line


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
