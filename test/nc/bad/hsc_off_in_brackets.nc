; P-ERR-21615 hsc_off_in_brackets.nc line 2 column 10 '#HSC ON [OFF]': 'OFF' is not available in #HSC; its syntax is #HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=5] or #HSC OFF
#HSC ON [OFF]
M30
