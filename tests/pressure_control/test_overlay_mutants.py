"""The arbiter's tests are worth something: whatever is broken in its code, a story comes out wrong.

The stories are compared with a second writing of the arbiter. A sample of the broken sources is
tried here, all of them with ``python benchmarks/overlay_mutants.py``.
"""

import pytest
from overlay_mutants import EQUIVALENT, MODULES, broken, caught, holds, interpreted
from overlay_stories import STORIES
from second_arbiter import SecondArbiter

from pressure_control.overlay.arbiter import OverlayArbiter

SAMPLE = 12
"""Every so many-th broken source of a file."""


@pytest.mark.parametrize("story", STORIES, ids=lambda story: story.name)
def test_the_arbiter_is_its_second_writing(story):
    assert holds(OverlayArbiter, SecondArbiter, story)


def test_the_code_as_it_is_passes_as_plain_python():
    with interpreted(None, "") as modules:
        assert not caught(modules)


@pytest.mark.parametrize("module", MODULES)
def test_a_sample_of_broken_sources_is_caught(module):
    found = [(what, text) for what, text in broken(module) if (module, what) not in EQUIVALENT]
    alive = []
    for what, text in found[len(module) % 5 :: SAMPLE]:
        with interpreted(module, text) as modules:
            if not caught(modules):
                alive.append(what)
    assert alive == []


def test_what_counts_as_equivalent_is_still_there():
    known = {(module, what) for module in MODULES for what, _ in broken(module)}
    assert set(EQUIVALENT) <= known
