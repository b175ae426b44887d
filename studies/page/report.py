"""Every study, and one page that shows what they found."""

import contextlib
import io
import sys
from pathlib import Path

from tqdm import tqdm

from studies.kit import provenance
from studies.catalogue import CHAPTERS, Chapter
from studies.kit.journal import FolderError
from studies.page.page import write_page

PAGE = "report.html"


def command(*, out: Path, full: bool = False) -> int:
    """Run every study and write one page about them.

    Parameters
    ----------
    out
        Folder for the results, one inside for each study, and for report.html. What an earlier run
        finished is not done again.
    full
        The full studies, as published, instead of the quick ones.
    """
    _prepare(out, full)
    codes = []
    minutes = sum(chapter.minutes[full] for chapter in CHAPTERS)
    form = "{desc} {percentage:3.0f}% [{elapsed}<{remaining}]"
    with tqdm(total=minutes, disable=None, bar_format=form) as bar:
        for chapter in CHAPTERS:
            bar.set_description(chapter.folder)
            code = fill(chapter, out, full)
            if code > 1:
                return code
            codes.append(code)
            bar.update(chapter.minutes[full])
    write_page(out / PAGE, out, full)
    print(*(f"{c.folder}: {c.headline(out / c.folder)}\n" for c in CHAPTERS), sep="\n")
    print(out / PAGE)
    return max(codes)


def _prepare(out: Path, full: bool) -> None:
    """Make the folder, and refuse one that holds a report of the other kind."""
    path, kind = out / "kind.txt", "full" if full else "quick"
    try:
        out.mkdir(parents=True, exist_ok=True)
        held = path.read_text().strip() if path.is_file() else kind
        if held != kind:
            raise FolderError(out, f"it holds a {held} report; a {kind} one needs another folder")
        provenance.write_text(path, kind + "\n")
    except (FileExistsError, NotADirectoryError) as error:
        raise FolderError(out, "it must be a folder, not a file") from error
    except OSError as error:
        problem = f"it must be a folder that can be written ({error.strerror or error})"
        raise FolderError(out, problem) from error


def fill(chapter: Chapter, out: Path, full: bool) -> int:
    """Run a chapter's study, without its words; return its exit code."""
    from studies.__main__ import run

    with contextlib.redirect_stdout(io.StringIO()):
        code = run(chapter.command_line(out / chapter.folder, full))
    if code == 1:
        print(f"{chapter.folder}: some rows failed; the page names them", file=sys.stderr)
    return code
