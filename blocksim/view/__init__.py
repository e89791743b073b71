"""What people see. Only here is matplotlib imported."""

import logging

# What it logs of folders that it cannot write would be printed where nobody set up logging.
logging.getLogger("matplotlib").addHandler(logging.NullHandler())
