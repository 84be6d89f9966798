"""Warnings of rock masses: a line for each likely mistake, none for a scene that is meant."""

from math import sqrt

import pytest

from jointwave.cases.warnings import warnings

#: Speeds of the rock; over 1.664 / T of a Ricker wavelet, where 95 % of its energy lies below, what
#: blocks and elements are measured by, m.
P, S = sqrt(5e10 * 0.75 / (1.25 * 0.5) / 2600), sqrt(5e10 / 2.5 / 2600)
SHORTEST = S * 0.005 / 1.664
SETS = [
    {"name": name, "dip": dip, "spacing": 2.0, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    for name, dip in (("a", 0.0), ("b", 90.0))
]
ALIKE = [one | {"scatter": 0.1, "seed": 3} for one in SETS]
PRESSURE = {"kind": "pressure", "side": "left", "shape": "step", "amplitude": 1e5}
FORCE = {"kind": "force", "quantity": "force", "shape": "step", "amplitude": 1e5}
FORCE |= {"at": [10.0, 5.0], "direction": [1.0, 0.0]}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rock__intact_modulus": 50.0}, "rock.intact_modulus = 50 Pa is far below rock's"),
        ({"rock__density": 2.6}, "2.6 g/cm3 is 2600 kg/m3"),
        ({"joint_sets__0__normal_stiffness": 10.0}, "joint_sets[0].normal_stiffness = 10 Pa/m"),
        ({"waves__0__period": 0.05}, "waves[0].period = 0.05 s: the wavelet peaks at 1.5"),
        ({"damping__local": 0.5}, "damping.local distorts waves"),
        ({"numerics__dem__block": 1.0}, "numerics.dem.block = 1 m gives 8.33 rigid blocks"),
        ({"numerics__continuum__size": 2.0}, "numerics.continuum.size = 2 m, of order 2, gives"),
        (
            {"joint_sets__0__damping_ratio": 0.1},
            "joint_sets[0].damping_ratio = 0.1 takes half of the",
        ),
        ({"joint_sets": ALIKE}, "joint_sets[1].seed = 3 is that of joint_sets[0]: their spacings"),
        ({"joint_sets": SETS}, "the joint sets give 4.17 rigid blocks"),
        ({"joint_sets": [SETS[0] | {"maximum_closure": 1e-5}]}, "waves[0]: joints that close"),
    ],
)
def test_a_likely_mistake_in_a_rock_mass_is_a_line(mass, changes, words):
    assert warnings(mass()) == []
    assert any(words in line for line in warnings(mass(**changes))), warnings(mass(**changes))


def test_the_bound_of_blocks_and_nodes_is_ten_a_wavelength(mass):
    for key, each in (("dem__block", 1), ("continuum__size", 2)):  # of elements of order 2
        for part, count in ((0.99, 0), (1.01, 1)):
            found = warnings(mass(**{f"numerics__{key}": part * each * SHORTEST / 10}))
            assert len(found) == count, (key, part, found)


def test_a_wave_across_one_set_is_measured_by_its_spacing(mass):
    """Rigid slabs carry a wave across them, however long they are."""
    fine = SETS[0] | {"spacing": 0.5, "through": [0.0, 0.1]}
    assert warnings(mass(joint_sets=[fine])) == []
    assert len(warnings(mass(joint_sets=[fine], waves__0__direction=[0.6, 0.8]))) == 1


@pytest.mark.parametrize("thickness", [0.8, 1.0])
def test_a_wall_is_measured_by_its_thickness_where_no_set_cuts_it(thickness, rock_with):
    """However long it is."""
    bricks = [one | {"spacing": 0.5, "dip_direction": 90.0} for one in SETS]
    struck = PRESSURE | {"shape": "ricker", "period": 0.005}
    wall = rock_with(*bricks, domain={"size": [40.0, thickness, 3.0]}, loads=[struck])
    expected = f"{SHORTEST / thickness:.3g} rigid blocks per wavelength"
    assert (expected in "".join(warnings(wall))) == (SHORTEST / thickness < 10)


PERIODIC = {"left": "periodic", "right": "periodic", "bottom": "fixed"}
SHAKEN = {"kind": "base", "side": "bottom", "quantity": "velocity", "shape": "ricker"}
SHAKEN |= {"amplitude": 0.1, "period": 0.005, "direction": [0.0, 1.0]}


