"""From a TOML file to validated scenes: overrides, variants, and errors in one line."""

import re
import tomllib
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cases.errors import SceneError
from cases.files import read_text
from cases.scene import Scene

LARGEST_FILE = 10_000_000  # bytes; a scene is a page of text
VARIANT_NAME = re.compile(r"[^/\\.\s\x00-\x1f][^/\\\x00-\x1f]{0,79}")  # it names a folder

#: What is allowed, by pydantic's type of error.
ALLOWED = {
    "contradiction": "{allowed}",
    "extra_forbidden": "unknown key; allowed: ",
    "missing": "is required",
    "model_type": "must be a table",
    "dict_type": "must be a table",
    "list_type": "must be a list",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "string_type": "must be a text",
    "bool_type": "must be true or false",
    "finite_number": "must be a finite number",
    "literal_error": "must be {expected}",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "less_than": "must be less than {lt:g}",
    "less_than_equal": "must be at most {le:g}",
    "too_short": "must hold {min_length} numbers",
    "too_long": "must hold {max_length} numbers",
    "magnitude": "must lie between 1e-30 and 1e30 in size",
    "pair": "{allowed}",
}


def load(path: str | Path, overrides: dict[str, Any] | None = None) -> list[Scene]:
    """Read a scene file: the scene itself, then its variants, each validated on its own.

    `overrides` maps dotted keys to values (`--set`) and holds for every variant.
    Raises SceneError, in one line, for anything that cannot be simulated.
    """
    path = Path(path)
    table, variants = _read(path, overrides or {})
    scenes = [_validate(table, path)]
    for i, variant in enumerate(variants):
        scenes.append(_variant(table, variant, path, i, overrides or {}))
    names = [scene.name for scene in scenes]
    for i, name in enumerate(names[1:]):
        if name in names[: i + 1]:
            raise SceneError(str(path), f"variants[{i}].name", name, "must be unique")
    return scenes


def load_variant(
    path: str | Path, name: str = "", overrides: dict[str, Any] | None = None
) -> Scene:
    """Read one variant of a scene file, whatever the others are; the empty name is the scene as it
    stands."""
    path = Path(path)
    table, variants = _read(path, overrides or {})
    if not name:
        return _validate(table, path)
    names = [variant.get("name") for variant in variants]
    if name not in names:
        known = sorted(str(n) for n in ["", *names])
        raise SceneError(str(path), "variants.name", name, f"must be one of {known}")
    which = names.index(name)
    return _variant(table, variants[which], path, which, overrides or {})


def _read(path: Path, overrides: dict[str, Any]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return the table of a scene, changed, and those of its variants."""
    table = _read_toml(path)
    for key, value in overrides.items():
        _assign(table, key, value, str(path))
    if "name" in table:
        raise SceneError(str(path), "name", table["name"], "only [[variants]] have a name")
    variants = table.pop("variants", [])
    if not isinstance(variants, list) or not all(isinstance(v, dict) for v in variants):
        raise SceneError(str(path), "variants", variants, "must be [[variants]] tables")
    return table, variants


def parse_override(text: str) -> tuple[str, Any]:
    """Parse `key=value`; the value is read as TOML and, failing that, as a plain string."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise SceneError("--set", text, None, "must be key=value, e.g. joints.damping_ratio=0.05")
    try:
        return key.strip(), tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return key.strip(), value


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        text = read_text(path, LARGEST_FILE)
    except ValueError as error:
        raise SceneError(str(path), "", None, str(error)) from None
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise SceneError(str(path), "", None, f"is not valid TOML: {error}") from None


def _variant(
    base: dict[str, Any], changes: dict[str, Any], path: Path, index: int, overrides: dict[str, Any]
) -> Scene:
    name = changes.get("name")
    if not isinstance(name, str) or not VARIANT_NAME.fullmatch(name):
        allowed = "must be a text of up to 80 characters without '/', not starting with '.' or ' '"
        raise SceneError(str(path), f"variants[{index}].name", name, allowed)
    table = _merge(base, changes)
    for key, value in overrides.items():
        _assign(table, key, value, str(path))
    return _validate(table, path)


def _validate(table: dict[str, Any], path: Path) -> Scene:
    where = f"{path} [{table['name']}]" if table.get("name") else str(path)
    try:
        scene = Scene.model_validate(table, context={"folder": path.parent})
    except ValidationError as error:
        raise _scene_error(where, error) from None
    scene._where = where
    return scene


def _scene_error(where: str, error: ValidationError) -> SceneError:
    first, more = error.errors()[0], error.error_count() - 1
    context = first.get("ctx", {})
    kind, value = first["type"], first["input"]
    key, allowed = _dotted(first["loc"]), ALLOWED.get(kind, first["msg"]).format(**context)
    if kind == "contradiction":
        key, value = context["key"], context["found"]
    elif kind == "extra_forbidden":
        allowed += _known_keys(first["loc"])
    elif kind == "list_type" and isinstance(value, dict):
        allowed = f"must be written [[{key}]]"
    if isinstance(value, dict) or kind == "missing":
        value = None
    more_text = f" (and {more} more)" if more else ""
    return SceneError(where, key, value, allowed + more_text)


def _known_keys(location: tuple[int | str, ...]) -> str:
    model: Any = Scene
    for part in location[:-1]:
        if isinstance(part, str):
            model = _table_of(model.model_fields[part].annotation)
    return ", ".join(k for k in model.model_fields if k != "name")


def _table_of(annotation: Any) -> Any:
    options = getattr(annotation, "__args__", (annotation,))
    return next(t for t in options if hasattr(t, "model_fields"))


def _dotted(location: tuple[int | str, ...]) -> str:
    text = ""
    for part in location:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def _merge(base: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in changes.items():
        old = merged.get(key)
        merged[key] = (
            _merge(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
        )
    return merged


def _assign(table: dict[str, Any], key: str, value: Any, where: str) -> None:
    *parents, last = key.split(".")
    for parent in parents:
        inner = table.setdefault(parent, {})
        if not isinstance(inner, dict):
            raise SceneError(where, key, value, f"is no key: {parent} is not a table")
        table[parent] = table = dict(inner)  # a caller's own table stays as it is
    table[last] = value
