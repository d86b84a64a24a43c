; P-ERR-21542 two_calls.nc line 5 column 6 'LL A LL A': 'LL A' after a subroutine call
%L A
M29
%MAIN
LL A LL A
M30
