"""A scene as the text of a scene file."""

import json
from typing import Any

from cases.kinds import AnyScene


def scene_text(scene: AnyScene) -> str:
    """Return a scene as the text of a scene file, defaults left out."""
    told = scene.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    told.pop("name", None)
    return "\n".join(_lines("", told)) + "\n"


def _lines(path: str, table: dict[str, Any]) -> list[str]:
    """Return a table's own keys, then the tables in it under headings."""
    inner = {k: v for k, v in table.items() if isinstance(v, dict)}
    many = {k: v for k, v in table.items() if isinstance(v, list) and v and isinstance(v[0], dict)}
    lines = [
        f"{_key(k)} = {_value(v)}" for k, v in table.items() if k not in inner and k not in many
    ]
    for key, one in inner.items():
        name = f"{path}{_key(key)}"
        lines += ["", f"[{name}]", *_lines(f"{name}.", one)]
    for key, several in many.items():
        name = f"{path}{_key(key)}"
        for one in several:
            lines += ["", f"[[{name}]]", *_lines(f"{name}.", one)]
    return lines


def _key(name: str) -> str:
    return name if name.replace("_", "").isalnum() and name.isascii() else _value(name)


def _value(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    # JSON's texts and numbers are TOML's, but for one control character.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
