; P-ERR-21656 iso_radius_without_table.nc line 4 column 5 'G41 D1 G1 X10. F500.': D1: there are no compensation data 1, the machine has no tool table (werkz_data, wz[1])
; tools none
; dialect iso
G41 D1 G1 X10. F500.
M30
