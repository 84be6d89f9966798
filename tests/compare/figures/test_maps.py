"""Maps of whole bodies: what they show against the results, on one scale, in words and colours."""

from math import nan

import meshio
import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from scipy.spatial import Delaunay

import jointwave as jw
from jointwave.compare.figures.body_maps import difference, maps_of, scene_of
from jointwave.compare.figures.charts.maps import draw_maps, peak_velocities
from jointwave.compare.figures.section import Section, cut_cells
from jointwave.compare.misfit.pairs import Comparison
from jointwave.results.snapshots import snapshots, snapshots_of

SET = {"spacing": 1.0, "normal_stiffness": 1e12, "shear_stiffness": 4e11}
WAVE = {"kind": "P", "direction": [0.0, 1.0], "shape": "ricker", "period": 0.01}
SQUARES = {
    "title": "a wave",
    "domain": {"size": [4.0, 6.0]},
    "rock": {"density": 2500.0, "intact_modulus": 4e10, "intact_poisson": 0.0},
    "joint_sets": [SET | {"name": str(dip), "dip": dip} for dip in (0.0, 90.0)],
    "waves": [WAVE | {"amplitude": 0.2, "quantity": "velocity"}],
    "boundaries": {"left": "free", "right": "free", "bottom": "quiet", "top": "quiet"},
    "time": {"duration": 0.03},
    "record": {"points": [[2.5, 2.5]], "fields": 5e-4},
}
SHEARED = {"waves.0.kind": "S"}  # along the level joints


@pytest.fixture(scope="module")
def results():
    """Return a P wave up through square blocks, by both engines."""
    scene = jw.load(SQUARES)
    return scene, jw.simulate(scene), jw.simulate(scene, "continuum-jointed")


@pytest.fixture(scope="module")
def sheared():
    scene = jw.load(SQUARES, changes=SHEARED)
    return scene, jw.simulate(scene)


@pytest.fixture(scope="module")
def blow():
    """Return a short row of blocks in space that is struck obliquely."""
    changes = {"pillar.length": 10.0, "record": {"velocity": [5.25], "fields": 2e-3}}
    scene = jw.load("beyond/eccentric-blow", changes=changes | {"time.duration": 0.02})
    return scene, jw.simulate(scene)


CUBES = {
    "title": "a wave in space",
    "domain": {"size": [4.0, 3.0, 6.0], "openings": [[[1.0, 1.0, 2.0], [2.0, 2.0, 4.0]]]},
    "rock": SQUARES["rock"],
    "joint_sets": [
        SET | {"name": "bed", "dip": 0.0},
        SET | {"name": "east", "dip": 90.0, "dip_direction": 90.0},
        SET | {"name": "north", "dip": 90.0, "dip_direction": 0.0},
    ],
    "loads": [
        {"kind": "pressure", "side": "top", "shape": "ricker", "period": 0.01, "amplitude": 1e6}
    ],
    "boundaries": {"bottom": "quiet"},
    "time": {"duration": 0.02},
    "record": {"points": [[3.5, 0.5, 2.5]], "joints": [[3.5, 0.5, 2.0]], "fields": 5e-4},
}


@pytest.fixture(scope="module")
def space():
    """Return a P wave up through cubes around a box, by both engines."""
    scene = jw.load(CUBES)
    return scene, jw.simulate(scene), jw.simulate(scene, "continuum-jointed")


def drawn(figure):
    """Return the axes of maps by title, and those of colour bars by label."""
    axes = {ax.get_title(loc="left"): ax for ax in figure.axes if ax.get_title(loc="left")}
    bars = {ax.get_xlabel(): ax for ax in figure.axes if not ax.get_title(loc="left")}
    return axes, bars


def shapes_of(figure, name, kind=PolyCollection):
    """Return the coloured shapes of a map."""
    return next(one for one in drawn(figure)[0][name].collections if isinstance(one, kind))


def distance(places, at):
    return np.hypot(*(places - at).T)


