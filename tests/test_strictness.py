"""The rules of conftest.py hold: wrong arithmetic and warnings are errors."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

ROOT = Path(__file__).parent.parent
WRONG = [
    lambda: np.ones(1) / np.zeros(1),
    lambda: np.full(1, 1e300) * 1e300,
    lambda: np.full(1, np.inf) - np.inf,
    lambda: np.sqrt(np.full(1, -1.0)),
]


@pytest.mark.parametrize("wrong", WRONG)
def test_wrong_arithmetic_raises(wrong) -> None:
    with pytest.raises(FloatingPointError):
        wrong()


@given(st.sampled_from(WRONG))
def test_wrong_arithmetic_raises_in_generated_tests(wrong) -> None:
    with pytest.raises(FloatingPointError):
        wrong()


def test_underflow_may_happen() -> None:
    assert np.exp(np.full(1, -1e4)) == 0.0, "light behind a thick cloud"


def test_warnings_are_errors() -> None:
    with pytest.raises(UserWarning, match="look"):
        warnings.warn("look", stacklevel=1)


def test_profiles() -> None:
    assert settings.get_profile("dev").max_examples == 25
    assert settings.get_profile("deep").max_examples == 2000
    assert not settings.get_profile("deep").derandomize
    assert settings.get_profile("ci").derandomize
    assert settings.get_profile("ci").deadline is None


def test_doctests_and_renewals_keep_to_the_rules(tmp_path: Path) -> None:
    """Run a small project of its own with this conftest.py: each rule ends it red."""
    (tmp_path / "tests").mkdir()
    (tmp_path / "package").mkdir()
    rules = (ROOT / "tests" / "conftest.py").read_text("utf-8")
    (tmp_path / "tests" / "conftest.py").write_text(rules, "utf-8")
    (tmp_path / "tests" / "golden_scenes.py").write_text("GOLDEN = {'a': None}")
    (tmp_path / "tests" / "test_a.py").write_text("def test_a(): pass")
    fine = '"""\n>>> 1\n1\n"""\n'
    (tmp_path / "package" / "a.py").write_text(fine)
    options = "addopts = --doctest-modules --import-mode=importlib"
    places = "testpaths = tests package\npythonpath = tests\n"
    (tmp_path / "pytest.ini").write_text(f"[pytest]\n{options}\n{places}")

    def run(*extra: str) -> tuple[int, str]:
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *extra],
            cwd=tmp_path,
            env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
            capture_output=True,
            text=True,
            check=False,
        )
        return done.returncode, done.stdout + done.stderr

    assert run()[0] == pytest.ExitCode.OK
    assert run("--regenerate", "a")[0] == pytest.ExitCode.TESTS_FAILED
    code, text = run("--regenerate", "b")
    assert code == pytest.ExitCode.USAGE_ERROR
    assert "--regenerate: no scene b" in text
    wrong = '"""\n>>> import numpy as np\n>>> np.ones(1) / 0\narray([inf])\n"""\n'
    (tmp_path / "package" / "a.py").write_text(wrong)
    code, text = run()
    assert code == pytest.ExitCode.TESTS_FAILED
    assert "FloatingPointError" in text
