"""``refcloud studio`` prints its address, serves it, and ends on a signal."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import urllib.request

import pytest


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
