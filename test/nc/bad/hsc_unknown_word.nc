; P-ERR-21615 hsc_unknown_word.nc line 2 column 10 '#HSC ON [FOO]': 'FOO' is not available in #HSC; its syntax is #HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=5] or #HSC OFF
#HSC ON [FOO]
M30
