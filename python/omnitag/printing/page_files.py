"""Pages as files."""

import os
from typing import List, Sequence

from matplotlib.backends.backend_pdf import PdfPages

from omnitag.command_line import InputError, Progress
from omnitag.printing.pages import Page

DOTS_PER_INCH = 300


def write_pages(path: str, pages: Sequence[Page]) -> List[str]:
    """Write a PDF of all pages, or an SVG or PNG file for each; returns their paths."""
    stem, suffix = os.path.splitext(path)
    suffix = suffix.lower()
    if suffix not in (".pdf", ".svg", ".png"):
        raise InputError("--output: expected a name that ends in .pdf, .svg or .png, found "
                         "{!r}".format(path))
    written: List[str] = []
    with Progress("pages", len(pages)) as progress:
        if suffix == ".pdf":
            with PdfPages(path, metadata={"Title": "Markers", "CreationDate": None}) as pdf:
                for page in pages:
                    pdf.savefig(page.draw())
                    progress.advance()
            return [path]
        metadata = {"Date": None} if suffix == ".svg" else {}
        for page in pages:
            written.append(path if len(pages) == 1
                           else _unused(stem + "-" + page.name, suffix, written))
            page.draw().savefig(written[-1], dpi=DOTS_PER_INCH, metadata=metadata)
            progress.advance()
    return written


def _unused(stem: str, suffix: str, written: Sequence[str]) -> str:
    number = 2
    path = stem + suffix
    while path in written:
        path = "{}-{}{}".format(stem, number, suffix)
        number += 1
    return path
