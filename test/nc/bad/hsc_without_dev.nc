; P-ERR-21616 hsc_without_dev.nc line 2 column 30 '#HSC ON [BSPLINE TRACK_DEV=1]': #HSC without PATH_DEV; its syntax is #HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=5] or #HSC OFF
#HSC ON [BSPLINE TRACK_DEV=1]
M30
