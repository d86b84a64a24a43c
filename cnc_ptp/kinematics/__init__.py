"""Kinematics: from what programs say to the axes of the machine, and back."""
