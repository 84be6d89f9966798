"""Shell completion: scenes, variants, keys with their values, models, studies.

Called at every key press: nothing heavy is imported, and errors are silent.
"""

import os
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import typer

from cases.files import read_toml
from compare.experiments import IN_CODE
from compare.scenes import find, names

LARGEST_FILE = 1_000_000  # bytes: larger files take too long to read at a key press


def scenes(incomplete: str) -> list[str]:
    """Return shipped scenes and scene files that begin so."""
    return [*_begun(names(), incomplete), *files(incomplete)]


def files(incomplete: str, suffix: str = ".toml") -> list[str]:
    """Return files of a kind that begin so, and the folders on the way to them."""
    folder, begun = os.path.split(incomplete)
    try:
        found = sorted(Path(folder or ".").iterdir())
    except OSError:
        return []
    wanted = [p for p in found if p.name.startswith(begun) and (begun or p.name[0] != ".")]
    return [
        os.path.join(folder, path.name) + ("/" if path.is_dir() else "")
        for path in wanted
        if path.is_dir() or path.suffix == suffix
    ]


def variants(context: typer.Context, incomplete: str) -> list[str]:
    """Return the variants of the scene that is named before."""
    # An option that lacks its value leaves the arguments before it unread.
    unread = [text for text in context.args if not text.startswith("-")]
    scene = context.params.get("scene") or next(iter(unread), "")
    with suppress(OSError, ValueError):
        tables = read_toml(find(scene), LARGEST_FILE).get("variants")
        return _quoted(_begun(_names(tables), incomplete))
    return []


def settings(incomplete: str) -> list[str]:
    """Return keys of a scene, `KEY=`; once the key is there its values, where they are few."""
    from cases.schema.keys import keys

    known = {
        key: field for key, field in keys() if not key.startswith(("soft_layers.", "segments."))
    }
    key, equals, _ = incomplete.partition("=")
    if not equals:
        found = _begun([f"{key}=" for key in known], incomplete)
        # After the only word that fits bash puts a space; it does not between two.
        return [*found, f"{found[0]}VALUE"] if _is_bash() and len(found) == 1 else found
    values = _values(known[key].annotation) if key in known else []
    return _begun([f"{key}={value}" for value in values], incomplete)


def models(incomplete: str) -> list[str]:
    """Return models of the continuum and exact solutions."""
    from compare.runs.jobs import models_known

    return _begun(models_known(), incomplete)


def studies(incomplete: str) -> list[str]:
    """Return shipped studies and study files."""
    shipped = Path(__file__).parents[1] / "experiments" / "study" / "shipped"
    known = sorted(path.stem for path in shipped.glob("*.toml"))
    return [*_begun([*known, *IN_CODE], incomplete), *files(incomplete)]


def _names(tables: Any) -> list[str]:
    """Return the names of variants, not validated, as far as a terminal can show them."""
    found = tables if isinstance(tables, list) else []
    names = [one.get("name") for one in found if isinstance(one, dict)]
    return [name for name in names if isinstance(name, str) and name.isprintable()]


def _values(kind: Any) -> list[str]:
    if kind is bool:
        return ["true", "false"]
    if get_origin(kind) is Literal:
        return [str(value) for value in get_args(kind)]
    return [value for part in get_args(kind) for value in _values(part)]


def _quoted(found: list[str]) -> list[str]:
    """Return names as a shell takes them for one word; all but bash see to that themselves."""
    return [one.replace(" ", "\\ ") for one in found] if _is_bash() else found


def _is_bash() -> bool:
    return os.environ.get("_JOINTWAVE_COMPLETE") == "complete_bash"


def _begun(known: list[str], incomplete: str) -> list[str]:
    return [one for one in known if one.startswith(incomplete)]
