; End of a modal cycle.
%G80
#DISABLE MODAL CYCLE
M29
