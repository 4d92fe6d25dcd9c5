"""The command line, called in process, and the option that has every digit tried."""

import os

import pytest
from hypothesis import HealthCheck, settings

from atwood_cli.cli import run

from .running import Atwood, Ran

# No test fails where a machine is slow.
ANYWHERE = [HealthCheck.too_slow, HealthCheck.function_scoped_fixture]
settings.register_profile("anywhere", deadline=None, suppress_health_check=ANYWHERE)
settings.load_profile("anywhere")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--every-digit", action="store_true", help="Try every scene and row that is kept: every digit."
    )


def pytest_configure() -> None:
    """What the suite starts is not told how Python is to run: PYTHONUNBUFFERED hides what users meet."""
    for name in [name for name in os.environ if name.startswith("PYTHON") and name != "PYTHONPATH"]:
        del os.environ[name]


@pytest.fixture
def atwood(capsys: pytest.CaptureFixture[str]) -> Atwood:
    def call(*arguments: str) -> Ran:
        status = run(list(arguments))
        return Ran(status, *capsys.readouterr())

    return call
