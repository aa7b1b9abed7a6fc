#!/usr/bin/env python3
"""Runs every test of the Python client. Ends with 77, and says why, where a module it needs is not installed."""

import importlib.util
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
NEEDED = {"zmq": "python3-zmq", "flatbuffers": "python3-flatbuffers", "numpy": "python3-numpy"}


def main():
    missing = [package for module, package in NEEDED.items() if importlib.util.find_spec(module) is None]
    if missing:
        print(f"skipped: {sys.executable} has not {', '.join(missing)}; install with scripts/setup or apt-get install")
        return 77
    here = pathlib.Path(__file__).resolve().parent
    sys.path.insert(0, str(here))
    names = sys.argv[1:] or ["test_*.py"]
    loader, suite = unittest.TestLoader(), unittest.TestSuite()
    for name in names:
        suite.addTests(loader.discover(str(here), pattern=name))
    result = unittest.TextTestRunner(verbosity=1).run(suite)
    for test, reason in result.skipped:
        print(f"skipped: {test}: {reason}")
    return 0 if result.wasSuccessful() and result.testsRun else 1


if __name__ == "__main__":
    sys.exit(main())
