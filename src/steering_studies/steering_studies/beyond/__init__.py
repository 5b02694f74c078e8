"""Beyond the source: its own outlook, each as a study with a scenario, a plot and a page."""
