"""The pytest plugin: scene files with an [expect] table are tests."""

from jointwave.compare.cli.pytest_plugin import SceneWarning, pytest_collect_file

__all__ = ["SceneWarning", "pytest_collect_file"]
