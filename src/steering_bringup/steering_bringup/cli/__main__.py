"""``python -m steering_bringup.cli``."""

import sys

from steering_bringup.cli import main

sys.exit(main())
