"""Faults of the C axis: #CAX, #FACE, #CYL; the number 21175 is the vendor's, our own are from 21740."""

from cnc_ptp.nc.faults import Fault

# The spindle as an axis of the path
NOT_MAIN = Fault(21175, "spindle {spindle} is not the main spindle: #CAX makes {main} alone an axis of the path")
NO_C_AXIS = Fault(21740, "#CAX without a name of the axis in the machine file (P-CHAN-00010)")
C_AXIS_NAME = Fault(21741, "#CAX gives the axis the name {name}; in the machine file it is {axis} (P-CHAN-00010)")
C_AXIS_OFF = Fault(21742, "{axis} is the main spindle; #CAX makes it an axis of the path")
C_AXIS_ON = Fault(21743, "#CAX while the spindle is axis {axis} of the path already")
C_AXIS_NOT_ON = Fault(21744, "#CAX OFF while no spindle is an axis of the path")
SPINDLE_IS_AXIS = Fault(21745, "{word} while spindle {spindle} is axis {axis} of the path; #CAX OFF first")
C_AXIS_TURNS = Fault(
    21746, "#CAX while spindle {spindle} turns: it must be at a standstill (M05 or M19 in a block before)"
)
C_AXIS_COUPLED = Fault(21747, "#CAX while spindle {spindle} is coupled (group {group}); #AX LINK OFF first")
C_AXIS_HOMING = Fault(21748, "G74 of axis {axis}: it is homed as a spindle, G74 {spindle}1 before #CAX")
C_AXIS_CONTROL = Fault(
    21759, "feedforward and compensation of axis {axis}: its controller is that of spindle {spindle}"
)
C_AXIS_MEASURES = Fault(21749, "a measuring run with axis {axis}: a spindle has no probe")

# Kinematics
KINEMATICS_WITHOUT_CAX = Fault(21750, "{command} while the main spindle is no axis of the path; #CAX first")
KINEMATICS_SYNTAX = Fault(21751, "it is written {syntax}")
KINEMATICS_AXES = Fault(21752, "{command} with axes {first} and {second}; it is written {syntax}")
CYLINDER_RADIUS = Fault(21753, "radius {value} mm of #CYL must be above 0")
KINEMATICS_NOT_ON = Fault(21754, "{command} OFF without {command}")
THROUGH_CENTRE = Fault(21755, "the path of {command} goes through {place}")
FACE_SIDE = Fault(
    21756, "#FACE with {axis} at {value} mm, beyond the centre of rotation: a lathe needs 0 or more (P-CHAN-00008)"
)
KINEMATICS_TURNED = Fault(21757, "{command} in coordinates that are rotated, mirrored or scaled")
NOT_WITH_KINEMATICS = Fault(21758, "{word} while {command} is on; it needs the positions of the axes")
