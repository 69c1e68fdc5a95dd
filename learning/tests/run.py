#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs all tests of this folder: run.py [NAME...]. Exits 77 where PyTorch or OpenCV is missing."""

import os
import sys
import unittest
from pathlib import Path

# With one thread, sums are the same on all machines. Libraries read these variables when they load.
os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]


def main() -> int:
    """0 all passed, 1 some failed, 77 skipped."""
    for module, package in (("torch", "python3-torch"), ("cv2", "python3-opencv"), ("xxhash", "python3-xxhash"),
                            ("yaml", "python3-yaml"), ("matplotlib", "python3-matplotlib")):
        try:
            __import__(module)
        except ImportError:
            print(f"skipped: the Python module {module} is missing (Debian: {package})")
            return 77
    import torch
    torch.set_num_threads(1)
    loader = unittest.TestLoader()
    names = sys.argv[1:]
    suite = loader.loadTestsFromNames(names) if names else loader.discover(str(HERE), "test_*.py", str(HERE))
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    return 0 if result.wasSuccessful() and result.testsRun else 1


if __name__ == "__main__":
    sys.exit(main())
