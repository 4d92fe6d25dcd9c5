"""The command line, called in process."""

import pytest

from atwood_cli.cli import run

from .running import Atwood, Ran


@pytest.fixture
def atwood(capsys: pytest.CaptureFixture[str]) -> Atwood:
    def call(*arguments: str) -> Ran:
        status = run(list(arguments))
        return Ran(status, *capsys.readouterr())

    return call
