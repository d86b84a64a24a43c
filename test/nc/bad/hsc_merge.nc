; P-ERR-21615 hsc_merge.nc line 2 column 32 '#HSC ON [BSPLINE PATH_DEV=0.01 MERGE=1]': 'MERGE=1' is not available in #HSC; its syntax is #HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=5] or #HSC OFF
#HSC ON [BSPLINE PATH_DEV=0.01 MERGE=1]
M30
