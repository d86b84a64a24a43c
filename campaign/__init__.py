"""What the machine survives: processes that die at random moments, load, time. `python -m campaign` measures it.

It starts graphs as users do (`cnc_ptp run`), does something bad to them at a moment that a seed gives, and checks what
moved, what was recorded and what was left behind. docs/reliability.md says what it checks.
"""
