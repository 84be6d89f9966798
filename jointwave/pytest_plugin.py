"""Scene files as tests: each *.toml with an [expect] table, one test per variant and key.

`pytest my-scenes/` collects them. Every pytest run in the environment loads this module, so heavy
modules are imported only when a scene is found; other TOML files are ignored.
"""

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from jointwave.compare.cli import SceneWarning as SceneWarning

if TYPE_CHECKING:
    from jointwave.compare.cli.scene_tests import SceneFile

LARGEST_FILE = 10_000_000  # bytes, the limit of scene files
SCENES = "pillar", "domain"  # each scene has one of these tables


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "SceneFile | None":
    """Collect a TOML file that is a scene with [expect]."""
    if file_path.suffix != ".toml" or not _is_scene(file_path):
        return None
    from jointwave.compare.cli.scene_tests import SceneFile

    return SceneFile.from_parent(parent, path=file_path)


def _is_scene(path: Path) -> bool:
    """Return whether a file is a scene with [expect], its own or a variant's. A file with a syntax
    error that looks like one counts, as it must not drop out of the tests."""
    try:
        if path.stat().st_size > LARGEST_FILE:
            return False
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError):
        return False
    if "expect" not in text or not any(key in text for key in SCENES):
        return False
    from jointwave.cases.files import parse_toml

    try:
        tables = parse_toml(text)
    except (ValueError, RecursionError):
        keys = "|".join(SCENES), r"(variants\.)?expect"
        begins = r"(^\s*\[?|[{,])\s*"
        return all(re.search(rf"{begins}({key})\b", text, re.MULTILINE) for key in keys)
    variants = tables.get("variants")
    each = [tables, *(variants if isinstance(variants, list) else [variants])]
    expects = any(isinstance(one, dict) and "expect" in one for one in each)
    return expects and any(key in tables for key in SCENES)
