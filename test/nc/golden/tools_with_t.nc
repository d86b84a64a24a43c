; tools with_t
; P-CHAN-00014: T selects the data of its number, unless D is in the block
%WITH_T
N10 T1
N20 G00 Z0
N30 T2 D3 Z0
N40 T0
N50 Z0
M30
