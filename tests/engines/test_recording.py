"""What cannot be written down in a script; that the others do what a run does: test_export."""

import pytest

from engines.run.export import Notes


def test_what_no_call_made_cannot_be_written_down():
    pymunk = pytest.importorskip("pymunk")
    notes = Notes()
    space = notes.of(pymunk, "pymunk").Space()
    with pytest.raises(TypeError, match="no value that can be written down"):
        space.add(pymunk.Body(1.0, 1.0))
    with pytest.raises(TypeError, match="was not made by a call"):
        notes.name(own=space.static_body)
