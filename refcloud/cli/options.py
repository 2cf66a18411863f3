"""Options of the command line: the library's parameters, and names of files."""

from refcloud.parameters.options import (
    MISSING,
    Option,
    base_of,
    default_text,
    mark,
    options_of,
    range_text,
    size_of,
    typeable,
)

__all__ = [
    "MISSING",
    "FileOption",
    "Option",
    "base_of",
    "default_text",
    "mark",
    "options_of",
    "range_text",
    "size_of",
    "typeable",
]


class FileOption(Option):
    """An option whose value is a file's name."""

    @property
    def metavar(self) -> str:
        """Give what stands for the value in help."""
        return "FILE"
