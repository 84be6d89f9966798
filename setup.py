"""A built distribution has all packages below one name: `cases` becomes `jointwave._lib.cases`.

In the repository they stand side by side, as one reads them; installed under names as common as
`cases` and `compare` they would collide with anybody's. An editable install is left as it is.
"""

import re
import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

PACKAGES = ("cases", "results", "numerics", "joints", "dem", "continuum", "compare")
BELOW = "jointwave._lib"
NAMES = "|".join(PACKAGES)
#: Both forms of an absolute import of ours; an `import a.b` without `as` is not one we write.
FROM = re.compile(rf"^(\s*from )({NAMES})(?=[. ])", re.MULTILINE)
IMPORT = re.compile(rf"^(\s*)import ({NAMES})$", re.MULTILINE)


class BelowOneName(build_py):
    """The build of all packages, moved below one name when they are copied."""

    def run(self) -> None:
        """Copy the packages, then move and rewrite the copies."""
        super().run()
        if self.editable_mode:
            return
        root = Path(self.build_lib)
        target = root / Path(*BELOW.split("."))
        shutil.rmtree(target, ignore_errors=True)
        target.mkdir(parents=True)
        (target / "__init__.py").write_text('"""What jointwave is made of."""\n')
        for package in PACKAGES:
            shutil.move(root / package, target / package)
        for source in root.rglob("*.py"):
            text = source.read_text(encoding="utf-8")
            source.write_text(below(text), encoding="utf-8")


def below(text: str) -> str:
    """Return a source whose imports of our packages are from below the one name."""
    return IMPORT.sub(rf"\1from {BELOW} import \2", FROM.sub(rf"\1{BELOW}.\2", text))


setup(cmdclass={"build_py": BelowOneName})
