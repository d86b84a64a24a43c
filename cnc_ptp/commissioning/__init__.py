"""Commissioning: what recorded motions say about an axis. Pure analysis on arrays; mm, s, deg, N or Nm."""
