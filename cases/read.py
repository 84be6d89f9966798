"""Read a TOML file into validated scenes: overrides, variants, and one error line per mistake.

A file with [pillar] holds a `Scene`, one with [domain] a `RockMass`.
"""

import re
from collections.abc import Iterable, Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

from jointwave.cases.errors import SceneError, all_of, nearest
from jointwave.cases.files import parse_toml, read_toml
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.values import CONTROL
from jointwave.cases.validate import validated

LARGEST_FILE = 10_000_000  # bytes; a scene is a page of text
#: A variant names a folder next to the scene's own result files.
VARIANT_NAME = re.compile(
    r"(?!.*(\.nc|\.pvd|\.bp|-fields)$)[^/\\.\s\x00-\x1f][^/\\\x00-\x1f]{0,79}", re.IGNORECASE
)
NAMES = (
    "must be a string of up to 80 characters without '/' or control characters, not starting with "
    "'.' or ' ' nor ending in .nc, .pvd, .bp or -fields"
)
NO_VARIANTS = "the scene has none"
MOST_VARIANTS = 1000


def load(path: str | Path, overrides: dict[str, Any] | None = None) -> list[AnyScene]:
    """Read a scene file: the scene itself, then its variants, each validated on its own.

    `overrides` maps dotted keys to values (`--set`) for every variant. Raises SceneError, one line
    per mistake, for anything that cannot be simulated.
    """
    tables = _of_file(path, overrides)
    scenes: list[AnyScene] = []
    wrong: list[SceneError] = []
    for k in range(-1, len(tables.variants)):
        try:
            scenes.append(tables.scene(k))
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
    path: str | Path, name: str = "", overrides: dict[str, Any] | None = None, asked: bool = True
) -> AnyScene:
    """Read one variant of a scene file without validating the others; "" is the scene itself.

    asked : whether the user gave the overrides, which may then name files anywhere.
    """
    return _of_file(path, overrides, asked).named(name)


def load_tables(
    tables: dict[str, Any], name: str = "", overrides: dict[str, Any] | None = None
) -> AnyScene:
    """Return one variant of a scene from the tables of its file, or of a result. Files that it
    names lie in the working folder or below."""
    return _Tables(deepcopy(tables), Path("scene"), overrides or {}).named(name)


class _Tables:
    """The tables of a scene and its variants, and the overrides of each.

    asked : whether the user gave the overrides.
    """

    def __init__(
        self, table: dict[str, Any], path: Path, overrides: dict[str, Any], asked: bool = True
    ) -> None:
        _override(table, overrides, path)
        variants = table.pop("variants", [])
        if not isinstance(variants, list) or not all(isinstance(v, dict) for v in variants):
            raise SceneError(str(path), "variants", variants, "must be [[variants]] tables")
        if len(variants) > MOST_VARIANTS:
            allowed = f"{len(variants):,} variants given; at most {MOST_VARIANTS:,}"
            raise SceneError(str(path), "variants", None, allowed)
        self.base, self.path, self.variants, self.overrides = table, path, variants, overrides
        self.asked = frozenset(overrides if asked else ())

    def named(self, name: str) -> AnyScene:
        """Return the variant with a name; "" is the scene itself."""
        names = [variant.get("name") for variant in self.variants]
        if name and name not in names:
            known = sorted(map(str, names))
            some = f"must be '' (the base scene) or one of {', '.join(known)}{nearest(name, known)}"
            allowed = some if names else NO_VARIANTS
            raise SceneError(str(self.path), "variants.name", name, allowed)
        return self.scene(names.index(name) if name else -1)

    def scene(self, index: int) -> AnyScene:
        """Return the variant with an index; -1 is the scene itself."""
        table, key = dict(self.base), f"variants[{index}]." if index >= 0 else ""
        for parts, value in _leaves(self.variants[index], table) if key else ():
            _assign(table, parts, value, key + ".".join(parts), self.path)
        _override(table, self.overrides if key else {}, self.path)
        name = table.get("name")
        known = isinstance(name, str) and VARIANT_NAME.fullmatch(name) and not CONTROL.search(name)
        if not known and (key or name):
            raise SceneError(str(self.path), f"{key}name", name, NAMES)
        return validated(table, self.path, self.asked)


def _of_file(path: str | Path, overrides: dict[str, Any] | None, asked: bool = True) -> _Tables:
    path, overrides = Path(path), overrides or {}
    try:
        table = read_toml(path, LARGEST_FILE)
    except ValueError as error:
        raise SceneError(str(path), "", None, str(error)) from None
    if (name := (table | overrides).get("name")) is not None:
        raise SceneError(str(path), "name", name, "only [[variants]] take a name")
    return _Tables(table, path, overrides, asked)


def parse_override(text: str) -> tuple[str, Any]:
    """Parse `key=value`; parts of the key may be quoted, a value that is not TOML is a string."""
    key, equals, value = text.partition("=")
    key = re.sub("[\"']", "", key)
    if not equals or not key.strip():
        raise SceneError("--set", text, None, "must be key=value, e.g. joints.damping_ratio=0.05")
    try:
        return key.strip(), parse_toml(f"value = {value}")["value"]
    except (ValueError, RecursionError):
        return key.strip(), value


def _leaves(changes: dict[str, Any], base: Any, above: tuple[str, ...] = ()) -> Iterator[tuple]:
    """Yield the changes that a table makes to another as (names down to the key), value."""
    for name, value in changes.items():
        old = base.get(name) if isinstance(base, dict) else None
        if isinstance(value, dict) and (value or isinstance(old, dict)):
            yield from _leaves(value, old, (*above, name))
        else:
            yield (*above, name), value


def _override(table: dict[str, Any], overrides: dict[str, Any], path: Path) -> None:
    for key, value in overrides.items():
        parts = re.sub(r"\[(\d+)\]", r".\1", key).split(".")  # soft_layers[0].y, as in messages
        _assign(table, parts, value, key, path)


def _assign(table: dict[str, Any], parts: Iterable[str], value: Any, key: str, path: Path) -> None:
    """Set a key in nested tables; the 0 of `soft_layers.0.y` is an index into a list."""
    at: Any = table
    *parents, last = parts
    for parent in parents:
        place = _place(at, parent, key, value, path)
        inner = at.setdefault(parent, {}) if isinstance(at, dict) else at[place]
        if not isinstance(inner, dict | list):
            raise SceneError(str(path), key, value, f"is not a key: {parent} is not a table")
        at[place] = at = inner.copy()  # a caller's own table stays as it is
    at[_place(at, last, key, value, path)] = value


def _place(at: Any, part: str, key: str, value: Any, path: Path) -> Any:
    """Return one part of a key as a table's name or a valid list index."""
    if isinstance(at, dict):
        return part
    if not part.isdecimal() or int(part) >= len(at):
        entries = f"0 to {len(at) - 1}" if at else "which is empty"
        allowed = f"{part} must be the number of an entry of the list, {entries}"
        raise SceneError(str(path), key, value, allowed)
    return int(part)
