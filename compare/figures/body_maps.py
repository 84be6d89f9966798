"""A quantity over a body, as it is seen, of the snapshots of one result or more."""

import json
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely
import xarray as xr

from jointwave.cases.effects import is_spatial
from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import names, solver
from jointwave.compare.figures.animation.bodies import Body, body_of
from jointwave.compare.figures.animation.settings import (
    PEAK,
    PRINCIPAL,
    SLIP,
    SPEED,
    STRESS,
    Quantity,
    settings_for,
)
from jointwave.compare.figures.drawing.bodies import seen
from jointwave.results.snapshots import snapshots_of

#: By name; a pillar's stress is that along it.
QUANTITIES = {"ppv": PEAK, "speed": SPEED, "stress": PRINCIPAL, "slip": SLIP}
#: Tables that decide no geometry, and a load over time instead of one whose file is not at hand.
ASIDE = ("waves", "loads", "boundaries", "gravity", "prestress", "expect")
LOAD = dict.fromkeys(("cycles", "rise", "decay", "file"))
LOAD |= {"shape": "sine", "amplitude": 1.0, "period": 1.0}
PIECES = 150  # of joints, across the body
CLOSE = 1e-6  # of the body: beside a joint, and between two sizes of one body


class Map(NamedTuple):
    """A quantity over a body as it is seen, places in m to the right and up.

    corners : of the faces [faces, corners, 2]. joints : in pieces [pieces, 2, 2]. values : of the
    faces or, for slip, of the joints' pieces, in the unit of the quantity. time : s, of the
    snapshot; None for a peak over all.
    """

    corners: np.ndarray
    joints: np.ndarray
    values: np.ndarray
    time: float | None
    quantity: Quantity

    @property
    def sizes(self) -> np.ndarray:
        """The areas (m2) of the faces, or lengths (m) of the joints' pieces, that have values."""
        if self.quantity == SLIP:
            return _lengths(self.joints)
        return shapely.area(shapely.polygons(self.corners))


def scene_of(result: xr.Dataset) -> AnyScene:
    """Return the scene of a result, without what acts on it."""
    tables = json.loads(result.attrs["scene"])
    tables = {key: value for key, value in tables.items() if key not in ASIDE}
    tables["record"]["fields"] = None
    if "domain" in tables:
        if "point_z" in result.coords:
            allowed = "is of bodies in the plane: animate and view show a scene in space"
            raise SceneError(tables["title"], "map", None, allowed)
        return RockMass.model_validate(tables)
    return Scene.model_validate(tables | {"load": tables["load"] | LOAD})


def maps_of(
    scene: AnyScene, results: Sequence[xr.Dataset], quantity: str, time: float | None = None
) -> dict[str, Map]:
    """Return the maps of results of one body by their names; raises SceneError as `plot_map`."""
    shown = QUANTITIES.get(quantity)
    if shown is None:
        allowed = f"must be one of {', '.join(QUANTITIES)}"
        raise SceneError(scene.title, "map", quantity, allowed)
    if shown == PEAK and time is not None:
        why = "is of one instant, ppv the largest of all: choose speed, stress or slip"
        raise SceneError(scene.title, "time", time, why)
    if scene.is_column and shown == PRINCIPAL:
        shown = STRESS
    found: dict[str, Map] = {}
    for result, name in zip(results, _names(results), strict=True):
        found[name] = one = _map(scene, result, shown, time)
        time = time if one.time is None else one.time
    ends = [(one.corners.min((0, 1)), one.corners.max((0, 1))) for one in found.values()]
    for end in ends[1:]:
        if not np.allclose(ends[0], end, rtol=0.0, atol=CLOSE * np.ptp(ends[0])):
            raise SceneError(scene.title, "", None, "the two results are of different bodies")
    return found


def _names(results: Sequence[xr.Dataset]) -> list[str]:
    """Return what results are called: by their solvers, of equal ones also by variant or number."""
    engines, variants = ([str(one.attrs[key]) for one in results] for key in ("engine", "variant"))
    found = [solver(name).label if name in names() else name for name in engines]
    for more in (variants, [str(k + 1) for k in range(len(found))]):
        if len(set(found)) < len(found):
            found = [", ".join(filter(None, both)) for both in zip(found, more, strict=True)]
    return found


