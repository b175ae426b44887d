"""The command line: bad input, JSON, exit codes, pipes."""

import json

import numpy as np
import pandas as pd
import pytest
from commanding import CASE, refused

from analytic.response import Response
from studies.__main__ import run
from studies.sources.registry import SOURCES, Effort, Source


def test_a_failed_row_is_named_and_the_exit_code_is_1(monkeypatch, capsys, tmp_path):
    def never(block, motion, *, duration, times):
        return Response.failure("it never converged")

    monkeypatch.setitem(SOURCES, "never", Source("model", never))
    assert run(["compare", *CASE, "--sources", "exact", "never", "--json"]) == 1
    output = capsys.readouterr()
    assert output.err.splitlines() == ["failed: never: it never converged"]
    assert json.loads(output.out.splitlines()[1])["peak_ratio"] is None
    assert run(["sweep", "--figure", "6", "--sources", "never", "--out", str(tmp_path)]) == 1
    errors = capsys.readouterr().err.splitlines()
    assert "figure 6, aspect 2, width_m 0.5, omega_over_p 0.1" in errors[0]
    assert (len(errors), errors[-1]) == (11, "failed: 230 more")
    table = pd.read_csv(tmp_path / "sweep.csv", keep_default_na=False)
    failed = table.groupby(["outcome", "peak_ratio", "message"]).size().to_dict()
    assert failed == {("failed", "nan", "it never converged"): 240}


BY_NUMBERS = [
    *(ZeroDivisionError("float division"), OverflowError(34, "too large"), FloatingPointError()),
    *(MemoryError(), np.linalg.LinAlgError("singular"), ValueError("math domain error")),
    ValueError("samples[3] is inf; it must be a finite number"),
]
BY_MISTAKE = [TypeError("x"), KeyError("x"), AttributeError("x"), ValueError("shapes differ")]


@pytest.mark.parametrize("error", [*BY_NUMBERS, *BY_MISTAKE], ids=repr)
def test_what_arithmetic_raises_is_one_line_and_what_a_mistake_does_is_not(
    error, monkeypatch, capsys
):
    def broken(*_, **__):
        raise error

    monkeypatch.setattr("studies.compare.command.compare", broken)
    line = ["compare", *CASE, "--sources", "exact"]
    if error in BY_MISTAKE:
        with pytest.raises(type(error)):
            run(line)
    else:
        refused(capsys, line, str(error) or type(error).__name__)


def test_accuracy_and_step_reach_only_the_sources_they_are_for():
    effort = Effort(step=1e-3, accuracy="tight")
    assert effort.options("exact") == {}
    assert effort.options("rk4") == {"step": 1e-3}
    assert effort.options("pybullet:fixed") == {"step": 1e-3}
    assert effort.options("mujoco") == {"step": 1e-3, "accuracy": "tight"}
