"""Error numbers of function blocks; all others come from their units."""

BAD_BUFFER_MODE = 22166
NOT_GRANTED = 22167
"""The PLC has not granted the coupling of a spindle."""
CAME_TO_REST = 22168
"""A motion without an end has come to rest without a command."""
NO_RAMPS = 22170
"""A spindle has the ramps of its gear only."""
