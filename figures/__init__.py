"""Pictures of the documentation: `make figures`, or `python -m figures [NAME ...]`.

A figure is a scenario in examples/figures; comment lines at its head say what the picture is called, which machine runs
it and which axes are drawn. It is run offline and becomes docs/figures/NAME.svg.
"""
