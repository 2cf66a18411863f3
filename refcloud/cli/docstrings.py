"""What the docstrings of the library say, for ``--help``."""

from refcloud.parameters.docstrings import parameter_texts, summary

__all__ = ["parameter_texts", "summary"]
