"""The command as tests of experiments run it."""

import sys

import pytest

from compare.cli.program import main


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    """Return a function that runs a command in an empty folder, in this process, and gives what it
    said; `code` is what it must end with."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments, code=0):
        monkeypatch.setattr(sys, "argv", ["jointwave", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        said = capsys.readouterr()
        assert ended.value.code == code and "Traceback" not in said.err, said.err
        return said

    return run
