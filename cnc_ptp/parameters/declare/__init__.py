"""What parameters there are: declarations.yaml as objects, their ranges in words, the reference."""
