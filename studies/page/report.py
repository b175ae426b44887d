"""Every study, and one page that shows what they found."""

import contextlib
import io
import sys
from pathlib import Path

from tqdm import tqdm

from studies.catalogue import CHAPTERS, STUDIES
from studies.old import app, provenance
from studies.old.arguments import Place
from studies.old.journal import FolderError
from studies.old.study import Chapter, Study

PAGE = "report.html"


def command(*, out: Place, full: bool = False) -> int:
    """Run every study and write one page about them.

    Parameters
    ----------
    out
        Folder for the results, one inside for each study, and for report.html. What an earlier run
        finished is not done again.
    full
        The full studies, as published, instead of the quick ones.
    """
    from studies.page.page import write_page

    _prepare(out, full)
    codes = []
    minutes = sum(chapter.minutes[full] for _, chapter in CHAPTERS)
    form = "{desc} {percentage:3.0f}% [{elapsed}<{remaining}]"
    with tqdm(total=minutes, disable=None, bar_format=form) as bar:
        for study, chapter in CHAPTERS:
            bar.set_description(chapter.folder)
            if bar.disable:  # no terminal: a line for each, so that a log shows where it is
                print(f"{chapter.folder} …", file=sys.stderr, flush=True)
            code = fill(study, chapter, out, full)
            if code > 1:
                return code
            codes.append(code)
            bar.update(chapter.minutes[full])
    write_page(out / PAGE, out, full)
    for study, chapter in CHAPTERS:
        print(f"{chapter.folder}: {study.finding(out / chapter.folder)}")
    print(out / PAGE)
    return max(codes)


def _prepare(out: Path, full: bool) -> None:
    path, kind = out / "kind.txt", "full" if full else "quick"
    try:
        out.mkdir(parents=True, exist_ok=True)
        strange = sorted(each.name for each in out.iterdir() if each.name != f".part.{path.name}")
        if strange and not path.is_file():
            problem = f"it must be new or empty, or hold a report, and it holds {strange[0]!r}"
            raise FolderError(out, problem)
        held = path.read_text(errors="replace").strip() if path.is_file() else kind
        if held != kind:
            raise FolderError(out, f"it holds a {held} report; a {kind} one needs another folder")
        provenance.write_text(path, kind + "\n")
    except (FileExistsError, NotADirectoryError) as error:
        raise FolderError(out, "it must be a folder, not a file") from error
    except OSError as error:
        problem = f"it must be a folder that can be written ({error.strerror or error})"
        raise FolderError(out, problem) from error


def fill(study: Study, chapter: Chapter, out: Path, full: bool) -> int:
    """Run a chapter's study, without its words; return its exit code."""
    with contextlib.redirect_stdout(io.StringIO()):
        code = app.run(STUDIES, study.command_line(chapter, out / chapter.folder, full))
    if code == 1:
        print(f"{chapter.folder}: some rows failed; the page names them", file=sys.stderr)
    return code
