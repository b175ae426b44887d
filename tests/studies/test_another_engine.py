"""An engine of another package goes through every study: it is asked, tabulated, drawn and told of.

It is found by its entry point (tests/plugin): no study names it.
"""

import json

import pytest
from matplotlib.figure import Figure

from studies.__main__ import run
from studies.catalogue import STUDIES

ARGUMENTS = {
    "advise": ("--engines", "moreau"),
    "sweep": ("--figure", "6", "--accuracy", "loose", "--sources", "exact", "moreau"),
    "histories": ("--figure", "4", "--sources", "exact", "moreau"),
    "scenes": ("--quick", "--sources", "exact", "moreau"),
    "validate": ("--cases", "8", "--sources", "moreau"),
    "estimate": ("--cases", "3", "--sources", "moreau"),
    "precision": ("--quick", "--engines", "moreau"),
    "cost": ("--quick", "--engines", "moreau"),
    "contact": ("--quick", "--engines", "moreau"),
    "defaults": ("--quick", "--sources", "exact", "moreau:naive"),
    "stability": ("--quick", "--sources", "exact", "moreau", "moreau:fixed", "moreau:naive"),
    "overturning": ("--quick", "--sources", "exact", "moreau"),
    "validity": ("--quick", "--sources", "moreau:fixed"),
    "score": ("moreau", "--quick"),
}
OF_NO_ENGINE = {"linearizations", "blocks"}
OF_ENGINES_THAT_WERE_ASKED = {"symptoms", "restitution", "steps"}


def test_every_study_with_results_is_here():
    assert {study.name for study in STUDIES if study.table} == (
        ARGUMENTS.keys() | OF_NO_ENGINE | OF_ENGINES_THAT_WERE_ASKED
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ARGUMENTS)
def test_it_goes_through_a_study(name, tmp_path):
    study = next(study for study in STUDIES if study.name == name)
    # failed rows are answers, too
    assert run([name, *ARGUMENTS[name], "--out", str(tmp_path)]) in (0, 1)
    assert study.finding(tmp_path)
    figures = study.pictures(tmp_path)
    assert all(isinstance(figure, Figure) for figure in figures.values())
    told = [path.name for path in tmp_path.glob("*.csv") if "moreau" in path.read_text()]
    assert told


def test_it_is_compared(capsys):
    case = ("--width", "0.5", "--height", "1.5", "--pulse", "full-sine", "--amplitude", "0.4")
    sources = ("--sources", "exact", "moreau", "moreau:naive")
    assert run(["compare", *case, "--omega", "6.2832", *sources, "--json"]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [row["source"] for row in rows] == ["exact", "moreau", "moreau:naive"]
    # landing steps of first order in its contact; with gaps closed late, a part of the sixth
    assert rows[1]["peak_ratio"] == pytest.approx(rows[0]["peak_ratio"], rel=1e-3)
    assert rows[2]["outcome"] == "rocked"
