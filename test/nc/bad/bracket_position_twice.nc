; P-ERR-21008 bracket_position_twice.nc line 3 column 18 'N10 S2[M19 POS10 POS20]': word POS twice in one block: 10 and 20
; machine X / three
N10 S2[M19 POS10 POS20]