def test_the_ppv_is_the_peak_of_each_block(results, ink):
    """Of every cell the mean over its nodes, as by `ppv_map`. At the receiver that of its waveform:
    a peak of omega = 2 pi / T is missed by (omega dt)^2/8 at most between snapshots. Cells fill the
    domain; the page has their numbers."""
    scene, blocks, _ = results
    (found,) = maps_of(scene, [blocks], "ppv").values()
    here = np.abs(found.corners.mean(axis=1) - [2.5, 2.5]).max(axis=1) < 0.5
    missed = (2 * np.pi / 0.01 * scene.record.fields) ** 2 / 8
    peak = np.hypot(*blocks.velocity.values[0].T).max()
    assert found.values[here] == pytest.approx(peak, rel=2 * missed) and found.values.min() > 0.18
    assert found.sizes.sum() == pytest.approx(24.0, rel=1e-12)
    figure, s = jw.plot_map(blocks), snapshots_of(blocks)
    faces = shapes_of(figure, "rigid blocks")
    expected = jw.ppv_map(blocks).values[s.cells].mean(axis=1)
    np.testing.assert_allclose(faces.get_array(), expected, rtol=1e-12)
    corners = np.array([path.vertices[:3] for path in faces.get_paths()])
    np.testing.assert_allclose(corners, s.points[s.cells, :2])
    axes, bars = drawn(figure)
    assert list(bars) == ["peak particle velocity (m/s)"]
    assert axes["rigid blocks"].get_aspect() == 1.0
    (shown,) = peak_velocities("wave", [Comparison(scene, {"dem": blocks})])
    assert shown.table["peak velocity (m/s)"].max() == pytest.approx(0.2, rel=0.05)
    assert ink(shown.figure) > 0.05


def test_two_engines_share_a_scale_beside_their_difference(results, collisions):
    """The difference is the second less the first, on the smaller cells."""
    scene, blocks, rock = results
    figure = jw.plot_map(blocks, "speed", rock, time=0.015)
    axes, bars = drawn(figure)
    names = ["rigid blocks", "jointed rock", "jointed rock − rigid blocks"]
    assert list(axes) == names and len(bars) == 2 and collisions(figure) == []
    one, other, less = (shapes_of(figure, name) for name in names)
    assert one.get_clim() == other.get_clim() and less.get_clim()[0] == -less.get_clim()[1]
    assert one.get_clim()[1] >= max(one.get_array().max(), other.get_array().max()) / 1.25
    assert len(less.get_array()) == len(other.get_array()) > len(one.get_array())
    place = np.array([path.vertices[:4].mean(axis=0) for path in other.get_paths()])
    here = distance(place, [2.5, 2.5]).argmin()
    of_block = blocks.velocity.sel(time=0.015, method="nearest").values[0]
    expected = other.get_array()[here] - np.hypot(*of_block)
    assert less.get_array()[here] == pytest.approx(expected, abs=1e-3)
    swapped = difference(*reversed(maps_of(scene, [blocks, rock], "speed", 0.015).values()))
    np.testing.assert_allclose(np.sort(-swapped.values), np.sort(less.get_array()), atol=1e-15)


def test_without_a_time_the_strongest_snapshot_is_shown(results):
    _, blocks, _ = results
    figure = jw.plot_map(blocks, "stress")
    squares = (blocks.field_stress.sel(stress_component="yy").values ** 2).mean(axis=1)
    strongest = int(squares.argmax())
    assert f"at {1e3 * blocks.field_time.values[strongest]:.4g} ms" in figure.get_suptitle()
    shown = shapes_of(figure, "rigid blocks").get_array()
    yy = 1e-6 * blocks.field_stress.values[strongest, :, 1]
    np.testing.assert_allclose(shown, yy, atol=0.01 * np.abs(yy).max())  # the wave's is uniaxial


def test_slip_is_the_jump_along_joints(sheared, collisions):
    """That of receivers on a level and on an upright joint, and what is drawn."""
    scene, blocks = sheared
    (one,) = maps_of(scene, [blocks], "slip", 0.015).values()
    places = [[2.5, 2.0], [2.0, 3.5]]
    recorded = jw.load(SQUARES, changes=SHEARED | {"record.joints": places})
    slip = jw.simulate(recorded).slip.sel(time=0.015, method="nearest").values
    here = [distance(one.joints.mean(axis=1), place).argmin() for place in places]
    assert one.values[here] == pytest.approx(1e3 * np.abs(slip), rel=0.02)
    twice = difference(one, one._replace(values=2 * one.values))
    np.testing.assert_array_equal(twice.values, one.values)
    figure = jw.plot_map(blocks, "slip", time=0.015)
    assert collisions(figure) == []
    lines = shapes_of(figure, "rigid blocks", LineCollection)
    np.testing.assert_allclose(np.sort(lines.get_array()), np.sort(one.values))


