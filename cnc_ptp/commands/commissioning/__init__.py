"""Commands of commissioning: identify, circle, curve."""
