"""Scene files as tests: each *.toml with an [expect] table, one test per variant and key.

`pytest my-scenes/` collects them. This module is loaded by every pytest run of the environment, so
what measures is imported when a scene is met; any other TOML file is left alone.
"""

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from jointwave.compare.cli import SceneWarning as SceneWarning

if TYPE_CHECKING:
    from jointwave.compare.cli.scene_tests import SceneFile

LARGEST_FILE = 10_000_000  # bytes, as of any scene
#: Of a pillar or a rock mass, and of what is tested; each as a table or as a key.
KEYS = "pillar|domain", r"(variants\.)?expect"


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "SceneFile | None":
    """Collect a TOML file that is a scene with [expect]."""
    if file_path.suffix != ".toml" or not _is_scene(file_path):
        return None
    from jointwave.compare.cli.scene_tests import SceneFile

    return SceneFile.from_parent(parent, path=file_path)


def _is_scene(path: Path) -> bool:
    """Return whether a file reads like a scene with an [expect] table, its own or a variant's; also
    with a typing error, which must not remove it from the tests."""
    try:
        if path.stat().st_size > LARGEST_FILE:
            return False
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError):
        return False
    begins = r"(^\s*\[?|[{,])\s*"
    return all(re.search(rf"{begins}({key})\b", text, re.MULTILINE) for key in KEYS)
