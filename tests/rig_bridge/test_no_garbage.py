"""What runs with the collector of cyclic garbage off makes none: links, CAN hub, emulated rig."""

import gc

import pytest
from healthy_rig import EMULATED
from rig_links import DEMAND, RIG, both_ends

from rig_bridge.emulator.rig import EmulatedRig
from rig_bridge.emulator.settings import load_settings
from rig_bridge.transport.registry import TRANSPORTS

TICKS = 300


def garbage(step, ticks):
    """Return how many objects in cycles ``ticks`` steps leave behind."""
    gc.collect()
    gc.disable()
    try:
        for _ in range(ticks):
            step()
        return gc.collect()
    finally:
        gc.enable()


@pytest.mark.parametrize("kind", sorted(TRANSPORTS))
def test_a_tick_leaves_no_cycles(kind):
    settings = load_settings(EMULATED.with_name("emulator.yaml"))
    with both_ends(kind) as (bench, far):
        rig = EmulatedRig(RIG, settings, far.sequence_bits)

        def tick():
            far.send_frame(rig.measure())
            bench.receive_frames(1.0)
            bench.send_demand(DEMAND)
            rig.step(far.receive_demands(1.0))

        tick()
        assert garbage(tick, TICKS) == 0


def test_a_cycle_would_be_counted():
    def step():
        loop: list[object] = []
        loop.append(loop)

    assert garbage(step, TICKS) >= TICKS
