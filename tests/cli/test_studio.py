"""``refcloud studio`` prints its address, serves it, and ends on a signal."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

from refcloud.cli import main
from refcloud.studio.choices import find_setup
from refcloud.studio.scene_file import scene_text


def test_it_serves_until_it_is_interrupted() -> None:
    command = [sys.executable, "-m", "refcloud", "studio", "--no-browser"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout is not None
            address = process.stdout.readline().strip()
            assert address.startswith("http://127.0.0.1:")
            opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
            with opener.open(address, timeout=30.0) as page:
                assert b"refcloud studio" in page.read()
            process.send_signal(signal.SIGTERM if os.name == "nt" else signal.SIGINT)
            _, err = process.communicate(timeout=30.0)
        finally:
            process.kill()
        assert process.returncode in (0, 130)
        assert "Traceback" not in err


@pytest.mark.parametrize(
    ("port", "line"),
    [("-1", "--port: expected"), ("70000", "--port: expected"), ("x", "--port:")],
)
def test_bad_ports_are_refused(port, line, run) -> None:
    status, out, err = run("studio", "--port", port, "--no-browser")
    assert (status, out) == (2, "")
    assert err.startswith(f"refcloud: {line}")


def test_a_taken_port_is_refused(run) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        status, out, err = run("studio", "--port", port, "--no-browser")
    assert (status, out) == (2, "")
    assert err.startswith("refcloud: --port: expected a port that is free, got")


def test_what_the_page_saves_is_drawn_by_render(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    setup = find_setup("man-10")
    file = tmp_path / "mine.toml"
    file.write_text(scene_text(setup, setup.taken({})), "utf-8")
    mine, named = str(tmp_path / "mine.png"), str(tmp_path / "named.png")
    size = ["--width", "48", "--height", "36"]
    assert main(["render", str(file), "-o", mine, *size]) == 0
    assert main(["render", "man-10", "-o", named, *size]) == 0
    assert main(["compare", mine, named, "--codes", "0", "--fraction", "0"]) == 0
    capsys.readouterr()
    assert main(["render", str(file), "--albedo", "0.5"]) == 2
    assert "brings its own" in capsys.readouterr().err
