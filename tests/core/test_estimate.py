"""What a bake is said to cost: it grows as the work does, keeps to the limit, and names the remedy."""

import numpy as np
import pytest
from core import estimate, presets


def of_preset(index, **more):
    return estimate.estimate(**presets.PRESETS[index].values, **more)


def test_finer_presets_cost_more(native):
    draft, paper, high = (of_preset(index, memory=64e9) for index in range(3))
    assert draft.seconds < paper.seconds < high.seconds
    assert draft.memory < paper.memory < high.memory
    assert draft.file_bytes < paper.file_bytes < high.file_bytes
    # A raw GDM in floats must be somewhere.
    assert paper.memory > 4 * np.prod((64, 64, 32, 16, 32))


@pytest.mark.parametrize("limit", [1e9, 2e9, 6e9])
def test_the_limit_is_kept_and_costs_time(native, limit):
    tight, roomy = of_preset(2, memory=limit, layout="paper"), of_preset(2, memory=64e9, layout="paper")
    assert tight.memory <= limit and tight.plan["blocks"] > 1
    assert roomy.plan["blocks"] == 1 and tight.seconds > roomy.seconds


def test_too_low_a_limit_is_said(native):
    low = of_preset(2, memory=1e6)
    assert low.plan["blocks"] == 0
    assert "1.0 MB" in low.sentence() and "raise it" in low.sentence()


def test_the_layout_follows_the_limit(native):
    assert of_preset(1, memory=64e9).plan["layout"] == "nodes"
    assert of_preset(2, memory=4e9).plan["layout"] == "paper"


def test_corrections_multiply(native):
    once, twice = of_preset(1), of_preset(1, correction=2.0)
    assert 1.5 < twice.seconds / once.seconds <= 2.0


def test_sentences_have_units(native):
    assert of_preset(1).sentence().count("MB") == 2
    assert "GB" in of_preset(2, memory=4e9).sentence()
    huge = estimate.estimate((1024, 1024, 32), (128, 256), (64, 64, 33), 64, (64, 64, 33), memory=64e9)
    assert huge.sentence().split()[2] in ("min,", "h,")


def test_wrong_numbers_are_refused(native):
    with pytest.raises(ValueError, match="GDM resolution"):
        estimate.estimate((1, 64, 32), (16, 32), (64, 64, 33), 64, (64, 64, 33))
