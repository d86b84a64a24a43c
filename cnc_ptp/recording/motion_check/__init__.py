"""Checks the motion of a recording by its numbers alone: continuity, limits, soft limits, power, owners.

Nothing of what plans motions is imported (`motion/`, `path/`, `axis/`, `spindle/`): the setpoints of each cycle are
integrated again and compared with those of the next one, with bounds that follow from the limits in closed form.
"""
