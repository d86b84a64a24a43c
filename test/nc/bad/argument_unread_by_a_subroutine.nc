; P-ERR-21596 argument_unread_by_a_subroutine.nc line 11 column 26 'LL CYCLE [NAME=SLOT @GAP=1]': SLOT does not read parameter @GAP; parameters that it reads: none
; What a call gives, a comment and the lines of another subroutine do not count.
%L SLOT
LL CYCLE [NAME=OTHER @GAP=2] (@GAP)
M29
%L OTHER
G00 X[@GAP]
M29
%MAIN
LL CYCLE [NAME=OTHER @GAP=1]
LL CYCLE [NAME=SLOT @GAP=1]
M30
