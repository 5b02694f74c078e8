"""Pages of the studies: figures in the source's axes."""
