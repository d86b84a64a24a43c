; P-ERR-21811 iso_axis_behind_g80.nc line 4 column 1 'X5': X without a motion: G80 has ended cycle and path function; program G00 to G03
; dialect iso
G80
X5
M30
