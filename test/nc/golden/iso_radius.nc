; dialect iso
; tools milling
%
O1000
G17 G21 G90 G40
T2 M6
G43 H2 Z20.
G0 X-20. Y-10.
Z2.
G1 Z-5. F300.
G41 D2 X0. Y0. F600.
Y40.
X40.
G3 X60. Y60. R20.
G1 X60. Y0.
X0.
G40 X-20. Y-10.
G0 Z20.
(the same side with the radius of D1, which stays without its word)
G41 D1 G1 X0. Y0.
Y20.
G40 X-20.
G42 X0. Y0.
X20.
G40 Y-20.
G49
M30
%
