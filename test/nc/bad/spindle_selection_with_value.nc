; P-ERR-21095 spindle_selection_with_value.nc line 2 column 7 'N10 S[G135=5]': G135 of spindle S takes no value
N10 S[G135=5]
M30
