; P-ERR-21078 link_group_default.nc line 3 column 5 'N10 #SET AX LINK[0, S2=S]': coupling group 0 is defined by P-CHAN-00037 and P-CHAN-00038 only
; machine X / three
N10 #SET AX LINK[0, S2=S]
M30
