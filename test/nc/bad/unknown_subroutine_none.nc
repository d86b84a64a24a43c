; P-ERR-21019 unknown_subroutine_none.nc line 2 column 5 'N20 LL HOLES': unknown subroutine HOLES; known are: none
N20 LL HOLES
N30 M30
