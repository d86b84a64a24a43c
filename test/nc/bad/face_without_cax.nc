; P-ERR-21750 face_without_cax.nc line 3 column 1 '#FACE [X, C]': #FACE while the main spindle is no axis of the path; #CAX first
; machine X Z C / c_axis
#FACE [X, C]
M30
