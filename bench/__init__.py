"""Speed and memory figures: `make bench`, or `python -m bench [topic ...] [--short] [--json FILE]`.

A topic is a module with a function `figures(effort, show)` that measures and yields one `Figure` after the other.
Nothing here fails on time: goals are shown next to the figures.
"""
