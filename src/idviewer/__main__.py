"""`python -m idviewer` is the same as `idviewer`."""

import sys

from idviewer.cli import main

if __name__ == "__main__":
    sys.exit(main())
