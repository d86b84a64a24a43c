; P-ERR-21042 bracket_override_twice.nc line 3 column 23 'N10 S2[M3 REV100 G167 G167]': G167 twice in one block
; machine X / three
N10 S2[M3 REV100 G167 G167]
