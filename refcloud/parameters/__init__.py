"""What the library's signatures and docstrings say, for faces: command line, studio."""

from refcloud.parameters.docstrings import parameter_texts, summary
from refcloud.parameters.options import (
    MISSING,
    Option,
    base_of,
    default_text,
    mark,
    options_of,
    size_of,
)

__all__ = [
    "MISSING",
    "Option",
    "base_of",
    "default_text",
    "mark",
    "options_of",
    "parameter_texts",
    "size_of",
    "summary",
]
