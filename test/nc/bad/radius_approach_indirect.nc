; P-ERR-21050 radius_approach_indirect.nc line 3 column 1 'G139': G139 is not available yet: another way to a contour than at right angles (G138)
; tools milling
G139
M30
