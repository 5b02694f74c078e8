"""The engine's constants; docs/diagnosis_engine.md says where they come from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Settings:
    """Constants of sampling, search and decision.

    bandwidth_hz: of the common zero-phase low-pass. most_samples: of the decimated grid.
    block_s: shortest block of the hold-out and of the block statistics. blocks: how many at most.
    moment_s: of the statistics of the held-out gain: a cause may act in a few of them alone.
    held_out_every: without a second record every such block is held out.
    noise_order: of the autoregressive noise model. resolution: share of what the tolerances scatter
    below which an error is never judged.
    """

    bandwidth_hz: float = 80.0
    most_samples: int = 12_000
    block_s: float = 0.5
    blocks: int = 32
    moment_s: float = 0.1
    held_out_every: int = 4
    noise_order: int = 8
    resolution: float = 0.02

    # Search
    screened: int = 14
    """Hypotheses that go, for each idea of the noise, on to the linear refit with their own."""
    refitted: int = 6
    """Hypotheses that go on to the nonlinear refit."""
    refitted_next: int = 5
    """The same for a further cause, and for rivals of one of several."""
    beam: int = 2
    most_causes: int = 4
    iterations: int = 12
    shape_grid: tuple[float, ...] = (1.0, 0.4, 2.5)
    """Shape parameters are scanned at these multiples of their typical value."""

    # Decision
    family_p: float = 1e-3
    """Probability of a false name on a clean record, over the whole catalogue."""
    inflation: float = 1.5
    """Of likelihood ratios, because noise is neither Gaussian nor stationary."""
    least_gain: float = 0.5
    """Gain in misfit of a cause over an output's independent samples, at least: what clean records
    gain by a wrong cause, because their form is not quite the model's, is a matter of the model."""
    least_gains: Mapping[str, float] = field(default_factory=dict)
    """The same by hypothesis, where clean records gain more: the inputs' noise looks like it."""
    least_visible: float = 0.1
    """Energy that a cause takes off one held-out output at least, over that output's noise."""
    least_share: float = 0.10
    """Of the error energy above the noise that a cause has to remove on held-out blocks."""
    least_share_next: float = 0.35
    """The same for a further cause, of what the others leave."""
    least_share_parameter: float = 0.5
    """The same where the cause is a nominal parameter that no effect covers."""
    equal_gain: float = 0.01
    """Gains of rivals that differ by less, as a share, are equal."""
    leaves: float = 5e-4
    """Share of what a cause gains in an output that may remain there, because the truth follows
    another formula."""
    leaves_near: float = 5e-3
    """The same for causes of one balance: there another formula of a law looks like one of them."""
    least_size: float = 0.09
    """Of a hypothesis's visible (typical) size; smaller ones are not named."""
    least_explained: float = 0.45
    """Share that all causes together have to explain, else nothing is named."""
    held_out_sigmas: float = 1.7
    """The held-out gain has to exceed so many of its standard errors."""
    rival_sigmas: float = 2.0
    """A rival whose likelihood is within so many standard errors of the best is as good."""
    form_uncertainty: float = 0.045
    """Relative standard deviation of a parameter because the truth follows another formula."""
    least_unexplained: float = 0.2
    """Share of the refitted error that is reported as unexplained structure."""
    least_disagreement: float = 10.0
    """Mean square difference of two records' nominal parameters over what is expected, from which
    they are not one specimen's. Clean records reach 9.5: noise of the inputs biases estimates."""
    drift: float = 0.1
    """Standard deviations by which nominal parameters, sensors' offsets above all, may differ from
    one record to the next."""
    spoiling: float = 0.03
    """Structure in an output over what the causes explain there, in their own frequencies, from
    which they are not the causes: another formula for the same phenomenon leaves less."""

    def least_gain_of(self, hypothesis: str) -> float:
        """Return the least gain of a hypothesis."""
        return max(self.least_gain, self.least_gains.get(hypothesis, 0.0))
