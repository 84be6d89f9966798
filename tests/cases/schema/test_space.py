"""Rock masses in space: what their files may hold, their blocks, and mistakes in one line."""

import tomllib
from math import cos, radians, sin

import numpy as np
import pytest

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.cases.material.block_summary import block_summary
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import SIDES
from jointwave.cases.warnings import warnings

ROCK = {"density": 2600.0, "intact_modulus": 5e10}
STIFF = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
DOMAIN = {"size": [8.0, 6.0, 4.0]}
BED = STIFF | {"name": "bed", "dip": 0.0, "spacing": 1.0}
EAST = STIFF | {"name": "east", "dip": 90.0, "dip_direction": 90.0, "spacing": 2.0}
WAVE = {"kind": "P", "direction": [0.0, 0.0, 1.0], "shape": "step", "amplitude": 1e6}
S_WAVE = WAVE | {"kind": "S"}
BASE = {"kind": "base", "side": "bottom", "quantity": "velocity", "shape": "step", "amplitude": 1.0}
QUIET = {"bottom": "quiet"}


EVERY = {"title": "box", "domain": DOMAIN, "rock": ROCK, "joint_sets": [BED]}
EVERY |= {"time": {"duration": 0.1}, "record": {"points": [[1.0, 1.0, 1.5]]}}


def scene(**tables):
    """Return a scene in space with these tables beside a box of rock, its beds and a receiver."""
    return cases.load_tables(EVERY | tables)


@pytest.mark.parametrize("size", [[4.0, 4.0], [4.0, 4.0, 4.0]])
def test_an_sv_wave_moves_in_the_vertical_plane_of_its_direction(size):
    along = [0.6, 0.8] if len(size) == 2 else [0.6, 0.0, 0.8]
    wave = WAVE | {"direction": along, "kind": "SV"}
    tables = {"domain": {"size": size}, "boundaries": QUIET | {"left": "quiet"}}
    tables |= {"joint_sets": [], "record": {"points": [size]}}
    (found,) = scene(waves=[wave], **tables).waves
    assert found.kind == "S"
    assert found.polarisation == (None if len(size) == 2 else [0.0, 0.0, 1.0])


def test_all_that_a_scene_in_space_may_hold():
    found = scene(
        waves=[WAVE, S_WAVE | {"polarisation": [1.0, 0.0, 0.0], "through": [0.0, 0.0, 0.0]}],
        loads=[
            {"kind": "force", "at": [1.0, 1.0, 4.0], "direction": [0.6, 0.8, 0.0]}
            | {"quantity": "force", "shape": "step", "amplitude": 1e3}
        ],
        boundaries=dict.fromkeys(("left", "right", "front", "back", "bottom"), "quiet"),
        gravity={},
        prestress={"xx": 1e6, "yy": 2e6, "zz": 3e6, "yz": 1e5},
        regions=[{"name": "cap", "dip": 10.0, "dip_direction": 45.0, "through": [0.0, 0.0, 3.0]}],
    )
    assert found.in_space and found.kind == "rock mass" and warnings(found) == []
    assert found.gravity.direction == [0.0, 0.0, -1.0] and found.prestress.zz == 3e6
    assert [one.polarisation for one in found.waves] == [None, [1.0, 0.0, 0.0]]


BLOCKS = {
    "beds": ([BED], {}, 4),
    "two sets": ([BED, EAST], {}, 16),
    "brickwork": ([BED, EAST | {"ends_at": ["bed"], "offset": 0.5}], {}, 2 * 4 + 2 * 5),
    "a box out of one bed": ([BED], {"openings": [[[6.0, 0.0, 1.0], [4.0, 6.0, 2.0]]]}, 5),
}


@pytest.mark.parametrize(("sets", "domain", "count"), BLOCKS.values(), ids=BLOCKS)
def test_blocks_of_a_box(sets, domain, count):
    """Their number, and their volume less that of openings."""
    blocks = blocks_of_scene(scene(joint_sets=sets, domain=DOMAIN | domain))
    out = 12.0 if domain else 0.0
    assert blocks.count == count and blocks.volume.sum() == pytest.approx(192.0 - out, rel=1e-12)
    area = np.bincount(blocks.boundary.side, blocks.boundary.area, minlength=7)
    if not domain:
        assert area[:6] == pytest.approx([24, 24, 32, 32, 48, 48], rel=1e-12)
    assert dict(zip(SIDES[3], area, strict=False))["right"] == pytest.approx(24.0, rel=1e-12)


