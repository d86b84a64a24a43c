"""Mutated inputs of every kind, and what must hold for each of them (docs/reliability.md).

engine.py       seed -> input -> call -> verdict; the limits that every input is held to
guard.py        nothing is written outside a folder, no process is started
mutation.py     bytes, texts, YAML and JSON with a few changes
kinds.py        the table: one row for each kind of input
the others      how inputs of a kind are made, and what takes them
"""
