"""What holds for every test: strict arithmetic, profiles, one way to renew pictures."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
import pytest
from hypothesis import settings

# Time is printed, never asserted: a busy machine must not fail a test. The built-in
# profile `ci` (under CI=1: the same examples each time, no deadline) stays as it is.
settings.register_profile("default", settings.get_profile("default"), deadline=None)
settings.register_profile("dev", max_examples=25, deadline=None)
settings.register_profile("deep", max_examples=2000, deadline=None, derandomize=False)


class StrictArithmetic:
    """Division by zero, overflow and invalid operations raise; underflow may happen."""

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self) -> Generator[None, object, object]:
        with np.errstate(divide="raise", over="raise", invalid="raise"):
            return (yield)


def pytest_configure(config: pytest.Config) -> None:
    # As a plugin it also holds for the doctests, which lie outside this folder.
    config.pluginmanager.register(StrictArithmetic(), "strict-arithmetic")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--regenerate",
        action="append",
        default=[],
        metavar="NAME",
        help="renew the golden picture of one scene; may be repeated; ends red",
    )


def pytest_collection_modifyitems(config: pytest.Config) -> None:
    if names := config.getoption("regenerate"):
        from golden_scenes import GOLDEN

        if unknown := sorted(set(names) - set(GOLDEN)):
            raise pytest.UsageError(f"--regenerate: no scene {', '.join(unknown)}")


def pytest_sessionfinish(session: pytest.Session) -> None:
    green = session.exitstatus == pytest.ExitCode.OK
    if green and session.config.getoption("regenerate"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