def test_an_arched_opening_is_taken_out_all_along_its_axis():
    """By its area times the length of the axis, in x and z along y; its walls are a side."""
    polygon = [[3.0, 1.0], [5.0, 1.0], [5.0, 2.0], [4.0, 3.0], [3.0, 2.0]]
    prisms = [{"polygon": polygon, "axis": "y"}]
    given = scene(domain=DOMAIN | {"prisms": prisms, "non_convex": "cut"})
    blocks = blocks_of_scene(given)
    assert blocks.volume.sum() == pytest.approx(192.0 - 3.0 * 6.0, rel=1e-12)
    walls = blocks.boundary.area[blocks.boundary.side == len(SIDES[3])].sum()
    assert walls == pytest.approx(6.0 * (2.0 + 1.0 + 1.0 + 2 * 2**0.5), rel=1e-12)


@pytest.mark.parametrize(("dip", "towards"), [(30.0, 0.0), (60.0, 90.0), (45.0, 200.0)])
def test_joints_dip_where_they_say(dip, towards):
    """The normal of joints points up and towards the dip direction, clockwise from north."""
    one = STIFF | {"name": "one", "dip": dip, "dip_direction": towards, "through": [4.0, 3.0, 2.0]}
    found = blocks_of_scene(scene(joint_sets=[one])).contacts
    normal = found.normal[0] * np.sign(found.normal[0, 2])
    across, turn = sin(radians(dip)), radians(towards)
    up = [across * sin(turn), across * cos(turn), cos(radians(dip))]
    assert len(found) == 1 and normal == pytest.approx(up, abs=1e-15)


