"""The rows of `golden` are what comes out today."""

import pytest
from golden import HERE, PEERS, compared


@pytest.mark.slow
@pytest.mark.parametrize("name", ["models", *HERE])
def test_golden_rows_are_equal_to_the_bit(name):
    both = compared(name)
    assert len(both) > 90
    # the last digits of SciPy's integrators depend on the processor
    bits = both[~both.index.get_level_values("source").isin(PEERS)]
    assert bits[(bits["kept"] != bits["today"]).any(axis=1)].empty
    peaks = both["kept", "peak_ratio"].astype(float), both["today", "peak_ratio"].astype(float)
    assert peaks[1].to_numpy() == pytest.approx(peaks[0].to_numpy(), rel=1e-6, nan_ok=True)
