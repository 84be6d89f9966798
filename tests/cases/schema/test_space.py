"""Rock masses in space: what their files may hold, and their blocks."""

from math import cos, radians, sin

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.material.rock_mass import block_summary
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import SIDES
from jointwave.cases.warnings import warnings

BED = {"name": "bed", "dip": 0.0, "spacing": 1.0}
EAST = {"name": "east", "dip": 90.0, "dip_direction": 90.0, "spacing": 2.0}
WAVE = {"kind": "P", "direction": [0.0, 0.0, 1.0], "shape": "step", "amplitude": 1e6}


@pytest.fixture
def scene(rock_with):
    """A function of joint sets and other tables: a box of rock, 8 by 6 by 4 m."""

    def make(*sets, domain=None, **tables):
        size, tables = {"size": [8.0, 6.0, 4.0]}, {"time": {"duration": 0.1}} | tables
        return rock_with(*(sets or (BED,)), domain=size | (domain or {}), **tables)

    return make


@pytest.mark.parametrize("size", [[4.0, 4.0], [4.0, 4.0, 4.0]])
def test_an_sv_wave_moves_in_the_vertical_plane_of_its_direction(rock_with, size):
    along = [0.6, 0.8] if len(size) == 2 else [0.6, 0.0, 0.8]
    quiet = {"bottom": "quiet", "left": "quiet"}
    waves = [WAVE | {"direction": along, "kind": "SV"}]
    (found,) = rock_with(waves=waves, domain={"size": size}, boundaries=quiet).waves
    assert found.kind == "S"
    assert found.polarisation == (None if len(size) == 2 else [0.0, 0.0, 1.0])


def test_all_that_a_scene_in_space_may_hold(scene):
    force = {"kind": "force", "at": [1.0, 1.0, 3.6], "direction": [0.6, 0.8, 0.0]}
    s_wave = {"kind": "S", "polarisation": [1.0, 0.0, 0.0], "through": [0.0, 0.0, 0.0]}
    cap = {"name": "cap", "dip": 10.0, "dip_direction": 45.0, "through": [0.0, 0.0, 3.0]}
    found = scene(
        waves=[WAVE, WAVE | s_wave],
        loads=[force | {"quantity": "force", "shape": "step", "amplitude": 1e3}],
        boundaries=dict.fromkeys(("left", "right", "front", "back", "bottom"), "quiet"),
        gravity={},
        prestress={"xx": 1e6, "yy": 2e6, "zz": 3e6, "yz": 1e5},
        regions=[cap],
    )
    assert found.in_space and found.kind == "rock mass" and warnings(found) == []
    assert found.gravity.direction == [0.0, 0.0, -1.0] and found.prestress.zz == 3e6
    assert [one.polarisation for one in found.waves] == [None, [1.0, 0.0, 0.0]]
    upwards = scene(gravity={"direction": [0.0, 0.0, 1.0], "static": False})
    assert warnings(upwards) == ["gravity.direction = [0, 0, 1] pulls upwards: z points up"]


ARCH = [[3.0, 1.0], [5.0, 1.0], [5.0, 2.0], [4.0, 3.0], [3.0, 2.0]]
BOXES = [[[1.0, 1.0, 1.0], [3.0, 3.0, 2.0]], [[3.0, 1.0, 1.0], [5.0, 3.0, 2.0]]]
GABLE = {"axis": "y", "polygon": [[1.0, 2.0], [5.0, 2.0], [3.0, 3.0]]}
BOX_OUT = {"openings": [[[6.0, 0.0, 1.0], [4.0, 6.0, 2.0]]]}
ARCHED = {"prisms": [{"polygon": ARCH, "axis": "y"}], "non_convex": "cut"}
TOUCHING = {"openings": BOXES, "prisms": [GABLE], "non_convex": "cut"}
#: Joint sets, the domain, the number of blocks, and volume and walls of openings: a prism has its
#: polygon, in x and z along y, times the length of its axis; two boxes share a wall, below a gable.
BLOCKS = {
    "beds": ([BED], {}, 4, 0.0, 0.0),
    "two sets": ([BED, EAST], {}, 16, 0.0, 0.0),
    "brickwork": ([BED, EAST | {"ends_at": ["bed"], "offset": 0.5}], {}, 18, 0.0, 0.0),
    "a box out of one bed": ([BED], BOX_OUT, 5, 12.0, 36.0),
    "an arch": ([BED], ARCHED, None, 18.0, 6.0 * (4.0 + 2 * 2**0.5)),
    "boxes that touch": ([BED], TOUCHING, None, 8.0 + 12.0, None),
}


