; P-ERR-21019 iso_call_fanuc_count.nc line 3 column 5 'M98 P50001': unknown subroutine O50001; known are: O1
; dialect iso
M98 P50001
M30
O1
M99
