"""From a TOML file to validated scenes: overrides, variants, and errors, a line a mistake.

A file with [pillar] holds a `Scene`, one with [domain] a `RockMass`.
"""

import re
from copy import deepcopy
from pathlib import Path
from typing import Any

from jointwave.cases.errors import SceneError, all_of, nearest
from jointwave.cases.files import parse_toml, read_toml
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.values import CONTROL
from jointwave.cases.validate import validated

LARGEST_FILE = 10_000_000  # bytes; a scene is a page of text
#: It names a folder, next to the names of the scene's own results.
VARIANT_NAME = re.compile(
    r"(?!.*(\.nc|\.pvd|\.bp|-fields)$)[^/\\.\s\x00-\x1f][^/\\\x00-\x1f]{0,79}", re.IGNORECASE
)

MOST_VARIANTS = 1000


def load(path: str | Path, overrides: dict[str, Any] | None = None) -> list[AnyScene]:
    """Read a scene file: the scene itself, then its variants, each validated on its own.

    `overrides` maps dotted keys to values (`--set`) and holds for every variant.
    Raises SceneError, a line a mistake, for anything that cannot be simulated.
    """
    path = Path(path)
    table, variants = _parts(_read_toml(path), path, overrides or {})
    given = frozenset(overrides or {})
    scenes: list[Any] = []
    wrong: list[SceneError] = []
    for i, variant in enumerate([{}, *variants]):
        try:
            merged = _variant(table, variant, path, i - 1, overrides or {}) if i else table
            scenes.append(validated(merged, path, given))
        except SceneError as error:
            wrong.append(error)
    if wrong:
        raise all_of(wrong)
    names = [scene.name for scene in scenes]
    for i, name in enumerate(names[1:]):
        if name in names[: i + 1]:
            raise SceneError(str(path), f"variants[{i}].name", name, "must be unique")
    return scenes


def load_variant(
    path: str | Path,
    name: str = "",
    overrides: dict[str, Any] | None = None,
    asked: bool = True,
) -> AnyScene:
    """Read one variant of a scene file, whatever the others are; the empty name is the scene as it
    stands.

    asked : whether the user gave the overrides, which may then name files anywhere.
    """
    given = frozenset(overrides or {}) if asked else frozenset()
    return _one(_read_toml(Path(path)), Path(path), name, overrides or {}, given)


def load_tables(
    tables: dict[str, Any], name: str = "", overrides: dict[str, Any] | None = None
) -> AnyScene:
    """Return one variant of a scene whose file would hold these tables.

    Files that it names lie in the working folder or below.
    """
    given = frozenset(overrides or {})
    return _one(deepcopy(tables), Path("scene"), name, overrides or {}, given)


def _one(
    whole: dict[str, Any], path: Path, name: str, overrides: dict[str, Any], given: frozenset[str]
) -> AnyScene:
    table, variants = _parts(whole, path, overrides)
    if not name:
        return validated(table, path, given)
    names = [variant.get("name") for variant in variants]
    if name not in names:
        known = sorted(map(str, names))
        allowed = f"must be one of {known}{nearest(name, known)}" if known else "the scene has none"
        raise SceneError(str(path), "variants.name", name, allowed)
    which = names.index(name)
    return validated(_variant(table, variants[which], path, which, overrides), path, given)


def _parts(
    table: dict[str, Any], path: Path, overrides: dict[str, Any]
) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return the table of a scene, changed, and those of its variants."""
    for key, value in overrides.items():
        _assign(table, key, value, str(path))
    if "name" in table:
        raise SceneError(str(path), "name", table["name"], "only [[variants]] take a name")
    variants = table.pop("variants", [])
    if not isinstance(variants, list) or not all(isinstance(v, dict) for v in variants):
        raise SceneError(str(path), "variants", variants, "must be [[variants]] tables")
    if len(variants) > MOST_VARIANTS:
        allowed = f"{len(variants):,} variants given; at most {MOST_VARIANTS:,}"
        raise SceneError(str(path), "variants", None, allowed)
    return table, variants


def parse_override(text: str) -> tuple[str, Any]:
    """Parse `key=value`; the value is read as TOML and, failing that, as a plain string."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise SceneError("--set", text, None, "must be key=value, e.g. joints.damping_ratio=0.05")
    try:
        return key.strip(), parse_toml(f"value = {value}")["value"]
    except (ValueError, RecursionError):
        return key.strip(), value


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        return read_toml(path, LARGEST_FILE)
    except ValueError as error:
        raise SceneError(str(path), "", None, str(error)) from None


def _variant(
    base: dict[str, Any], changes: dict[str, Any], path: Path, index: int, overrides: dict[str, Any]
) -> dict[str, Any]:
    name = changes.get("name")
    if not isinstance(name, str) or not VARIANT_NAME.fullmatch(name) or CONTROL.search(name):
        allowed = (
            "must be a string of up to 80 characters without '/' or control characters, not "
            "starting with '.' or ' ' nor ending in .nc, .pvd, .bp or -fields"
        )
        raise SceneError(str(path), f"variants[{index}].name", name, allowed)
    table = _merge(base, changes, f"variants[{index}]", str(path))
    for key, value in overrides.items():
        _assign(table, key, value, str(path))
    return table


def _merge(base: dict[str, Any], changes: dict[str, Any], key: str, where: str) -> dict[str, Any]:
    """Return a table with changes; `waves.0.kind` changes one table of a list."""
    merged = dict(base)
    for name, value in changes.items():
        old, inner = merged.get(name), f"{key}.{name}"
        if isinstance(old, dict) and isinstance(value, dict):
            value = _merge(old, value, inner, where)
        elif isinstance(old, list) and isinstance(value, dict):
            value = _merge_list(old, value, inner, where)
        merged[name] = value
    return merged


def _merge_list(base: list[Any], changes: dict[str, Any], key: str, where: str) -> list[Any]:
    merged = list(base)
    for part, value in changes.items():
        at, inner = _place(base, part, key, value, where), f"{key}.{part}"
        both = isinstance(base[at], dict) and isinstance(value, dict)
        merged[at] = _merge(base[at], value, inner, where) if both else value
    return merged


def _assign(table: dict[str, Any], key: str, value: Any, where: str) -> None:
    """Set a dotted key; the 0 of `soft_layers.0.y` is a place in a list of tables."""
    *parents, last = key.split(".")
    at: Any = table
    for parent in parents:
        place = _place(at, parent, key, value, where)
        inner = at.setdefault(parent, {}) if isinstance(at, dict) else at[place]
        if not isinstance(inner, dict | list):
            raise SceneError(where, key, value, f"is not a key: {parent} is not a table")
        at[place] = at = inner.copy()  # a caller's own table stays as it is
    at[_place(at, last, key, value, where)] = value


def _place(at: Any, part: str, key: str, value: Any, where: str) -> Any:
    """Return a part of a key as used in a table or list: a name, or a valid index."""
    if isinstance(at, dict):
        return part
    if not part.isdecimal() or int(part) >= len(at):
        allowed = f"{part} must be the number of an entry of the list, 0 to {len(at) - 1}"
        raise SceneError(where, key, value, allowed)
    return int(part)
