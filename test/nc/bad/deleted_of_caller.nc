; P-ERR-20933 deleted_of_caller.nc line 3 column 9 '#DELETE V.CYC.A': #DELETE of V.CYC.A, which belongs to a caller
%L UP
#DELETE V.CYC.A
M29
%MAIN
V.CYC.A=1
LL UP
M30
