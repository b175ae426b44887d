"""Every study, and one page that shows what they found."""

import contextlib
import io
import sys
from pathlib import Path

from tqdm import tqdm

from studies.kit import app
from studies.kit.arguments import Place
from studies.kit.store import FolderError
from studies.kit.tables import write_text
from studies.page.chapters import PARTS, Part

PAGE = "report.html"


def command(*, out: Place, full: bool = False) -> int:
    """Run every study and write one self-contained page about them, report.html.

    The quick studies take six minutes on two cores, the full ones two and a half hours. To continue
    an interrupted report, give the same command again.

    Parameters
    ----------
    out
        Folder for the results, one inside for each study, and for report.html.
    full
        Run the full studies, as published, instead of the quick ones.
    """
    from studies.page.page import write_page

    _prepare(out, full)
    codes = []
    parts = [part for part in PARTS if not part.needs]
    with tqdm(parts, disable=None, unit="study") as bar:
        for part in bar:
            bar.set_description(part.folder)
            if bar.disable:  # no terminal: a line for each, so that a log shows where it is
                print(f"{part.folder} …", file=sys.stderr, flush=True)
            code = fill(part, out, full)
            if code > 1:
                return code
            codes.append(code)
    write_page(out / PAGE, out, full)
    for part in parts:
        print(f"{part.folder}: {part.study.finding(part.study.read(out / part.folder))}")
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
        write_text(path, kind + "\n")
    except OSError as error:
        problem = f"it must be a folder that can be written ({error.strerror or error})"
        raise FolderError(out, problem) from error


def fill(part: Part, out: Path, full: bool) -> int:
    """Run the command of a part, without its words; return its exit code."""
    with contextlib.redirect_stdout(io.StringIO()):
        code = app.run({"": {part.name: ""}}, part.words(out / part.folder, full))
    if code == 1:
        print(f"{part.folder}: some rows failed; the page names them", file=sys.stderr)
    return code
