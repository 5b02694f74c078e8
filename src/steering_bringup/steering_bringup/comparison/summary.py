"""The comparison as a few aligned lines for the terminal."""

from __future__ import annotations

from textwrap import fill

from steering_bringup.comparison.result import Comparison
from steering_bringup.comparison.verdict import limit, lowered, shown, verdict


def summary(result: Comparison) -> str:
    """Key numbers in lines of at most 100 characters, without colour."""
    first, second = result.names
    lines = [fill(verdict(result).sentence, 100), ""]
    lines.append(f"{'difference':<22} {'largest':>10} {'rms':>10}  {'':<6} {'at':>10}   limit")
    lines += [_signal_line(result, key) for key in result.differences]
    lines += ["", f"{'':<22} {first:>14} {second:>14}"]
    powers = [e.mean_power for e in result.energies]
    supplies = [e.supply for e in result.energies]
    works = [e.driver_work for e in result.energies]
    lines.append(_pair_line("mean hydraulic power", powers, "W", 1.0, 0))
    lines.append(_pair_line("hydraulic energy", supplies, "kJ", 1e-3, 2))
    lines.append(_pair_line("driver's work", works, "J", 1.0, 1))
    lines += [f"note: {note}" for note in result.notes]
    return "\n".join(line.rstrip() for line in lines)


def _signal_line(result: Comparison, key: str) -> str:
    signal, item, bound = result.kinds[key], result.differences[key], limit(result, key)
    limit_text = "" if bound is None else f"{bound * signal.scale:g} {signal.shown_unit}"
    return (
        f"{lowered(signal):<22} {shown(signal, item.largest):>10} {shown(signal, item.rms):>10}"
        f"  {signal.shown_unit:<6} {item.at:>8.3f} s   {limit_text}"
    )


def _pair_line(title: str, values: list[float | None], unit: str, scale: float, digits: int) -> str:
    texts = ["not known" if v is None else f"{v * scale:.{digits}f} {unit}" for v in values]
    return f"{title:<22} {texts[0]:>14} {texts[1]:>14}"