@pytest.mark.parametrize(("sets", "domain", "count", "out", "walls"), BLOCKS.values(), ids=BLOCKS)
def test_blocks_of_a_box(scene, sets, domain, count, out, walls):
    """Their number, their volume less that of openings, and the areas of all sides."""
    blocks = blocks_of_scene(scene(*sets, domain=domain))
    assert count in (None, blocks.count)
    assert blocks.volume.sum() == pytest.approx(192.0 - out, rel=1e-12)
    area = np.bincount(blocks.boundary.side, blocks.boundary.area, minlength=len(SIDES[3]) + 1)
    assert dict(zip(SIDES[3], area, strict=False))["right"] == pytest.approx(24.0, rel=1e-12)
    if not domain:
        assert area[:6] == pytest.approx([24, 24, 32, 32, 48, 48], rel=1e-12)
    if walls is not None:
        assert area[len(SIDES[3]) :].sum() == pytest.approx(walls, rel=1e-12)


@pytest.mark.parametrize(("dip", "towards"), [(30.0, 0.0), (60.0, 90.0), (45.0, 200.0)])
def test_joints_dip_where_they_say(scene, dip, towards):
    """The normal of joints points up and towards the dip direction, clockwise from north."""
    one = {"dip": dip, "dip_direction": towards, "through": [4.0, 3.0, 2.0]}
    found = blocks_of_scene(scene(one)).contacts
    normal = found.normal[0] * np.sign(found.normal[0, 2])
    across, turn = sin(radians(dip)), radians(towards)
    up = [across * sin(turn), across * cos(turn), cos(radians(dip))]
    assert len(found) == 1 and normal == pytest.approx(up, abs=1e-15)


def test_more_blocks_than_memory_are_refused_before_they_are_cut(scene):
    north = EAST | {"name": "north", "dip_direction": 0.0}
    small = [one | {"spacing": 1e-3} for one in (BED, EAST, north)]
    with pytest.raises(SceneError, match=r"spacing = 0.001: gives about 192,1.* available"):
        blocks_of_scene(scene(*small))


def test_periodic_sides_that_do_not_fit_are_refused(scene):
    """Beds along them do; dipping ones end at one side where no other begins."""
    periodic = dict.fromkeys(("left", "right", "front", "back"), "periodic")
    assert blocks_of_scene(scene(boundaries=periodic)).count == 4
    dipping = BED | {"dip": 10.0, "dip_direction": 90.0}
    said = r"boundaries\.left: is periodic, but a joint of 'bed'"
    with pytest.raises(SceneError, match=said) as error:
        blocks_of_scene(scene(dipping, boundaries=periodic))
    assert "\n" not in str(error.value)


def test_the_summary_counts_rigid_blocks(scene):
    """Of rock cut into cubes and into tetrahedra, which lack nothing of its stiffness."""
    fine = {"numerics": {"dem": {"block": 1.0}}}
    cubes, tetrahedra = (block_summary(scene(poisson=nu, **fine)) for nu in (0.0, 0.25))
    assert (cubes["blocks"], cubes["rigid_blocks"], tetrahedra["rigid_blocks"]) == (4, 192, 960)
    assert cubes["rigid_blocks_lack"] < 1e-6 and tetrahedra["rigid_blocks_lack"] < 1e-6
