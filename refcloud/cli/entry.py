"""The door of the command line: picks the command, and words every failure."""

from __future__ import annotations

import contextlib
import importlib
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from types import ModuleType
from typing import NoReturn

import numpy as np

import refcloud
from refcloud import interrupts
from refcloud.cli.outputs import STDOUT, printable, say, to_stdout
from refcloud.cli.wording import as_typed
from refcloud.paths import LONGEST_NAME
from refcloud.refusal import complaint

# Each command is a file of this room, imported when it is asked for.
COMMANDS = {
    "generate": "refcloud.cli.generate",
    "approximate": "refcloud.cli.approximate",
    "render": "refcloud.cli.render",
    "figure": "refcloud.cli.figure",
    "animate": "refcloud.cli.animate",
    "scene": "refcloud.cli.scene",
    "compare": "refcloud.cli.compare",
    "list": "refcloud.cli.scenes",
    "noise": "refcloud.cli.noise",
    "bench": "refcloud.cli.bench",
    "studio": "refcloud.cli.studio",
}
BAD_INPUT = 2
# As a shell counts them: 128 and the number of the signal (SIGINT, SIGPIPE, SIGTERM).
INTERRUPTED, PIPE_CLOSED, TERMINATED = interrupts.STATUS, 141, 143
DEFECT = 70  # EX_SOFTWARE of sysexits.h: not the caller's fault


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and give its exit status.

    0 is success, 1 that compared pictures differ, 2 bad input, 130 an
    interrupt, 143 a request to terminate. A
    failure is one line on stderr.
    """
    words = list(sys.argv[1:] if argv is None else argv)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by the caller
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))
    try:
        # What overflows is refused in one line, not warned about.
        with (
            _interrupted(),
            _terminated(),
            np.errstate(divide="raise", over="raise", invalid="raise"),
        ):
            status = _run(words)
        with to_stdout():
            sys.stdout.flush()
        return status
    except SystemExit as end:  # help was printed
        return _flushed(int(end.code or 0))
    except BrokenPipeError:
        _abandon_stdout()
        return PIPE_CLOSED
    except KeyboardInterrupt as end:
        ended = isinstance(end, _Terminated)
        line = "terminated" if ended else "interrupted"
        line = "; ".join([line, *map(str, end.args)])
        return _fail(TERMINATED if ended else INTERRUPTED, line)
    except MemoryError:
        got = "more than this machine has free"
        advice = "choose a smaller picture, larger voxels or fewer balls"
        return _fail(BAD_INPUT, complaint("memory", "what fits", got, advice))
    except ArithmeticError as error:
        advice = "choose values nearer to the defaults"
        expected = "numbers that stay finite"
        return _fail(BAD_INPUT, complaint("arithmetic", expected, f"{error}", advice))
    except OSError as error:
        if error.strerror is None:
            return _fail(BAD_INPUT, str(error))
        return _failed_at(error)
    except (ValueError, TypeError) as error:
        return _fail(BAD_INPUT, str(error))
    except Exception as error:
        kind = type(error).__name__
        return _fail(DEFECT, f"defect: {kind}: {error}; please report this command")


def _run(words: list[str]) -> int:
    name, *rest = words or [""]
    if name in ("-h", "--help"):
        say(_overview())
        return 0
    if name == "--version":
        say(f"refcloud {refcloud.__version__}")
        return 0
    if name not in COMMANDS:
        expected = "one of " + ", ".join(COMMANDS)
        got = repr(name[:60]) if words else "none"
        advice = "see refcloud --help"
        raise ValueError(complaint("command", expected, got, advice))
    module = _module(name)
    try:
        return module.run(rest)
    except (ValueError, TypeError) as refusal:
        command = getattr(module, "command", None)
        if command is None:
            raise
        raise ValueError(as_typed(str(refusal), command().flags)) from None


def _module(name: str) -> ModuleType:
    return importlib.import_module(COMMANDS[name])


def _overview() -> str:
    """List the commands with what each of them does."""
    lines = ["usage: refcloud COMMAND [options]", "", refcloud.__doc__ or "", ""]
    width = max(map(len, COMMANDS))
    lines += [f"  {name:{width}}  {_module(name).ABOUT}" for name in COMMANDS]
    return "\n".join([*lines, "", "refcloud COMMAND --help gives a command's options."])


class _Terminated(KeyboardInterrupt):
    """A request to terminate, which ends a command as Ctrl-C does."""


@contextlib.contextmanager
def _interrupted() -> Iterator[None]:
    """Let Ctrl-C raise KeyboardInterrupt where it ended the program at once before."""
    ours = signal.getsignal(signal.SIGINT) is interrupts.end
    if ours:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        if ours:
            signal.signal(signal.SIGINT, interrupts.end)


@contextlib.contextmanager
def _terminated() -> Iterator[None]:
    """Let a request to terminate clear up behind what it ends."""

    def end(number: int, stack: object) -> NoReturn:
        raise _Terminated

    try:
        before = signal.signal(signal.SIGTERM, end)
    except ValueError:  # not in the main thread
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _fail(status: int, line: str) -> int:
    """Print one line on stderr, whatever the message holds."""
    with contextlib.suppress(OSError, ValueError):
        line = printable("refcloud: " + " ".join(line.split()), sys.stderr)
        print(line, file=sys.stderr, flush=True)
    return status


def _flushed(status: int) -> int:
    try:
        with to_stdout():
            sys.stdout.flush()
    except BrokenPipeError:
        _abandon_stdout()
        return PIPE_CLOSED
    except OSError as error:
        return _failed_at(error)
    return status


def _failed_at(error: OSError) -> int:
    """Say which file could not be read or written, or that stdout could not."""
    reason = error.strerror or str(error)
    if error.filename == STDOUT:
        _abandon_stdout()
        expected = "to write the results there"
        return _fail(BAD_INPUT, complaint(STDOUT, expected, reason))
    if error.filename is None:
        expected = "it to do what the command asks"
        return _fail(BAD_INPUT, complaint("system", expected, reason))
    name = os.fsdecode(error.filename)
    name = name if len(name) <= LONGEST_NAME else name[:60] + "..."
    return _fail(BAD_INPUT, complaint(name, "to read or write it", reason))


def _abandon_stdout() -> None:
    """Let the interpreter's last flush go nowhere, since nobody reads any more."""
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
