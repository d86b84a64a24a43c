"""Commissioning: analysis of recorded motions of an axis. Pure functions of arrays; mm, s, deg, N or Nm."""
