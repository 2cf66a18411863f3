"""Every figure into one folder, with a page that shows them and what they took."""

from __future__ import annotations

import html
import multiprocessing
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from refcloud.conventions import Skipped
from refcloud.figure import DOCUMENTS, find_figure
from refcloud.files import write_atomically
from refcloud.refusal import complaint
from refcloud.render import SIZES
from refcloud.scene import View

PAGE = "index.html"
TOLERANCE = 1.0 / 255.0  # nobody sees it in a PNG
STYLE = (
    "body{font:15px/1.45 sans-serif;max-width:1100px;margin:2em auto;padding:0 1em}"
    "figure{margin:2em 0}img{max-width:100%;height:auto;background:#ddd}"
    "figcaption{margin-top:.4em}code{background:#eee;padding:0 .25em}"
    "small{color:#555;display:block}"
)


@dataclass(frozen=True)
class Made:
    """One figure that was drawn, and what its drawing left out and took.

    Attributes
    ----------
    name
        Of the figure; its picture is NAME.png.
    quality
        The setting: "quick" or "final".
    seconds
        Of the whole drawing.
    skipped, notes
        As those of the picture.
    """

    name: str
    quality: str
    seconds: float
    skipped: tuple[Skipped, ...]
    notes: tuple[str, ...]

    @property
    def command(self) -> str:
        """Give the command that makes it."""
        return f"refcloud figure {self.name} --{self.quality}"

    @property
    def caption(self) -> str:
        """Say what it is, and by which setting."""
        figure = find_figure(self.name)
        number = f", {figure.number}" if figure.number else ""
        where = f"document {figure.document}{number}"
        return f"{self.name}: {figure.title} ({where}; {self.quality})"


def draw_figure(name: str, quality: str, path: Path) -> Made:
    """Draw one figure into a file.

    Parameters
    ----------
    name
        Of the figure.
    quality
        "quick" or "final".
    path
        The picture's name, ending in .png or .npy.

    Returns
    -------
    What was made.

    Raises
    ------
    ValueError
        No figure has that name.
    """
    figure = find_figure(name)
    start = time.perf_counter()
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        picture = figure.draw(View(*SIZES[quality], tolerance=TOLERANCE))
        picture.save(path, dither=False)
    seconds = time.perf_counter() - start
    return Made(name, quality, seconds, picture.skipped, picture.notes)


def draw_all(
    names: Sequence[str],
    quality: str,
    folder: Path,
    *,
    jobs: int = 1,
    tell: Callable[[int], None] | None = None,
) -> list[Made]:
    """Draw figures into a folder, several at a time, and write the page.

    Parameters
    ----------
    names
        Of the figures, in the order of the page.
    quality
        "quick" or "final".
    folder
        Made where it is not there.
    jobs
        How many processes draw.
    tell
        Called with how many figures are done.

    Returns
    -------
    What was made, in the order of the names.

    Raises
    ------
    ValueError
        The folder cannot be made.
    """
    if folder.exists() and not folder.is_dir():
        raise ValueError(complaint("--output", "a folder", f"the file {folder}"))
    folder.mkdir(exist_ok=True)
    made: dict[str, Made] = {}
    for one in _drawn(names, quality, folder, jobs):
        made[one.name] = one
        if tell is not None:
            tell(len(made))
    rows = [made[name] for name in names]
    text = page(rows).encode()
    write_atomically(folder / PAGE, lambda file: file.write(text))
    return rows


def _drawn(
    names: Sequence[str], quality: str, folder: Path, jobs: int
) -> Iterator[Made]:
    """Draw by some processes, or one after the other in this one."""
    tasks = [(name, quality, folder / f"{name}.png") for name in names]
    if jobs == 1 or len(tasks) < 2:
        for task in tasks:
            yield draw_figure(*task)
        return
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(min(jobs, len(tasks)), mp_context=context)
    try:
        waiting: set[Future[Made]] = {pool.submit(draw_figure, *t) for t in tasks}
        while waiting:
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def page(rows: Sequence[Made]) -> str:
    """Write the page: each picture with its caption, time, savings and command.

    Parameters
    ----------
    rows
        What was made; the pictures lie beside the page.

    Returns
    -------
    HTML that needs nothing but those pictures.
    """
    total = sum(row.seconds for row in rows)
    parts = [
        "<!doctype html>",
        '<html lang="en"><head><meta charset="utf-8">',
        f"<title>Figures of refcloud</title><style>{STYLE}</style></head><body>",
        "<h1>Figures</h1>",
        f"<p>{len(rows)} figures, {total:.0f} seconds of drawing.</p>",
    ]
    for prefix, letter in DOCUMENTS.items():
        ours = [row for row in rows if row.name.split("-")[0] == prefix]
        if ours:
            parts.append(f"<h2>Document {letter}</h2>")
            parts += [_entry(row) for row in ours]
    return "\n".join([*parts, "</body></html>", ""])


def _entry(row: Made) -> str:
    said = [*row.notes, *(str(skip) for skip in row.skipped)]
    lines = "".join(f"<small>{html.escape(line)}</small>" for line in said)
    caption = html.escape(row.caption)
    return (
        f'<figure id="{row.name}"><img src="{row.name}.png" alt="{caption}">'
        f"<figcaption>{caption}<small>{row.seconds:.2f} s, made by"
        f" <code>{html.escape(row.command)}</code></small>{lines}"
        "</figcaption></figure>"
    )
