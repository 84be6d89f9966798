"""The versions of everything that computed and drew."""

import json
import platform
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version

from compare.misfit.pairs import Comparison

PACKAGES = ("scipy", "xarray", "obspy", "matplotlib", "plotly")


def versions(scenes: Iterable[list[Comparison]]) -> dict[str, str]:
    """Return them by name."""
    found = {"jointwave": _version("jointwave"), "Python": platform.python_version()}
    for comparisons in scenes:
        for result in comparisons[0].results.values():
            found |= json.loads(result.attrs.get("versions", "{}"))
    return found | {name: _version(name) for name in PACKAGES}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # run from its folder, not installed
        return "(not installed)"
