"""What every tutorial shares: its pictures, the flags of a run, and shown code.

``python tutorials/02_hash.py`` draws all pictures into the current folder. Every
parameter of its function ``picture`` is a flag, read from its annotation: with one of
them the main picture alone is drawn. ``--quick`` draws small, ``--sliders`` opens a
page with a slider for each. In a notebook the cells show the same pictures.
"""

from __future__ import annotations

import inspect
import re
import signal
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from plots import curves
from sheets import Sheet, sheet_of, side_by_side

from refcloud import Picture
from refcloud.cli.docstrings import summary
from refcloud.cli.options import options_of
from refcloud.cli.parser import Command
from refcloud.conventions import Skipped

HERE = Path(__file__).parent
PICTURES = HERE / "pictures"
WIDEST, QUICK_SHARE = 640, 4  # pixels; how much smaller a quick picture is
GAPS = 4 * 4  # pixels between five panels
BAD_INPUT, INTERRUPTED = 2, 130

Shown = Picture | Sheet
Drawn = Shown | Callable[[], Shown]


@dataclass(frozen=True)
class Run:
    """How a tutorial is run.

    Attributes
    ----------
    quick
        Small pictures, to see that everything works.
    sliders
        Serve a page with a slider for each parameter, on this machine alone.
    """

    quick: bool = False
    sliders: bool = False


