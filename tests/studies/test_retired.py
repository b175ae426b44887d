"""A command that was retired says so, for one release."""

import pytest
from commanding import refused

<<<<<<< HEAD

RETIRED = ("ensemble", "free", "harmonic", "literature", "redraw", "throughput", "versions")
=======
RETIRED = ("free", "harmonic", "literature", "redraw", "throughput", "versions")
>>>>>>> c7c26ab5 (Free rocking of engines follows the closed forms over twenty impacts: a conformance test)


@pytest.mark.parametrize("name", RETIRED)
def test_a_retired_command_is_refused_in_one_line(name, capsys):
    refused(capsys, [name, "--out", "results"], name, "retired in 0.3", "changelog")
