; P-ERR-21615 hsc_switch.nc line 3 column 6 '#HSC MAYBE': 'MAYBE' is not available in #HSC; its syntax is #HSC ON [BSPLINE PATH_DEV=0.01 TRACK_DEV=5] or #HSC OFF
#HSC ON [PATH_DEV=1]
#HSC MAYBE
