; P-ERR-21037 position_twice.nc line 3 column 17 'N10 M19 S.POS90 S.POS=80': spindle S is programmed twice in one block
; machine X / three
N10 M19 S.POS90 S.POS=80
M30
