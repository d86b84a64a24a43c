; P-ERR-21615 hsc_off_with_values.nc line 2 column 10 '#HSC OFF [BSPLINE]': '[BSPLINE]' is not available in #HSC; its syntax is #HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=5] or #HSC OFF
#HSC OFF [BSPLINE]