def test_a_pillar_in_space_is_seen_from_the_front(blow):
    """Its blocks from end to end, thickness as drawn; the stress is that along it."""
    scene, blocks = blow
    figure = jw.plot_map(blocks, "stress", time=0.01)
    faces = shapes_of(figure, "rigid blocks")
    i = int(np.abs(blocks.field_time.values - 0.01).argmin())
    np.testing.assert_allclose(faces.get_array(), 1e-6 * blocks.field_stress.values[i])
    ends = [path.vertices[:, 0] for path in faces.get_paths()]
    assert np.min(ends) == pytest.approx(0.0) and np.max(ends) == pytest.approx(10.0)
    assert list(drawn(figure)[1]) == ["axial stress (MPa), compression positive"]
    (slipped,) = maps_of(scene, [blocks], "slip").values()
    assert len(slipped.values) % 19 == 0 and slipped.values.max() > 0
    assert len(np.unique(slipped.joints[..., 0].round(9))) == 19


def test_few_large_values_are_clipped_and_counted(results, collisions):
    """One cell of many at ten times the others: an arrow, and its share of the area in words."""
    scene, _, rock = results
    (one,) = maps_of(scene, [rock], "ppv").values()
    one = one._replace(corners=np.tile(one.corners, (10, 1, 1)))
    values = np.full(len(one.corners), 0.1)
    values[7] = 1.0
    figure = draw_maps({"a": one._replace(values=values)}, scene)
    (bar,) = drawn(figure)[1]
    share = 100 * one.sizes[7] / one.sizes.sum()
    assert bar == f"peak particle velocity (m/s)\n{share:.2g} % of the area is beyond"
    faces = shapes_of(figure, "a")
    assert faces.get_clim() == (0.0, pytest.approx(0.1))
    assert faces.get_cmap().colorbar_extend == "max"
    assert collisions(figure) == []


def test_a_result_has_its_figures(results, sheared, blow, collisions):
    """`result.jw`: a panel of waveforms for each component that moves, and maps, on which two of
    one engine have numbers."""
    _, blocks, rock = results
    titles = [ax.get_title(loc="left") for ax in blocks.jw.plot(rock).figure.axes]
    assert any("velocity y at [2.5, 2.5] m" in title for title in titles)
    assert blow[1].jw.plot(width=90).get_figwidth() == pytest.approx(90 / 25.4)
    figure = blocks.jw.plot_map("speed", sheared[1])
    titles = [title.replace("\n", " ") for title in drawn(figure)[0]]
    assert titles == ["rigid blocks, 1", "rigid blocks, 2", "rigid blocks, 2 − rigid blocks, 1"]
    assert collisions(figure) == []


def test_what_cannot_be_drawn_is_said_in_one_line(results, blow, space):
    (_, blocks, _), (_, cubes, _) = results, space
    bar = jw.simulate(jw.load("guo-li-2002/fig-03", changes={"record.fields": 1e-3}))
    for result, arguments, said in (
        (blocks, ("heat",), "map = 'heat': must be one of ppv, speed, stress, slip"),
        *(
            (blocks, ("speed", None, t), f"time = {t}: must be from 0 to 0.03 s")
            for t in (9.0, nan)
        ),
        (blocks, ("ppv", None, 0.01), "ppv the largest of all"),
        (blocks, ("ppv", blow[1]), "different bodies"),
        (blocks, ("ppv", blocks.drop_vars("field_cells")), "record.fields: is needed for a map"),
        (bar, ("slip",), "map = 'slip': is of joints along which something"),
        (blocks, ("ppv", None, None, "y=1"), "section = 'y=1': is of a rock mass in space"),
        (cubes, ("ppv", None, None, "1"), 'must be an axis and a place in m, as "y=25"'),
        (cubes, ("ppv", None, None, "z=7"), "section = 'z=7': must be from 0 to 6 m"),
    ):
        with pytest.raises(jw.SceneError, match=said):
            jw.plot_map(result, *arguments)


def test_a_rock_mass_in_space_is_cut(space, collisions):
    """Along y through the box, or where it is asked for: its area less the box's. At the receiver
    the peak of its waveform, missed between snapshots as above."""
    scene, *results = space
    for section, axes, area in (
        (None, ("x", "z"), 24.0 - 2.0),
        ("y=0", ("x", "z"), 24.0),
        ("x=4", ("y", "z"), 18.0),
        ("z=2.5", ("x", "y"), 12.0 - 1.0),
    ):
        for one in maps_of(scene, results, "ppv", section=section).values():
            assert one.axes == axes and one.sizes.sum() == pytest.approx(area, rel=1e-9)
    (front, _) = maps_of(scene, results, "ppv", section="y=0.5").values()
    here = np.abs(front.corners.mean(axis=1) - [3.5, 2.5]).max(axis=1) < 0.5
    peak = np.linalg.norm(results[0].velocity.values[0], axis=1).max()
    missed = (2 * np.pi / 0.01 * scene.record.fields) ** 2 / 8
    assert here.any() and front.values[here] == pytest.approx(peak, rel=2 * missed)
    figure = jw.plot_map(results[0], "stress", results[1], section="y=1.5")
    assert "section y = 1.5 m" in figure.get_suptitle() and collisions(figure) == []
    assert list(drawn(figure)[0])[2] == "jointed rock − rigid blocks"


