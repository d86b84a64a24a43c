; P-ERR-21016 iso_percent_with_words.nc line 3 column 2 '% PART': 'PART' is not a program name
; dialect iso
% PART
G0 X1
M30
