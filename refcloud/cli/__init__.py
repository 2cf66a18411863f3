"""The command line: the library's functions, with options read from annotations."""

from refcloud.cli.entry import main

__all__ = ["main"]