def test_a_section_of_any_cells_is_exact_for_linear_motion():
    """Of a box in random tetrahedra or sheared hexahedra: its area, and the motion at its nodes."""
    rng = np.random.default_rng(5)
    x = np.stack(np.meshgrid(*3 * [np.linspace(0, 1, 4)], indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(64).reshape(4, 4, 4)
    low, high = slice(None, -1), slice(1, None)
    corners = [(low, low), (high, low), (high, high), (low, high)]
    boxes = [number[i, j, k].ravel() for k in (low, high) for i, j in corners]
    moved = x + 0.1 * np.prod(np.sin(np.pi * x), axis=1)[:, None] * rng.normal(size=3)
    tetra = Delaunay(moved).simplices
    for kind, points, cells in (
        ("hexahedron", x @ np.array([[1, 0.3, 0], [0, 1, 0], [0, 0, 1]]), np.stack(boxes, axis=1)),
        ("tetra", moved, tetra),
    ):
        u = points @ rng.normal(size=(3, 3))
        body = snapshots([0.0], points, kind, cells, np.zeros(len(cells)), u[None], 2 * u[None])
        for axis, at in ((0, 0.41), (1, 0.73), (2, 0.2)):
            cut = cut_cells(body, Section(axis, at, 0.0))
            a, b, c = np.moveaxis(cut.points[cut.cells], 1, 0)
            area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
            assert area == pytest.approx(1.0, rel=1e-12)
            np.testing.assert_allclose(cut.points[:, axis], at, atol=1e-12)
            own = cut.points @ np.linalg.lstsq(points, u, rcond=None)[0]
            np.testing.assert_allclose(cut.displacement[0], own, atol=1e-12)
            np.testing.assert_allclose(cut.velocity, 2 * cut.displacement, atol=1e-12)


def test_slip_in_space_is_along_the_joint_whatever_the_section():
    """A joint that dips at 60 degrees to 70: the slip of its receiver, in both sections there."""
    joint = SET | {"name": "one", "dip": 60.0, "dip_direction": 70.0, "through": [2.0, 2.0, 2.0]}
    joint |= {"spacing": None, "normal_stiffness": 2e10, "shear_stiffness": 8e9}
    tables = CUBES | {"domain": {"size": [4.0, 4.0, 4.0]}, "joint_sets": [joint]}
    record = {"joints": [[2.0, 2.0, 2.0]], "fields": 5e-4}
    scene = jw.load(tables | {"record": record, "numerics": {"continuum": {"size": 1.0}}})
    rock = jw.simulate(scene, "continuum-jointed")
    slip = np.linalg.norm(rock.slip.values[0], axis=1)
    time = float(rock.time[slip.argmax()])
    for section in ("y=2", "z=2"):
        (one,) = maps_of(scene, [rock], "slip", time, section).values()
        here = distance(one.joints.mean(axis=1), [2.0, 2.0]).argmin()
        assert one.values[here] == pytest.approx(1e3 * slip.max(), rel=0.03)


def test_blocks_of_a_file_are_found_from_any_folder(tmp_path, monkeypatch):
    """They are read from the scene's folder, whatever the current one, while they are there."""
    corners = [[x, y, z] for z in (0.0, 1.0, 2.0) for y in (0.0, 1.0) for x in (0.0, 1.0)]
    cells = [[4 * k + i for i in (0, 1, 3, 2, 4, 5, 7, 6)] for k in range(2)]
    (tmp_path / "scene").mkdir()
    meshio.write(tmp_path / "scene" / "two.vtu", meshio.Mesh(corners, [("hexahedron", cells)]))
    tables = CUBES | {"domain": {"blocks": "two.vtu"}, "joint_sets": CUBES["joint_sets"][:1]}
    record = {"points": [[0.5, 0.5, 1.5]], "fields": 5e-3}
    monkeypatch.chdir(tmp_path / "scene")
    blocks = jw.simulate(jw.load(tables | {"record": record}))
    monkeypatch.chdir(tmp_path)
    (one,) = maps_of(scene_of(blocks), [blocks], "ppv").values()
    assert one.sizes.sum() == pytest.approx(2.0) and blocks.jw.plot().axes
    (tmp_path / "scene" / "two.vtu").unlink()
    with pytest.raises(jw.SceneError, match=r"domain.blocks = .*two.vtu': is not there any more"):
        jw.plot_map(blocks)