def _map(scene: AnyScene, result: xr.Dataset, quantity: Quantity, time: float | None) -> Map:
    """Return the map of a result's snapshots, of the one nearest to a time."""
    s = snapshots_of(result)
    if s is None or (s.stress is None and quantity in (STRESS, PRINCIPAL)):
        why = "is needed for a map: the result has no snapshots"
        raise SceneError(scene.title, "record.fields", None, why)
    settings = settings_for(scene, {"": s})._replace(scale=1.0, stretch=1.0, quantity=quantity)
    body = body_of(s, scene, settings).front()
    corners, joints = body.rest[body.faces][..., [0, 2]], _joints(scene)
    values = body.values
    if quantity == SLIP:
        if not len(joints) or (scene.is_column and not is_spatial(scene)):
            why = "is of joints along which something moves; this body has none"
            raise SceneError(scene.title, "map", "slip", why)
        recorded = "field_slip" in result
        slip = _recorded_slip(result, joints) if recorded else _slip(body, corners, joints)
        values = quantity.factor * slip
    found = Map(corners, joints, values[0], None, quantity)
    if quantity == PEAK:
        return found
    if time is None:
        i = int((values**2 @ found.sizes).argmax())
    else:
        i = int(np.abs(s.time - time).argmin())
        if abs(s.time[i] - time) > (s.time[-1] - s.time[0]) / max(1, len(s.time) - 1):
            allowed = f"must be from {s.time[0]:g} to {s.time[-1]:g} s"
            raise SceneError(scene.title, "time", time, allowed)
    return found._replace(values=values[i], time=float(s.time[i]))


def _joints(scene: AnyScene) -> np.ndarray:
    """Return the joints of a scene as they are seen, in pieces [n, 2, 2], m."""
    blocks, turn = seen(scene)
    sets = 1 + len(scene.soft_layers) if scene.is_column else len(scene.joint_sets)
    ends = blocks.contacts.ends[blocks.contacts.of_joints(sets)][..., turn]
    longest = float(np.ptp(blocks.outlines.corners, axis=0).max()) / PIECES
    lines = shapely.segmentize(shapely.linestrings(ends), longest)
    places, line = shapely.get_coordinates(lines, return_index=True)
    return np.stack([places[:-1], places[1:]], axis=1)[line[1:] == line[:-1]]


def _lengths(pieces: np.ndarray) -> np.ndarray:
    return np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1)


def _recorded_slip(result: xr.Dataset, joints: np.ndarray) -> np.ndarray:
    """Return the size of the slip that a result has of joints, m [snapshots, pieces]: that of rigid
    blocks is without the strain of the rock, which parts the blocks as well."""
    tree = shapely.STRtree(shapely.linestrings(result["field_joints"].values[..., :2]))
    nearest = tree.query_nearest(shapely.points(joints.mean(axis=1)), all_matches=False)[1]
    return np.abs(result["field_slip"].values[:, nearest])


def _slip(body: Body, corners: np.ndarray, joints: np.ndarray) -> np.ndarray:
    """Return the size of the displacement along joints of one side against the other, m [snapshots,
    pieces]; that of a face is read as linear between its corners."""
    along = (joints[:, 1] - joints[:, 0]) / _lengths(joints)[:, None]
    normal = np.stack([-along[:, 1], 0 * along[:, 0], along[:, 0]], axis=1)  # right, away, up
    beside = CLOSE * np.ptp(corners) * normal[:, [0, 2]]
    moved = []
    for at in (joints.mean(axis=1) - beside, joints.mean(axis=1) + beside):
        face = _nearest(corners, at)
        middle = corners[face].mean(axis=1, keepdims=True)
        slopes = np.linalg.pinv(corners[face] - middle)  # [n, 2, corners]
        weights = 1 / corners.shape[1] + np.einsum("nd,ndk->nk", at - middle[:, 0], slopes)
        moved.append(np.einsum("tnkc,nk->tnc", body.motion[:, body.faces[face]], weights))
    jump = moved[1] - moved[0]
    opening = np.einsum("tnc,nc->tn", jump, normal)[..., None] * normal
    return np.linalg.norm(jump - opening, axis=2)


def _nearest(corners: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the faces that points [n, 2] are in."""
    tree = shapely.STRtree(shapely.polygons(corners))
    return tree.query_nearest(shapely.points(at), all_matches=False)[1]


def difference(one: Map, other: Map) -> Map:
    """Return the second map less the first, on the faces of the one that has more."""
    if one.quantity == SLIP:
        return one._replace(values=other.values - one.values)
    if len(one.corners) <= len(other.corners):
        there = one.values[_nearest(one.corners, other.corners.mean(axis=1))]
        return other._replace(values=other.values - there)
    there = other.values[_nearest(other.corners, one.corners.mean(axis=1))]
    return one._replace(values=there - one.values)
