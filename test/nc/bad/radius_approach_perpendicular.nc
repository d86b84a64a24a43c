; P-ERR-21050 radius_approach_perpendicular.nc line 3 column 1 'G237': G237 is not available yet: another way to a contour than at right angles (G138)
; tools milling
G237
M30