MISTAKES = {
    "record.points = [[1.0, 1.0]]": (
        "record.points[0] = [1.0, 1.0]: must have 3 numbers: the domain is in space"
    ),
    "waves[0].direction = [0.0, 1.0]": "waves[0].direction = [0.0, 1.0]: must have 3 numbers",
    "joint_sets[0].name = 'east'; joint_sets[0].dip = 90.0; joint_sets[0].spacing = 2.0": (
        "joint_sets[0].dip_direction: is required in space"
    ),
    "waves[0].kind = 'S'": "waves[0].polarisation: is required for an S wave in space",
    "waves[0].kind = 'S'; waves[0].polarisation = [0.0, 0.0, -1.0]": (
        "waves[0].polarisation = [0.0, 0.0, -1.0]: is required for an S wave in space: not along"
    ),
    "waves[0].polarisation = [1.0, 0.0, 0.0]": (
        "waves[0].polarisation = [1.0, 0.0, 0.0]: is of S waves"
    ),
    "prestress.xx = 1e6; prestress.yy = 1e6": "prestress.zz: is required in space",
    "regions = [{ name = 'lens', outline = [[1.0, 1.0, 1.0]] }]": (
        "regions[0].outline = [[1.0, 1.0, 1.0]]: has no meaning in space"
    ),
    "regions = [{ name = 'cap', through = [0.0, 0.0, 5.0] }]": (
        "regions[0].through = [0.0, 0.0, 5.0]: leaves the region empty"
    ),
    "domain.openings = [[[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [2.0, 2.0, 1.0]]]": (
        "domain.openings[0]: must be two opposite corners of a box"
    ),
    "domain.openings = [[[1.0, 1.0, 1.0], [2.0, 2.0, 9.0]]]": (
        "domain.openings[0]: must lie in the domain, near ["
    ),
    "domain.openings = [[[1.0, 1.0, 1.0], [3.0, 3.0, 2.0]]]; "
    "domain.prisms = [{ axis = 'x', polygon = [[2.0, 0.5], [4.0, 1.5], [2.0, 1.5]] }]": (
        "domain.prisms[0]: must not overlap openings[0], near [2, 2."
    ),
    "domain.openings = [[[0.0, 0.0, 0.0], [8.0, 6.0, 4.0]]]": (
        "domain.openings[0]: must leave rock, near [4, 3, 2]"
    ),
    "numerics.continuum.cell = 'triangle'": (
        "numerics.continuum.cell = 'triangle': has no meaning in space"
    ),
    "domain.prisms = [{ axis = 'x', polygon = [[1.0, 1.0], [2.0, 2.0], [2.0, 1.0], [1, 2]] }]": (
        "domain.prisms[0].polygon: must be a polygon that does not cross itself"
    ),
    "domain.prisms = [{ axis = 'x', polygon = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]] }]; "
    "domain.prisms[0].ends = [3.0, 2.0]": (
        "domain.prisms[0].ends = [3.0, 2.0]: must be two increasing numbers"
    ),
    "waves[0].direction = [0.0, 1.0, 0.0]": (
        "boundaries.front = 'free': must be 'quiet': waves[0] enters there"
    ),
    "boundaries.front = 'periodic'": (
        "boundaries.front = 'periodic': needs boundaries.back = 'periodic', too"
    ),
    "boundaries.front = 'periodic'; boundaries.back = 'periodic'; "
    "regions = [{ name = 'cap', dip = 10.0, dip_direction = 0.0, through = [0.0, 0.0, 2.0] }]": (
        "regions[0].dip = 10.0: must be parallel to the y axis: boundaries.front is periodic"
    ),
    "no joint_sets[0].spacing; joint_sets[0].name = 'one'; "
    "joint_sets[0].through = [0.0, 0.0, 7.0]": (
        "joint_sets[0].through: must lie in the domain, near [0, 0, 7]"
    ),
    "domain.openings = [[[0.0, 0.0, 1.0], [2.0, 2.0, 2.0]]]": (
        "record.points[0] = [1.0, 1.0, 1.5]: must lie in the domain and outside its openings"
    ),
    "loads = [{ kind = 'pressure', side = 'bottom', shape = 'step', amplitude = 1.0 }]; "
    "loads[0].between = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]": (
        "loads[0].between = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]: has no meaning in space"
    ),
}


@pytest.mark.parametrize("changes", MISTAKES)
def test_a_mistake_is_one_line(changed, in_toml, changes):
    text = changed(in_toml(EVERY | {"waves": [WAVE], "boundaries": QUIET}), changes)
    with pytest.raises(SceneError) as error:
        cases.load_tables(tomllib.loads(text))
    assert str(error.value).startswith(f"scene: {MISTAKES[changes]}") and "\n" not in str(
        error.value
    )


IN_PLANE = {
    "record.points = [[1.0, 1.0, 1.0]]": "must have 2 numbers",
    "joint_sets[0].dip_direction = 0.0": "no meaning in the plane",
    "boundaries.front = 'fixed'": "is not a side of this domain, which has left",
    "prestress.xx = 1e6; prestress.yy = 1e6; prestress.zz = 1e6": "no meaning in the plane",
    "domain.prisms = [{ axis = 'x', polygon = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]] }]": (
        "no meaning in the plane"
    ),
}


@pytest.mark.parametrize("changes", IN_PLANE)
def test_what_is_of_scenes_in_space_is_refused_in_the_plane(changed, in_toml, changes):
    plane = {"domain": {"size": [8.0, 6.0]}, "record": {"points": [[1.0, 1.5]]}}
    text = changed(in_toml(EVERY | plane), changes)
    with pytest.raises(SceneError, match=IN_PLANE[changes]) as error:
        cases.load_tables(tomllib.loads(text))
    assert "\n" not in str(error.value)


def test_more_blocks_than_memory_are_refused_before_they_are_cut():
    small = [one | {"spacing": 1e-3} for one in (BED, EAST)]
    with pytest.raises(SceneError, match=r"spacing = 0.001: gives about .* available"):
        blocks_of_scene(
            scene(joint_sets=[*small, EAST | {"name": "n", "dip_direction": 0.0, "spacing": 1e-3}])
        )


