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
#: Patterns that a scene with tests contains, as table or key.
KEYS = "pillar|domain", r"(variants\.)?expect"


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "SceneFile | None":
    """Collect a TOML file that is a scene with [expect]."""
    if file_path.suffix != ".toml" or not _is_scene(file_path):
        return None
    from jointwave.compare.cli.scene_tests import SceneFile

    return SceneFile.from_parent(parent, path=file_path)


def _is_scene(path: Path) -> bool:
    """Return whether a file looks like a scene with [expect], its own or a variant's. A file with a
    syntax error counts, as it must not drop out of the tests."""
    try:
        if path.stat().st_size > LARGEST_FILE:
            return False
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError):
        return False
    begins = r"(^\s*\[?|[{,])\s*"
    return all(re.search(rf"{begins}({key})\b", text, re.MULTILINE) for key in KEYS)
