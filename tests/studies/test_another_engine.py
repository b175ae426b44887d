"""An engine of another package goes through every study: it is asked, tabulated, drawn and told of.

It is found by its entry point (tests/plugin): no study names it.
"""

import json

import pytest
from commanding import CASE

from studies.__main__ import COMMANDS, run

ARGUMENTS = {
    "sweep": ("--figure", "6", "--accuracy", "loose", "--sources", "exact", "moreau"),
    "histories": ("--figure", "4", "--sources", "exact", "moreau"),
    "scenes": ("--quick", "--sources", "exact", "moreau"),
    "validate": ("--cases", "8", "--sources", "moreau"),
    "precision": ("--quick", "--sources", "exact", "moreau"),
    "contact": ("--quick", "--engines", "moreau"),
    "stability": ("--quick", "--sources", "exact", "moreau", "moreau:fixed", "moreau:naive"),
    "overturning": ("--quick", "--sources", "exact", "moreau"),
    "score": ("moreau", "--quick"),
}
OTHERWISE = {"compare", "animate", "export", "doctor", "report", "readme"}
"""Commands of one case, and of all studies."""
OF_NO_ENGINE = {"linearizations", "blocks"}
OF_ENGINES_THAT_WERE_ASKED = {"advise", "restitution"}


def test_every_study_is_here():
    known = ARGUMENTS.keys() | OTHERWISE | OF_NO_ENGINE | OF_ENGINES_THAT_WERE_ASKED
    assert set(COMMANDS) == known


@pytest.mark.slow
@pytest.mark.parametrize("name", ARGUMENTS)
def test_it_goes_through_a_study(name, tmp_path, capsys):
    # failed rows are answers, too
    assert run([name, *ARGUMENTS[name], "--out", str(tmp_path)]) in (0, 1)
    finding = capsys.readouterr().out.partition("\n\n")[0]
    assert len(finding.split()) > 3
    assert any("moreau" in path.read_text() for path in tmp_path.glob("*.csv"))


def test_it_is_compared(capsys):
    sources = ("--sources", "exact", "moreau", "moreau:naive")
    assert run(["compare", *CASE, *sources, "--json"]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [row["source"] for row in rows] == ["exact", "moreau", "moreau:naive"]
    # landing steps of first order in its contact; with gaps closed late, a part of the sixth
    assert rows[1]["peak_ratio"] == pytest.approx(rows[0]["peak_ratio"], rel=1e-3)
    assert rows[2]["outcome"] == "rocked"
