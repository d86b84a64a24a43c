; P-ERR-22010 speed_above_gear.nc line 4 column 5 'N20 S2[REV2000.5]': spindle S2: 2000.5 rpm is above the maximum 2000 rpm of gear 2 (P-AXIS-00212)
; machine X / limited
N10 S2[M3 REV2000]
N20 S2[REV2000.5]
N90 M30
