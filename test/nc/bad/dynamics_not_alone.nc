; P-ERR-21066 dynamics_not_alone.nc line 3 column 28 'N10 S[DEFAULT_DYNAMIC_DATA REV100]': DEFAULT_DYNAMIC_DATA must be the only function of spindle S in its block, not with REV100
; machine X / three
N10 S[DEFAULT_DYNAMIC_DATA REV100]
M30
