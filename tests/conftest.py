"""The command line, called in process, and the option that has every example tried."""

import gc
import os
import signal
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from atwood_cli.cli import run

from .tools.running import HEARD, HOW_TO_PRINT, Atwood, Batch, Ran

# No test fails where a machine is slow.
ANYWHERE = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.function_scoped_fixture]
settings.register_profile("every-digit", deadline=None, suppress_health_check=ANYWHERE)
settings.register_profile("usual", settings.get_profile("every-digit"), max_examples=25)
settings.register_profile("quick", settings.get_profile("every-digit"), max_examples=3)
SLOW = "arrays bounds contact explain fit fuzz help kills parquet pictures sweep terminal ties tradeoff uncertainty".split()
"""What --quick leaves out, with all pictures: transcripts and doors see most faults that these see, and sooner."""


def many(most: int) -> int:
    """That many with --every-digit, a quarter of them usually, and three in a hundred with --quick."""
    return most * settings().max_examples // 100


def examples(most: int) -> settings:
    """So many examples of what Hypothesis draws."""
    return settings(max_examples=max(1, many(most)))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--every-digit", action="store_true", help="Try all scenes, rows and examples, not a quarter of them."
    )
    parser.addoption("--quick", action="store_true", help="Try few of them, and leave out what is slow.")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    return True if config.getoption("quick") and collection_path.stem.removeprefix("test_") in SLOW else None


def pytest_configure(config: pytest.Config) -> None:
    """What the suite starts depends on nothing that a shell has set: PYTHONUNBUFFERED hides what users meet."""
    profiles = [name for name in ("every-digit", "quick") if config.getoption(name.replace("-", "_"))]
    settings.load_profile(next(iter(profiles), "usual"))
    told = [name for name in os.environ if name.startswith("PYTHON") and name != "PYTHONPATH"]
    for name in {*told, *HOW_TO_PRINT} & {*os.environ}:
        del os.environ[name]
    # An ignored signal, as under nohup, would be ignored by children; a handled one is not.
    for name in HEARD:
        if (number := getattr(signal, name, None)) and signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, lambda *_: None)


def pytest_collection() -> None:
    gc.disable()


def pytest_collection_finish() -> None:
    """Imported modules are not searched for garbage, and formulas, which have no circles, seldom."""
    gc.freeze()
    gc.enable()
    gc.set_threshold(20_000, 5, 2)


@pytest.fixture
def atwood(capsys: pytest.CaptureFixture[str]) -> Atwood:
    def call(*arguments: str) -> Ran:
        status = run(list(arguments))
        return Ran(status, *capsys.readouterr())

    return call


@pytest.fixture
def batch(atwood: Atwood, tmp_path: Path) -> Batch:
    """Run `atwood batch` on a file with that content; in messages the file is called IN, and OUT is another."""

    def call(content: bytes | str, words: str = "", name: str = "in.csv") -> Ran:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        ran = atwood("batch", str(path), *words.replace("OUT", str(tmp_path / "out")).split())
        return ran._replace(err=ran.err.replace(str(path), "IN"))

    return call
