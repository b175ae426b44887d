"""A command that was retired says so, for one release."""

import pytest
from commanding import refused

RETIRED = ("ensemble", "free", "harmonic", "literature", "redraw", "throughput", "versions")


@pytest.mark.parametrize("name", RETIRED)
def test_a_retired_command_is_refused_in_one_line(name, capsys):
    refused(capsys, [name, "--out", "results"], name, "retired in 0.3", "changelog")
