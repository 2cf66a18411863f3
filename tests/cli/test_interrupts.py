"""Ctrl-C at any moment: one line and status 130, and no child tells its own story."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import refcloud as rc
from refcloud import interrupts, processes
from refcloud.cli import entry, main

ROOT = Path(__file__).parents[2]
# What pip writes for an entry of [project.scripts].
SCRIPT = """import sys
from refcloud.cli import main
if __name__ == "__main__":
    sys.exit(main())
"""
STRUCK = "import signal, time\nsignal.raise_signal(signal.SIGINT)\ntime.sleep(60)\n"
LINE = b"refcloud: interrupted\n"


@pytest.fixture
def struck(tmp_path: Path) -> dict[str, str]:
    """Give surroundings in which Ctrl-C comes while numpy is imported."""
    (tmp_path / "first" / "numpy").mkdir(parents=True)
    (tmp_path / "first" / "numpy" / "__init__.py").write_text(STRUCK)
    return {**os.environ, "PYTHONPATH": f"{tmp_path / 'first'}{os.pathsep}{ROOT}"}


def ended(words: list[str], surroundings: dict[str, str]) -> tuple[int, bytes, bytes]:
    done = subprocess.run(
        [sys.executable, *words], env=surroundings, capture_output=True, check=False
    )
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("name", ["refcloud", "-m"])
def test_an_interrupt_of_the_imports_is_one_line(name, struck, tmp_path) -> None:
    script = tmp_path / "refcloud"
    script.write_text(SCRIPT)
    words = ["-m", "refcloud"] if name == "-m" else [str(script)]
    for rest in (["list"], ["--help"]):
        assert ended([*words, *rest], struck) == (130, b"", LINE)


def test_another_program_is_interrupted_as_ever(struck, tmp_path) -> None:
    script = tmp_path / "other.py"
    script.write_text(
        "try:\n    import refcloud\nexcept KeyboardInterrupt:\n    pass\n"
    )
    assert ended([str(script)], struck) == (0, b"", b"")


def test_an_interrupt_after_the_command_is_one_line(tmp_path) -> None:
    script = tmp_path / "refcloud"
    after = "main()\n    import signal\n    signal.raise_signal(signal.SIGINT)\n"
    script.write_text(SCRIPT.replace("sys.exit(main())\n", after))
    surroundings = {**os.environ, "PYTHONPATH": str(ROOT)}
    status, _, err = ended([str(script), "--version"], surroundings)
    assert (status, err) == (130, LINE)


def struck_now() -> str:
    signal.raise_signal(signal.SIGINT)
    return ""


def test_the_command_leaves_a_program_its_own_handler(capsys, monkeypatch) -> None:
    def own(number: int, stack: object) -> None:
        pass

    before = signal.signal(signal.SIGINT, own)
    try:
        assert main(["--version"]) == 0
        assert signal.getsignal(signal.SIGINT) is own
        signal.signal(signal.SIGINT, interrupts.end)
        monkeypatch.setattr(entry, "_overview", struck_now)
        assert main(["--help"]) == interrupts.STATUS
        assert signal.getsignal(signal.SIGINT) is interrupts.end
    finally:
        signal.signal(signal.SIGINT, before)
    out, err = capsys.readouterr()
    assert (out, err) == (f"refcloud {rc.__version__}\n", LINE.decode())


@pytest.mark.skipif(os.name == "nt", reason="nothing is inherited there")
def test_children_ignore_interrupts_from_their_first_moment(monkeypatch) -> None:
    monkeypatch.setattr(processes, "_ignore_interrupts", int)  # which does nothing
    before = signal.getsignal(signal.SIGINT)
    with processes.workers(1) as pool:
        there = pool.submit(signal.getsignal, signal.SIGINT).result()
    assert there == signal.SIG_IGN
    assert signal.getsignal(signal.SIGINT) is before
