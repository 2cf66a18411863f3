"""Ctrl-C while the command is still being imported: one line, as at any later time.

The package imports this file before all others, since numpy and the scenes take a
third of a second; so it imports as little as it can. It acts in the program
``refcloud`` and in ``python -m refcloud``; in any other program that imports the
package, Ctrl-C stays as it is there.
"""

from __future__ import annotations

import os
import signal
import sys

STATUS = 130  # as a shell counts it: 128 and the number of SIGINT
NAME = "refcloud"
MODULE = "-m"  # stands for the program's name until python has found the module


def is_command(argv: list[str], typed: list[str]) -> bool:
    """Tell whether this program is the command, while its modules are imported.

    Parameters
    ----------
    argv
        The program's name and its words.
    typed
        The same with the interpreter and its own options in front.

    Returns
    -------
    Whether it is.

    Examples
    --------
    >>> is_command(["/usr/bin/refcloud", "list"], ["python3", "/usr/bin/refcloud"])
    True
    >>> is_command(["-m", "list"], ["python3", "-m", "refcloud", "list"])
    True
    >>> is_command(["a_script.py", "refcloud"], ["python3", "a_script.py", "refcloud"])
    False
    """
    name = argv[0] if argv else ""
    if name == MODULE:
        return MODULE in typed and typed[typed.index(MODULE) + 1 :][:1] == [NAME]
    return os.path.splitext(os.path.basename(name))[0] == NAME


def end(number: int, stack: object) -> None:
    """End the program at once: nothing is at work that must be cleared up."""
    try:
        os.write(2, b"refcloud: interrupted\n")
    finally:  # also where nobody can read it
        os._exit(STATUS)


def _guard() -> None:
    """Set `end` up; who ignores Ctrl-C, as a child may, goes on doing so."""
    if not is_command(sys.argv, sys.orig_argv):
        return
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        try:
            signal.signal(signal.SIGINT, end)
        except ValueError:  # not in the main thread
            return


_guard()
