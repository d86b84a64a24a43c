; P-ERR-21050 radius_approach_tangential.nc line 3 column 1 'G05 G41 X5': G05 is not available yet: another way to a contour than at right angles (G138)
; tools milling
G05 G41 X5
M30
