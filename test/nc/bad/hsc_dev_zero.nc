; P-ERR-120129 hsc_dev_zero.nc line 2 column 27 '#HSC ON [BSPLINE PATH_DEV=0]': PATH_DEV=0 must be above 0
#HSC ON [BSPLINE PATH_DEV=0]
M30
