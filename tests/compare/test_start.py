"""The way in to the command."""

import subprocess
import sys

INTERRUPTED = """
import sys

class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == "typer":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupting())
from compare.start import main
main()
"""


def test_ctrl_c_while_the_program_is_imported_is_one_line():
    done = subprocess.run((sys.executable, "-c", INTERRUPTED), capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "jointwave: interrupted\n"
