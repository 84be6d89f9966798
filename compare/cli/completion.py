"""Shell completion of variants, keys, models and studies; typer keeps those that a word begins.

Called at every press of the tab key: nothing heavy is imported, and errors are silent.
"""

import os
from contextlib import suppress

import typer

from jointwave.cases.files import read_toml
from jointwave.compare.scenes import find
from jointwave.compare.studies import IN_CODE, SHIPPED

LARGEST_FILE = 1_000_000  # bytes: larger files take too long to read at a key press


def variants(context: typer.Context) -> list[str]:
    """Return the variants of the scene that is named before."""
    # An option that lacks its value leaves the arguments before it unread.
    unread = [text for text in context.args if not text.startswith("-")]
    scene = context.params.get("scene") or next(iter(unread), "")
    space = "\\ " if os.environ.get("_JOINTWAVE_COMPLETE") == "complete_bash" else " "
    with suppress(OSError, ValueError, TypeError, LookupError):
        names = [str(one["name"]) for one in read_toml(find(scene), LARGEST_FILE)["variants"]]
        return [name.replace(" ", space) for name in names if name.isprintable()]
    return []


def settings() -> list[str]:
    """Return keys of a scene, `KEY=`."""
    from jointwave.cases.schema.keys import keys

    return [f"{key}=" for key, _ in keys() if not key.startswith(("soft_layers.", "segments."))]


def models() -> list[str]:
    """Return models of the continuum and exact solutions."""
    from jointwave.compare.runs.jobs import models_known

    return models_known()


def studies() -> list[str]:
    """Return shipped studies."""
    return [*sorted(path.stem for path in SHIPPED.glob("*.toml")), *IN_CODE]
