"""The command ``stickslip``, also as ``python -m stickslip``: the program, byte for byte."""

import signal
import sys

from stickslip import _native


def main() -> None:
    """Runs the program with the arguments of this process and ends the process with its exit code."""
    # as in any program: Python would wait for the end of the run before it hears of Ctrl+C
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_native.program(sys.argv[1:]))


if __name__ == "__main__":
    main()