class Lesson:
    """The pictures of one tutorial, at the sizes and places that the run asks for."""

    def __init__(self) -> None:
        script = Path(sys.argv[0]).resolve()
        mine = script.parent == HERE and re.match(r"\d\d_\w+\.py$", script.name)
        self.script = script if mine else None  # in a notebook there is none
        self.words = sys.argv[1:] if mine else []
        self.quick = "--quick" in self.words
        self.folder: Path | None = Path() if mine else None
        self._columns = 0  # of the row that is being drawn
        self._started = time.perf_counter()
        main = getattr(sys.modules["__main__"], "__file__", None)
        if mine and main and Path(main).resolve() == script:
            self._end_in_a_line()

    def _end_in_a_line(self) -> None:
        """Let Ctrl-C end the program with one line, wherever it is."""
        name = Path(sys.argv[0]).name

        def end(number: int, stack: object) -> NoReturn:
            print(f"{name}: interrupted", file=sys.stderr)
            raise SystemExit(INTERRUPTED)

        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, end)

    def size(self, width: int, height: int) -> tuple[int, int]:
        """Give the size of a picture: as asked for, small in a row, smaller if quick.

        Parameters
        ----------
        width, height
            Of the picture when it stands alone, pixels.
        """
        wide = width
        if self._columns:
            wide = (WIDEST - GAPS) // self._columns
        if self.quick:
            wide //= QUICK_SHARE
        return wide, round(wide * height / width)

    def tolerance(self, allowed: float) -> float:
        """Give the largest error that is allowed; none if quick.

        Quick pictures are compared with stored ones, code by code: exact, they stay the
        same whatever is saved another day.
        """
        return 0.0 if self.quick else allowed

    def show(self, what: Callable[..., Shown] | Shown, name: str, caption: str) -> Any:
        """Show a picture and write it as NAME.png; a function takes the run's flags.

        Parameters
        ----------
        what
            A picture, or the tutorial's function that draws its main one.
        name, caption
            Of the file, and what it shows.
        """
        if not callable(what):
            return self._store(sheet_of(what), name)
        try:
            knobs = self._read(what)
            shown = self._store(sheet_of(what(**knobs)), name)
        except (ValueError, TypeError) as refusal:
            if self.script is None:
                raise
            print(f"{self.script.name}: {refusal}", file=sys.stderr)
            raise SystemExit(BAD_INPUT) from None
        if knobs:  # one picture was asked for
            raise SystemExit(0)
        return shown

    def strip(
        self,
        picture: Callable[..., Shown],
        knob: str,
        values: Sequence[Any],
        name: str,
        caption: str,
    ) -> Any:
        """Show the picture for five values of one parameter, side by side."""
        cells: dict[str, Drawn] = {
            v if isinstance(v, str) else f"{knob} {v:.4g}": partial(
                picture, **{knob: v}
            )
            for v in values
        }
        return self.row(cells, name, caption, columns=len(values))

    def row(
        self, cells: Mapping[str, Drawn], name: str, caption: str, columns: int = 5
    ) -> Any:
        """Show panels side by side, each drawn at the size that it gets.

        Parameters
        ----------
        cells
            Pictures, or functions that draw them, by label.
        name, caption
            Of the file, and what it shows.
        columns
            Panels in a row.
        """
        self._columns = columns
        try:
            panels = {k: sheet_of(v() if callable(v) else v) for k, v in cells.items()}
        finally:
            self._columns = 0
        sheet = side_by_side(panels, columns=columns, labels=not self.quick)
        return self._store(sheet, name)

    def plot(
        self, x: Any, lines: Mapping[str, Any], name: str, caption: str, **how: Any
    ) -> Any:
        """Show curves over one axis.

        Parameters
        ----------
        x, lines
            Where the curves are known, and their values by name, each of shape (N,).
        name, caption
            Of the file, and what it shows.
        how
            The range upward and the axes, as `plots.curves` takes them.
        """
        return self._store(curves(self.size(480, 300), x, lines, **how), name)

    def timed(self, name: str, make: Callable[..., Any], *of: Any, **how: Any) -> Any:
        """Call a function, print what it took of one core, and give what it gave."""
        started = time.process_time()
        made = make(*of, **how)
        print(f"{name:16} {time.process_time() - started:.2f} s")
        return made

    def source(self, *functions: Callable[..., Any]) -> None:
        """Tell where the library's code stands that a page shows here."""
        for function in functions:
            path, line, text = source_of(function)
            self._aside(f"{path}:{line}: {len(text.splitlines())} lines")

    def told(self, rows: Sequence[Skipped]) -> None:
        """Print what a picture's making left out."""
        print(*rows, sep="\n")

    def _read(self, picture: Callable[..., Shown]) -> dict[str, Any]:
        """Read the run's flags; with --sliders serve the page until it is stopped."""
        if self.script is None:
            return {}
        command = Command(
            f"{HERE.name}/{self.script.name}",
            summary(picture),
            output="folder of the pictures; by default the current one",
            program="python",
            kind="FOLDER",
        )
        knobs, how = options_of(picture), options_of(Run)
        command.group("the picture", "", knobs)
        command.group("the run", "", how)
        given = command.parse(self.words)
        self.folder = Path(given.named("."))
        if not self.folder.is_dir():
            raise ValueError(f"--output: expected a folder, got {str(self.folder)!r}")
        if Run(**given.of(how)).sliders:
            import sliders

            # The page is there until Ctrl-C, which is no failure.
            signal.signal(signal.SIGINT, signal.default_int_handler)
            sliders.serve(picture, self.script.stem)
            raise SystemExit(0)
        return given.of(knobs)

    def _store(self, sheet: Sheet, name: str) -> Sheet:
        if self.folder is not None:
            path = sheet.save(self.folder / f"{name}.png")
            self._aside(f"{time.perf_counter() - self._started:6.1f} s  {path}")
        return sheet

    def _aside(self, line: str) -> None:
        """Tell who runs the file how far it is: apart from what a cell prints."""
        print(line, file=sys.stderr if self.script else sys.stdout)


def source_of(function: Callable[..., Any]) -> tuple[str, int, str]:
    """Give a library function's file, line and text, its docstring's first line only.

    Parameters
    ----------
    function
        Of refcloud.

    Returns
    -------
    The file's name below the repository, the line, and the code.
    """
    import ast
    import textwrap

    plain = inspect.unwrap(function)
    lines, first = inspect.getsourcelines(plain)
    text = textwrap.dedent("".join(lines))
    node: Any = ast.parse(text).body[0]
    kept = text.splitlines()
    doc = node.body[0]
    if ast.get_docstring(node) and doc.end_lineno > doc.lineno:
        kept[doc.lineno - 1] += '"""'
        del kept[doc.lineno : doc.end_lineno]
        while not kept[doc.lineno].strip():
            del kept[doc.lineno]
    path = Path(inspect.getsourcefile(plain) or "").as_posix()
    return "refcloud/" + path.rpartition("/refcloud/")[2], first, "\n".join(kept)
