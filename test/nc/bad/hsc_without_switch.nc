; P-ERR-21616 hsc_without_switch.nc line 2 column 5 '#HSC': #HSC without ON or OFF; its syntax is #HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=5] or #HSC OFF
#HSC
