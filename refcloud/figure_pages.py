"""Every figure into one folder, with a page that shows them and what they took."""

from __future__ import annotations

import base64
import html
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from refcloud.choices import SIZES
from refcloud.conventions import Skipped
from refcloud.figure import DOCUMENTS, Drawn, Figure, find_figure
from refcloud.files import write_atomically
from refcloud.processes import workers
from refcloud.references import DOCUMENTS as SOURCES
from refcloud.refusal import complaint
from refcloud.scene import View

PAGE = "index.html"
TOLERANCE = 1.0 / 255.0  # nobody sees it in a PNG
LEGIBLE = 640, 480  # pixels: words of plots and diagrams can be read from there on
STYLE = """
:root{color-scheme:light dark}
body{font:15px/1.5 system-ui,sans-serif}
body{max-width:1240px;margin:2.5em auto;padding:0 1.5em}
header p,nav{color:GrayText}
nav a{margin-right:1.2em}
h2{margin:2.2em 0 .2em;font-size:1.25em}
h2+p{margin-top:0;color:GrayText}
section{display:grid;grid-template-columns:repeat(auto-fill,minmax(340px,1fr));gap:1.8em}
figure{margin:0;border:1px solid #8885;border-radius:8px;overflow:hidden}
figure a{display:block;background:#8882}
img{display:block;width:100%;height:auto}
figcaption{padding:.8em 1em 1em}
figcaption b{display:block}
figcaption span{color:GrayText;font-size:.9em;display:block}
code{background:#8882;border-radius:3px;padding:.1em .35em;font-size:.86em}
details{font-size:.86em;margin-top:.5em}
li{overflow-wrap:anywhere}
"""


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
    cpu
        Seconds that this process computed in them; less where others did it.
    """

    name: str
    quality: str
    seconds: float
    skipped: tuple[Skipped, ...]
    notes: tuple[str, ...]
    cpu: float = 0.0

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
    start, cpu = time.perf_counter(), time.process_time()
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        picture = figure.draw(View(*size_of(figure, quality), tolerance=TOLERANCE))
        picture.save(path, dither=isinstance(figure.draw, Drawn))
    seconds, cpu = time.perf_counter() - start, time.process_time() - cpu
    return Made(name, quality, seconds, picture.skipped, picture.notes, cpu)


def size_of(figure: Figure, quality: str) -> tuple[int, int]:
    """Give width and height: those of a setting, or so many that words can be read."""
    if isinstance(figure.draw, Drawn):
        return SIZES[quality]
    return max(SIZES[quality], LEGIBLE)


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
    text = page(rows, folder).encode()
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
    with workers(min(jobs, len(tasks))) as pool:
        waiting: set[Future[Made]] = {pool.submit(draw_figure, *t) for t in tasks}
        while waiting:
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()


def page(rows: Sequence[Made], folder: Path) -> str:
    """Write the page: each picture with its caption, time, savings and command.

    Parameters
    ----------
    rows
        What was made.
    folder
        Where the pictures lie; they are copied into the page.

    Returns
    -------
    HTML that needs nothing else.
    """
    total, cpu = (
        sum(getattr(row, what) for row in rows) for what in ("seconds", "cpu")
    )
    ours = {
        letter: [row for row in rows if row.name.split("-")[0] == prefix]
        for prefix, letter in DOCUMENTS.items()
    }
    ours = {letter: rows for letter, rows in ours.items() if rows}
    links = "".join(
        f'<a href="#{letter}">Document {letter} ({len(some)})</a>'
        for letter, some in ours.items()
    )
    quality = rows[0].quality if rows else "quick"
    parts = [
        "<!doctype html>",
        '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width,initial-scale=1">',
        f"<title>Figures of refcloud</title><style>{STYLE}</style></head><body>",
        "<header><h1>Figures</h1>",
        f"<p>{len(rows)} figures by <code>refcloud figure --all --{quality}</code>,"
        f" {total:.0f} seconds of drawing, {cpu:.0f} of them computing.</p>",
        f"<nav>{links}</nav></header>",
    ]
    for letter, some in ours.items():
        parts.append(f'<h2 id="{letter}">Document {letter}</h2>')
        parts.append(f"<p>{html.escape(SOURCES[letter])}</p><section>")
        parts += [_entry(row, folder) for row in some]
        parts.append("</section>")
    return "\n".join([*parts, "</body></html>", ""])


def _entry(row: Made, folder: Path) -> str:
    figure = find_figure(row.name)
    where = f"document {figure.document}, {figure.number}".rstrip(", ")
    path = folder / f"{row.name}.png"
    bits = base64.b64encode(path.read_bytes()).decode()
    said = [*row.notes, *(str(skip) for skip in row.skipped)]
    lines = "".join(f"<li>{html.escape(line)}</li>" for line in said)
    what = "what was skipped, and notes" if row.skipped else "notes; nothing skipped"
    more = f"<details><summary>{what}</summary><ul>{lines}</ul></details>"
    return (
        f'<figure id="{row.name}"><a href="{row.name}.png">'
        f'<img src="data:image/png;base64,{bits}" alt="{html.escape(row.caption)}"></a>'
        f"<figcaption><b>{row.name}: {html.escape(figure.title)}</b>"
        f"<span>{html.escape(where)}; {row.quality}</span>"
        f"<span>{row.seconds:.2f} s, {row.cpu:.2f} s of computing</span>"
        f"<code>{html.escape(row.command)}</code>{more if said else ''}"
        "</figcaption></figure>"
    )
