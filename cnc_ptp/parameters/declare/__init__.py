"""The declarations of all parameters: declarations.yaml as objects, their ranges in words, the reference."""
