"""Pictures of the documentation: `make figures`, or `python -m figures [NAME ...]`.

A figure is a scenario in examples/figures; comment lines at its head give the picture's title, the machine
and the axes to draw. It is run offline and becomes docs/figures/NAME.svg.
"""
