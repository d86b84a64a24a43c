; P-ERR-21404 expression_signs_too_deep.nc line 2 column 24 'P1=-----------------------------------------1': the expression is nested deeper than 40 levels
P1=-----------------------------------------1
M30
