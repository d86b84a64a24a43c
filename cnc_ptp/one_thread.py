"""Imported before NumPy in processes of our own: its BLAS starts no threads, which would wait actively.

Matrices here are small.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
