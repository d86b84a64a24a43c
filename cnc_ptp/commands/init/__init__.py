"""`cnc_ptp init`: machine files to begin with."""
