"""Lists the packages: the folder `dem` is installed as `jointwave.dem` (see pyproject.toml)."""

from setuptools import find_packages, setup

PARTS = ("cases", "results", "numerics", "joints", "dem", "continuum", "compare")
BELOW = [
    name for part in PARTS for name in (part, *(f"{part}.{one}" for one in find_packages(part)))
]
setup(packages=["jointwave", *(f"jointwave.{name}" for name in BELOW)])
