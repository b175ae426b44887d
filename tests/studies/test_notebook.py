"""What a student sees in a notebook: pictures of responses and of the paper's figures."""

import pytest
from given import BLOCK, PULSE

import studies


def test_responses_with_a_history_are_a_picture_of_as_many_lines():
    exact, engine = [studies.respond(n, BLOCK, PULSE, history=True) for n in ("exact", "mujoco")]
    assert exact.history.time.size == 1001 and engine.history.time.size > 900
    assert len(studies.plot(exact).axes[0].lines) == 1
    drawing = studies.plot([exact, engine])
    assert len(drawing.axes[0].lines) == 2
    assert drawing._repr_png_().startswith(b"\x89PNG")
    for given in (studies.respond("exact", BLOCK, PULSE), []):
        with pytest.raises(ValueError, match=r"response 1 has no history|responses is empty"):
            studies.plot(given)


@pytest.mark.parametrize("number", [4, pytest.param(6, marks=pytest.mark.slow)])
def test_figures_of_the_paper_are_pictures(number):
    assert studies.figure(number)._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match="figure is 3"):
        studies.figure(3)
