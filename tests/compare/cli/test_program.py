"""The entry of the command."""

import os
import subprocess
import sys

INTERRUPTED = """
import sys

class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == "typer":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupting())
from jointwave.compare.cli.program import main
main()
"""


def test_ctrl_c_while_the_program_is_imported_is_one_line():
    done = subprocess.run((sys.executable, "-c", INTERRUPTED), capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "jointwave: interrupted\n"


COLORAMA = """
__version__ = "1.0"

class Fore:
    def __getattr__(self, name):
        return ""

Fore = Style = Fore()

def init(*args, **more):
    print("colours")

reinit = deinit = init
"""

MESSAGE = """
import sys
from jointwave.compare.cli.program import main

sys.argv = ["jointwave", "--version"]
try:
    main()
except SystemExit:
    from numba.core.errors import termcolor
    print(termcolor().errmsg("a message"))
"""


def test_messages_of_numba_are_not_coloured(tmp_path):
    """colorama would append an escape sequence to all terminal output, also JSON."""
    (tmp_path / "colorama.py").write_text(COLORAMA)
    done = subprocess.run(
        (sys.executable, "-c", MESSAGE),
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert "colours" not in done.stdout and done.stdout.endswith("a message\n")
