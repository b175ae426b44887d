"""Every study where nothing answers, no picture can be written, or its folder is removed."""

import errno
import os
import shutil

import pandas as pd
import pytest
from commanding import refused
from PIL.Image import Image

from analytic.response import Response
from studies.__main__ import run
from studies.catalogue import STUDIES
from studies.old.executors import Local
from studies.old.journal import FolderError
from studies.old.plan import Plan, fill
from studies.sweep import STUDY as SWEEP

ASKING = [
    *("histories", "validate"),
    *(
        pytest.param(name, marks=pytest.mark.slow)
        for name in (
            *("contact", "validity", "stability", "sweep"),
            *("overturning",),
        )
    ),
]
"""Studies that put jobs to sources, those apart whose jobs or reports take longer."""


def command_line(name, folder):
    study = next(study for study in STUDIES if study.name == name)
    return study.command_line(study.chapters[0], folder, full=False)


def never(_, jobs):
    for number in range(len(jobs)):
        yield number, Response.failure("it never answers")


def full(*_, **__):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


DRAWN_FROM_ANSWERS = {"histories"}
"""Studies that draw nothing where nothing answers."""


@pytest.mark.parametrize("name", ASKING)
def test_a_study_in_which_nothing_answers_says_so(name, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(Local, "__call__", never)
    drawn = []
    monkeypatch.setattr(Image, "save", lambda self, *_, **__: drawn.append(self.size))
    assert run(command_line(name, tmp_path)) == 1
    output = capsys.readouterr()
    assert all(line.startswith("failed: ") for line in output.err.splitlines())
    assert "it never answers" in output.err
    assert output.out
    if name == "histories":
        assert output.out.count("not tested: ") == 3
    assert bool(drawn) == (name not in DRAWN_FROM_ANSWERS)
    if name in DRAWN_FROM_ANSWERS:
        pytest.skip("without an answer it draws nothing")
    monkeypatch.setattr(Image, "save", full)
    words = (f"--out is '{tmp_path}'", ".png: No space left on device")
    refused(capsys, command_line(name, tmp_path), *words)
    assert not list(tmp_path.glob(".part*"))


def test_a_folder_that_is_removed_while_tables_are_made_is_no_success(tmp_path):
    def removing(_):
        shutil.rmtree(tmp_path)
        return {SWEEP.name: pd.DataFrame({"a": [1]})}

    with pytest.raises(FolderError, match="removed during the run"):
        fill(SWEEP, Plan(tabulate=removing), tmp_path)
    assert not tmp_path.exists()
