"""What a run tells in the terminal when it is over."""

from __future__ import annotations

from typing import Any

from steering_bringup.outcome import Outcome


def lines(outcome: Outcome) -> list[str]:
    """Return a few lines: what ran, how fast, what was recorded, largest values, where."""
    shown = [_headline(outcome)]
    if outcome.latency:
        shown.append(_latency(outcome.latency))
    if outcome.rig is not None:
        shown += _rig(outcome.rig)
    if outcome.bag is not None:
        lost = sum(outcome.lost.values())
        shown.append(f"  recorded     {outcome.messages} messages, {lost} lost: {outcome.bag}")
    shown += [f"  largest      {text}" for text in _peaks(outcome)]
    shown += [f"  note         {note}" for note in outcome.notes]
    return shown


def _headline(outcome: Outcome) -> str:
    whole = outcome.ticks == outcome.planned
    ticks = f"{outcome.ticks} ticks" if whole else f"{outcome.ticks} of {outcome.planned} ticks"
    wall = (
        f"{outcome.wall_time:.2f} s" if outcome.wall_time >= 0.1 else f"{outcome.wall_time:.4f} s"
    )
    parts = [f"{ticks} in {wall}", f"{outcome.real_time_factor:.1f} x real time"]
    if outcome.since_command:
        parts.append(f"first tick {outcome.since_command:.1f} s after the command")
    return f"{outcome.scenario} / {outcome.node_set}: {', '.join(parts)}"


def _latency(latency: dict[str, float]) -> str:
    times = ", ".join(f"{n} {latency[n] * 1e6:.0f} us" for n in ("p50", "p99", "max"))
    return f"  latency      {times}; {latency['overruns']:.0f} overruns"


def _rig(rig: dict[str, Any]) -> list[str]:
    """Return state, latency and counts of a rig."""
    changes = rig["changes"]
    since = changes[-1]["tick"] if changes else None
    state = rig["state"] if since is None else f"{rig['state']} since tick {since}"
    shown = [f"  rig          {rig['rig']}: {state}"]
    if rig.get("fault"):
        shown.append(f"  fault        {rig['fault']}")
    if "p50" not in rig:
        return shown
    times = ", ".join(f"{n} {rig[n] * 1e6:.0f} us" for n in ("p50", "p99", "max"))
    share = 100.0 * rig["late"] / max(rig["ticks"], 1)
    shown.append(f"  latency      {times}; {rig['late']} late ticks ({share:.2f} %)")
    names = {
        "held": "answered with held values",
        "lost_frames": "frames lost",
        "late_frames": "late",
        "repeated_frames": "repeated",
        "bad_packets": "bad packets",
        "limited_commands": "commands limited",
    }
    counts = [f"{rig[name]} {text}" for name, text in names.items()]
    if rig.get("bridged_samples"):
        counts.append(f"{rig['bridged_samples']} bad samples bridged")
    shown += [f"  counts       {', '.join(counts[:4])}", f"               {', '.join(counts[4:])}"]
    whys = ("foreign", "replayed", "reordered", "stale", "after_hold")
    refused = [f"{n} {why.replace('_', ' ')}" for why in whys if (n := rig.get(f"{why}_packets"))]
    if refused:
        shown.append(f"  refused      {', '.join(refused)} (docs/rig.md, Who may move the rig)")
    if rig.get("link_problem"):
        shown.append(f"  link         {rig['link_problem']}")
    if rig.get("clock_drift") is not None:
        shown.append(f"  rig's clock  {rig['clock_drift'] * 1e6:+.1f} ppm slow against this one's")
    return shown


def _peaks(outcome: Outcome) -> list[str]:
    items = [f"{name} {value:.4g} {unit}" for name, (value, unit) in outcome.peaks.items()]
    return [", ".join(items[start : start + 3]) for start in range(0, len(items), 3)]
