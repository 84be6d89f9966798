"""Shell completion of shipped scenes and studies, variants, keys and models; the shell itself
completes files.

Called at every press of the tab key: nothing heavy is imported, and errors are silent.
"""

import os
from collections.abc import Iterable
from contextlib import suppress

import typer

from jointwave.cases.files import read_toml
from jointwave.compare.scenes import find, names
from jointwave.compare.studies import IN_CODE, SHIPPED

LARGEST_FILE = 1_000_000  # bytes: larger files take too long to read at a key press


def scenes(incomplete: str) -> list[str]:
    """Return shipped scenes."""
    return _begun(names(), incomplete)


def variants(context: typer.Context, incomplete: str) -> list[str]:
    """Return the variants of the scene that is named before."""
    # An option that lacks its value leaves the arguments before it unread.
    unread = [text for text in context.args if not text.startswith("-")]
    scene = context.params.get("scene") or next(iter(unread), "")
    with suppress(OSError, ValueError, TypeError, LookupError):
        tables = read_toml(find(scene), LARGEST_FILE)["variants"]
        found = [name for one in tables if str(name := one["name"]).isprintable()]
        return [one.replace(" ", "\\ ") if _is_bash() else one for one in _begun(found, incomplete)]
    return []


def settings(incomplete: str) -> list[str]:
    """Return keys of a scene, `KEY=`."""
    from jointwave.cases.schema.keys import keys

    known = [key for key, _ in keys() if not key.startswith(("soft_layers.", "segments."))]
    found = _begun([f"{key}=" for key in known], incomplete)
    # bash ends the word where only one fits, so offer a second.
    return [*found, f"{found[0]}VALUE"] if _is_bash() and len(found) == 1 else found


def models(incomplete: str) -> list[str]:
    """Return models of the continuum and exact solutions."""
    from jointwave.compare.runs.jobs import models_known

    return _begun(models_known(), incomplete)


def studies(incomplete: str) -> list[str]:
    """Return shipped studies."""
    return _begun([*sorted(path.stem for path in SHIPPED.glob("*.toml")), *IN_CODE], incomplete)


def _is_bash() -> bool:
    return os.environ.get("_JOINTWAVE_COMPLETE") == "complete_bash"


def _begun(known: Iterable[str], incomplete: str) -> list[str]:
    return [one for one in known if one.startswith(incomplete)]