def test_probable_mistakes_are_warned_of():
    up = {"direction": [0.0, 0.0, 1.0], "static": False}
    assert warnings(scene(gravity=up)) == [
        "gravity.direction = [0, 0, 1] pulls upwards: z points up"
    ]


def test_openings_that_touch_are_no_mistake():
    """Two boxes that share a wall, and a gallery on top of them."""
    boxes = [[[1.0, 1.0, 1.0], [3.0, 3.0, 2.0]], [[3.0, 1.0, 1.0], [5.0, 3.0, 2.0]]]
    arch = {"axis": "y", "polygon": [[1.0, 2.0], [5.0, 2.0], [3.0, 3.0]]}
    domain = DOMAIN | {"openings": boxes, "prisms": [arch], "non_convex": "cut"}
    blocks = blocks_of_scene(scene(domain=domain, record={"points": [[7.0, 1.0, 0.5]]}))
    assert blocks.volume.sum() == pytest.approx(192.0 - 8.0 - 12.0, rel=1e-12)


P, S = (5e10 * 1.2 / 2600.0) ** 0.5, (2e10 / 2600.0) ** 0.5  # of a Poisson's ratio of 1/4
LOAD = {"shape": "step", "amplitude": 1e6}
FORCE = {"kind": "force", "quantity": "force", "direction": [0.6, 0.8, 0.0], "at": [4.0, 5.0, 1.5]}
PRESSURE = {"kind": "pressure", "quantity": "stress"}
REACHED = {
    "a P wave": ({"waves": [WAVE], "boundaries": QUIET}, 1.5 / P),
    "an S wave": (
        {"waves": [S_WAVE | {"polarisation": [1.0, 0.0, 0.0]}], "boundaries": QUIET},
        1.5 / S,
    ),
    "a force": ({"loads": [LOAD | FORCE]}, 5.0 / P),
    "a side": ({"loads": [LOAD | PRESSURE | {"side": "back"}]}, 5.0 / P),
    "an opening": (
        {
            "loads": [LOAD | PRESSURE | {"opening": 0}],
            "domain": DOMAIN | {"openings": [[[4.0, 5.0, 1.0], [5.0, 6.0, 2.0]]]},
        },
        5.0 / P,
    ),
}


@pytest.mark.parametrize(("tables", "at"), REACHED.values(), ids=REACHED)
def test_receivers_that_nothing_reaches_are_named(tables, at):
    """By the speed of the wave, or that of P from where a load acts."""
    for part, late in ((0.99, 1), (1.01, 0)):
        found = warnings(scene(**tables, time={"duration": part * at}))
        found = [line for line in found if "is reached at" in line]
        assert len(found) == late, found
    found = warnings(scene(**tables, time={"duration": 0.5 * at}))
    assert any(
        line.startswith(f"record.points[0] = [1, 1, 1.5] is reached at {at:.4g} s")
        for line in found
    )


def test_periodic_sides_that_do_not_fit_are_refused():
    """Beds along them do; dipping ones end at one side where no other begins."""
    periodic = dict.fromkeys(("left", "right", "front", "back"), "periodic")
    assert blocks_of_scene(scene(boundaries=periodic)).count == 4
    dipping = BED | {"dip": 10.0, "dip_direction": 90.0}
    with pytest.raises(
        SceneError, match=r"boundaries\.left: is periodic, but a joint of 'bed'"
    ) as e:
        blocks_of_scene(scene(joint_sets=[dipping], boundaries=periodic))
    assert "\n" not in str(e.value)


def test_the_summary_counts_rigid_blocks():
    """Of rock cut into cubes and into tetrahedra, which lack nothing of its stiffness."""
    fine = {"numerics": {"dem": {"block": 1.0}}}
    cubes = block_summary(scene(rock=ROCK | {"intact_poisson": 0.0}, **fine))
    tetrahedra = block_summary(scene(**fine))
    assert (cubes["blocks"], cubes["rigid_blocks"], tetrahedra["rigid_blocks"]) == (4, 192, 960)
    assert cubes["rigid_blocks_lack"] < 1e-6 and tetrahedra["rigid_blocks_lack"] < 1e-6
