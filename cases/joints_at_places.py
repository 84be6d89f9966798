"""Joints at given places (`pillar.joints`): segments without joints, and a soft layer per joint."""

import itertools
from collections.abc import Iterator
from math import ceil, sqrt
from typing import Any

from pydantic import ValidationError

from jointwave.cases.errors import SceneError
from jointwave.cases.loads import frequency_of
from jointwave.cases.schema.pulse import Load
from jointwave.cases.schema.tables import CONSTANTS, SPEEDS

BLOCKS = 40  # per wavelength of the load's highest frequency, where no block size is given
WITHOUT_LOAD = 100  # blocks of a pillar without a load


def spelled_out(scene: dict[str, Any], where: str, context: Any) -> dict[str, Any]:
    """Return the tables of a pillar with `pillar.joints` rewritten as segments and soft layers;
    unchanged if the key is absent or a value that it needs is invalid.

    where : name of the scene's source. context : of the validation, for files. Raises SceneError
    for the first contradiction with other tables.
    """
    pillar, rock, joints = (scene.get(key, {}) for key in ("pillar", "rock", "joints"))
    if not all(isinstance(one, dict) for one in (pillar, rock, joints)) or "joints" not in pillar:
        return scene
    places, length = pillar["joints"], pillar.get("length")
    layers = scene.get("soft_layers", [])
    own = [one.get("y") for one in layers if isinstance(one, dict)]
    if not isinstance(places, list) or not _positive(length, rock.get("density"), *places, *own):
        return scene
    for key, value, allowed in _contradictions(scene, places, length):
        raise SceneError(where, key, value, allowed)
    if not _positive(intact := rock["intact_modulus"]):
        return scene
    block = pillar.get("block") or _block(scene, sqrt(intact / rock["density"]), context)
    edges = [0.0, *sorted({*places, *own}), length]
    alike = [{"y": y} for y in places if y not in own]
    return scene | {
        "pillar": {"side": pillar.get("side"), "length": length, "block": _whole(length, block)},
        "segments": [
            {"y": [a, b], "joints": False, "block": _whole(b - a, block)}
            for a, b in itertools.pairwise(edges)
        ],
        "soft_layers": [*alike, *layers],
    }


def _contradictions(
    scene: dict[str, Any], places: list[float], length: float
) -> Iterator[tuple[str, object, str]]:
    rock, joints = scene["rock"], scene.get("joints", {})
    if not places or max(places) >= length or len({*places}) < len(places):
        yield "pillar.joints", places, f"must be different places between 0 and {length:g} m"
    if "intact_modulus" not in rock:
        yield "rock.intact_modulus", None, "is required with pillar.joints: the rock between them"
    for key in (*SPEEDS, *CONSTANTS):
        if key in rock:
            allowed = "leave it out: with pillar.joints the rock is rock.intact_modulus and joints"
            yield f"rock.{key}", rock[key], allowed
    if "normal_stiffness" not in joints and {*places} - {
        y["y"] for y in scene.get("soft_layers", [])
    }:
        yield "joints.normal_stiffness", None, "is required with pillar.joints"
    if "damping_ratio" in joints:
        allowed = "needs a block between joints: with pillar.joints give joints.viscosity"
        yield "joints.damping_ratio", joints["damping_ratio"], allowed
    for key in ("segments", "scatter"):
        if scene.get(key):
            yield key, None, "cannot be combined with pillar.joints"


def _positive(*values: Any) -> bool:
    return all(isinstance(one, int | float) and 0 < one < 1e30 for one in values)


def _whole(length: float, block: float) -> float:
    """Return the largest thickness of equal blocks, at most `block`, that fills a length, m."""
    return length / ceil(length / block * (1 - 1e-9))


def _block(scene: dict[str, Any], speed: float, context: Any) -> float:
    """Return the block size that resolves the load in rock of this bar speed (m/s), m."""
    try:
        load = Load.model_validate(scene.get("load"), context=context)
        frequency = frequency_of(load, scene["time"]["duration"])
    except (ValidationError, KeyError, TypeError, ZeroDivisionError):  # reported by validation
        frequency = None
    return speed / (BLOCKS * frequency) if frequency else scene["pillar"]["length"] / WITHOUT_LOAD
