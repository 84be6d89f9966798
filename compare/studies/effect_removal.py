"""Scenes without one of their effects."""

from typing import Any

from jointwave.cases.effects import SIDES
from jointwave.cases.errors import SceneError
from jointwave.cases.material.properties import SLIP
from jointwave.cases.scene_type import Either
from jointwave.cases.schema.damping import Attenuating
from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.validate import checked

ALONG = (*SLIP, *(key for part in PARTS if part.along for key in part.all_keys))
#: By effect, the tables and keys that leave it out of a scene; `joints` are all its joints.
WITHOUT: dict[str, dict[str, Any]] = {
    "dashpots": {"damping": {"rayleigh": None}, "joints": {"damping_ratio": None}},
    "no tension": {"joints": {"tension": None}},
    "joints that differ": {"soft_layers": []},
    "scatter": {"scatter": None},
    "segments": {"segments": []},
    **{f"{kind} ends": {"ends": kind} for kind in ("quiet", "matched", "fixed")},
    **{f"{kind} sides": {"boundaries": kind} for kind in SIDES},
    "energy ledger": {"record": {"energy": False}},
    "field output": {"record": {"fields": None}},
    "finite rotation": {"motion": {"rotation": "small"}},
    "slip": {"joints": dict.fromkeys(ALONG)},
    **{part.name: {"joints": dict.fromkeys(part.all_keys)} for part in PARTS},
    "mass damping": {"damping": {"mass_proportional": None, "rayleigh": None}},
    "constant Q": {"rock": dict.fromkeys(Attenuating.model_fields)},
    "local damping": {"damping": {"local": None}},
    "gravity": {"gravity": None},
    "prestress": {"prestress": None},
}


def left_out(scene: Either, name: str) -> Either:
    """Return a scene without one of its effects; raises SceneError if there is no such scene."""
    if name not in WITHOUT:
        raise SceneError(scene.where, name, None, "is the subject of the scene")
    changes = dict(WITHOUT[name])
    if law := changes.pop("joints", None):
        changes |= dict.fromkeys(scene.law_tables, law)
    tables = {key: _changed(getattr(scene, key), change) for key, change in changes.items()}
    changed: Any = scene.model_copy(update=tables)
    return checked(changed)


def _changed(table: Any, change: Any) -> Any:
    """Return a table, or each of a list, with keys changed; without its ends, or sides, of a kind;
    or what is in its place."""
    if isinstance(change, str):
        return table.model_copy(update={name: "free" for name, kind in table if kind == change})
    if not isinstance(change, dict):
        return change
    if isinstance(table, list):
        return [one.model_copy(update=change) for one in table]
    return table.model_copy(update=change)
