; P-ERR-21682 radius_without_element_other_side.nc line 4 column 1 'G41 G01 X0 Y0': no motion in the plane G17 follows the motion to the contour, so where it ends is not known
; tools milling
D2 F600 G00 X-10 Y-10
G41 G01 X0 Y0
G42 X10
X20
M30
