"""Compensation of the tool radius (G40, G41, G42): from the programmed contour to the path of the tool's centre.

shapes.py         lines and arcs in a plane: parallels, intersections, distances
corners.py        how the tool gets around an outer corner
contour_path.py   the path along a contour: corners, elements that vanish, places that are too narrow
entries.py        blocks that wait in it
compensation.py   the stage between the interpreter's blocks and the canonical stream
working_plane.py  the plane in which it acts, within machine coordinates
tool_radius.py    radius of the active tool, position of a turning tool's tip
changes.py        what must not change meanwhile
radius_codes.py   G codes; radius_state.py what they leave in the modal state
"""
