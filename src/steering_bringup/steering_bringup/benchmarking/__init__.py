"""What all benchmarks share: their list and targets, timing, the report, figures of the docs."""
