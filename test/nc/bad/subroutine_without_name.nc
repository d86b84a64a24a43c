; P-ERR-21016 subroutine_without_name.nc line 2 column 3 '%L': '%L' is not a program name
%L 
M29
%MAIN
M30
