; P-ERR-21616 hsc_without_values.nc line 2 column 8 '#HSC ON': #HSC without PATH_DEV; its syntax is #HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=5] or #HSC OFF
#HSC ON
M30
