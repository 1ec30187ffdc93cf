"""Command ``stickslip`` and ``python -m stickslip``: the program with the same output bytes."""

import signal
import sys

from stickslip import _native


def main() -> None:
    """Runs the program with this process's arguments and exits with the program's exit code."""
    # default action, as in any program: Python would handle Ctrl+C only after the run
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_native.program(sys.argv[1:]))


if __name__ == "__main__":
    main()
