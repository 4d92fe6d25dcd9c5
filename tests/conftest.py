"""The command line, called in process, and the option that has every digit tried."""

import pytest

from atwood_cli.cli import run

from .running import Atwood, Ran


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--every-digit", action="store_true", help="Solve every scene of test_digits at every precision."
    )


@pytest.fixture
def atwood(capsys: pytest.CaptureFixture[str]) -> Atwood:
    def call(*arguments: str) -> Ran:
        status = run(list(arguments))
        return Ran(status, *capsys.readouterr())

    return call
