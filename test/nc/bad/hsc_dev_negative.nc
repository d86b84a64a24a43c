; P-ERR-120129 hsc_dev_negative.nc line 2 column 27 '#HSC ON [BSPLINE PATH_DEV=-0.01]': PATH_DEV=-0.01 must be above 0
#HSC ON [BSPLINE PATH_DEV=-0.01]
M30