def test_what_leaves_a_whole_side_is_measured_as_a_wave_is(mass):
    """Up through beds of .5 m; from a part of the side it goes in all directions."""
    beds = {"waves": [], "joint_sets": [SETS[0] | {"spacing": 0.5, "through": [0.0, 0.1]}]}
    on_top = PRESSURE | {"side": "top", "shape": "ricker", "period": 0.005}
    for load in (SHAKEN, on_top):
        assert warnings(mass(**beds, boundaries=PERIODIC, loads=[load])) == []
    part = on_top | {"between": [[8.0, 30.0], [12.0, 30.0]]}
    (line,) = warnings(mass(**beds, boundaries=PERIODIC, loads=[part]))
    assert "the joint sets give" in line


@pytest.mark.parametrize(("offset", "cut"), [(0.0, 0), (0.5, 2)])
def test_bricks_that_periodic_sides_cut_are_counted(offset, cut, rock_with):
    """Of four courses every second has a joint along the sides, or each has."""
    bricks = SETS[0], SETS[1] | {"ends_at": ["a"], "offset": offset}
    tables = {"domain": {"size": [4.0, 8.0]}, "boundaries": PERIODIC}
    found = "\n".join(warnings(rock_with(*bricks, **tables)))
    assert ("cuts" in found) == bool(cut)
    assert not cut or f"boundaries.left = 'periodic' cuts {cut} rigid blocks in two" in found


def test_rollers_along_the_way_of_a_wave_that_moves_rock_into_them_are_named(mass):
    rollers = {"left": "roller", "right": "roller", "bottom": "fixed"}
    assert warnings(mass(waves=[], boundaries=rollers, loads=[SHAKEN])) == []
    found = warnings(mass(waves=[], boundaries=rollers, loads=[SHAKEN | {"direction": [1.0, 0.0]}]))
    held = ["boundaries.left = 'roller' holds the rock", "boundaries.right = 'roller' holds"]
    assert all(one in line for one, line in zip(held, found, strict=True)), found


def test_a_wave_that_is_inside_before_the_scene_begins_is_named(mass):
    """From 18 m above the bottom a P wave has entered 18 m / a before t = 0; from 2 m its first
    0.646 T have, which are none of it."""
    assert not any("through" in line for line in warnings(mass(waves__0__through=[0.0, 2.0])))
    (line,) = (x for x in warnings(mass(waves__0__through=[0.0, 18.0])) if "through" in x)
    assert f"enters the domain {18 / P:.3g} s before t = 0" in line


def test_points_where_the_stress_of_triangles_does_not_converge_are_named(mass):
    """At a weld, to a third of a block, and on a roller; not half a block away, nor on a joint, nor
    of squares."""
    soft = {"name": "soft", "through": [0.0, 9.0], "intact_modulus": 2e10}
    rolls = {"left": "roller", "right": "roller", "bottom": "quiet"}
    points = [[5.0, 9.0], [5.0, 9.2], [0.0, 5.0], [0.2, 5.0], [20.0, 9.1]]
    own = {"regions": [soft], "boundaries": rolls, "record__points": points}

    def said(**changes):
        lines = warnings(mass(**own, numerics__dem__block=0.4, **changes))
        return [line.partition(", where")[0][14:] for line in lines if " converges" in line]

    weld, roller = " lies within 0.133 m of a welded boundary of regions", " lies on a roller side"
    assert said() == [f"0] = [5, 9]{weld}", f"2] = [0, 5]{roller}", f"4] = [20, 9.1]{weld}"]
    assert said(rock__intact_poisson=0.0) == []
    along = {"joint_sets": [SETS[0] | {"spacing": 0.4, "through": [0.0, 9.0]}]}
    assert [one for one in said(**along) if "weld" in one] == []


def test_layers_that_rigid_blocks_do_not_cut_are_named(mass):
    """Those thinner than a fifth of a block, but where no rock has a Poisson effect."""
    for thick, poisson, count in ((0.19, 0.25, 1), (0.21, 0.25, 0), (0.19, 0.0, 0)):
        places = {"seam": [0.0, 9.0], "above": [0.0, 9.0 + 0.4 * thick]}
        seam = [{"name": name, "through": at} for name, at in places.items()]
        own = {"rock__intact_poisson": poisson, "joint_sets": [], "record__joints": []}
        own |= {"domain__least_width": 0.01}
        found = warnings(mass(regions=seam, numerics__dem__block=0.4, **own))
        line = f"region 'seam' is {0.4 * thick:.3g} m thick, less than 0.2 of numerics.dem.block"
        assert sum(one.startswith(line) for one in found) == count, (thick, found)


