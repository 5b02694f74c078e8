"""Several specimens side by side: what is common to them, and what one of them has alone."""