def test_joints_lost_beside_sides_that_hold_the_rock_are_named(mass):
    """Within a hundredth of the spacing; in the side they are none, and quiet sides lose none that
    would be seen."""
    for y, kind, count in (
        *((0.015, "fixed", 1), (0.015, "roller", 1), (0.015, "quiet", 0)),
        *((0.025, "fixed", 0), (0.0, "fixed", 0)),
    ):
        sides = {"waves": [], "boundaries": {"bottom": kind, "left": "periodic"}}
        sides["boundaries"]["right"] = "periodic"
        found = warnings(mass(**sides, joint_sets=[SETS[0] | {"through": [0.0, y]}]))
        lost = "joint_sets[0] has a joint 0.015 m from boundaries.bottom, less than domain.least"
        assert sum(line.startswith(lost) for line in found) == count, (y, kind, found)


def test_joint_receivers_where_joints_cross_are_named(mass):
    """They read one of four contacts; a metre further on one of two joints, they read it alone."""
    found = warnings(mass(joint_sets=SETS, record__joints=[[4.0, 6.0], [4.0, 7.0]]))
    (line,) = (one for one in found if "cross" in one)
    assert line.startswith("record.joints[0] = [4, 6]") and "joint_sets[0]" in line


def test_gravity_that_acts_suddenly_reaches_everything(mass):
    assert warnings(mass(time__duration=0.008, gravity={"static": False})) == []


def test_local_damping_slows_what_slides_under_sudden_gravity(mass):
    rests = {"waves": [], "damping__local": 0.8, "boundaries": {"bottom": "fixed"}}
    assert warnings(mass(**rests, gravity={})) == []
    (line,) = warnings(mass(**rests, gravity={"static": False}))
    assert "slows what slides or falls to 0.2 of its acceleration" in line


def test_what_stands_by_its_weight_may_sway_slowly(mass):
    """At 2 s: a wave crosses 30 m of rock 200 times in them; without weight they were to be ms."""
    sways = {"waves": [], "boundaries": {"bottom": "fixed"}, "time__duration": 4.0}
    sways["loads"] = [SHAKEN | {"period": 2.0, "amplitude": 0.1}]
    assert warnings(mass(**sways, gravity={})) == []
    (line,) = warnings(mass(**sways))
    assert "2 ms is 0.002 s" in line


BOX = {"size": [20.0, 30.0, 4.0]}
BESIDE = {"domain": BOX, "record": {"points": [[10.0, 25.0, 1.5]]}, "joint_sets": []}
UP = {"kind": "P", "direction": [0.0, 0.0, 1.0], "shape": "step", "amplitude": 1e6}
BOTTOM = {"waves": [UP], "boundaries": {"bottom": "quiet"}} | BESIDE
IN_SPACE = FORCE | {"at": [10.0, 20.0, 1.5], "direction": [0.6, 0.8, 0.0]}
HOLED = BOX | {"openings": [[[10.0, 20.0, 1.0], [11.0, 21.0, 2.0]]]}
SHEARS = {"kind": "S", "polarisation": [1.0, 0.0, 0.0]}
AROUND = {k: v for k, v in PRESSURE.items() if k != "side"} | {"opening": 0}
FAR = "points[0] = [10, 25, 1.5]"


def loaded(load, **more):
    return {"waves": [], "loads": [load]} | more


#: Receivers that are reached at a time by the speed of the wave, or that of P from where a load
#: acts; a Ricker wavelet is felt from 0.646 T on.
REACHED = {
    "a wavelet": ({}, "points[1] = [10, 25]", 0.6456 * 0.005 + 25 / P),
    "a force": (loaded(FORCE), "points[1] = [10, 25]", 20 / P),
    "a side": (loaded(PRESSURE, boundaries__left="free"), "points[0] = [10, 5]", 10 / P),
    "P in space": (BOTTOM, FAR, 1.5 / P),
    "S in space": (BOTTOM | {"waves": [UP | SHEARS]}, FAR, 1.5 / S),
    "a force in space": (BESIDE | loaded(IN_SPACE, boundaries={}), FAR, 5 / P),
    "a side in space": (BESIDE | loaded(PRESSURE | {"side": "back"}, boundaries={}), FAR, 5 / P),
    "an opening in space": (BESIDE | loaded(AROUND, boundaries={}, domain=HOLED), FAR, 4 / P),
}


@pytest.mark.parametrize(("changes", "receiver", "at"), REACHED.values(), ids=REACHED)
def test_receivers_that_nothing_reaches_are_named(mass, changes, receiver, at):
    for part, late in ((0.99, 1), (1.01, 0)):
        scene = mass(**changes, time__duration=part * at, record__interval=1e-6)
        start = f"record.{receiver} is reached at {at:.4g} s"
        found = [line for line in warnings(scene) if line.startswith(start)]
        assert len(found) == late, warnings(scene)
