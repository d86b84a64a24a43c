; P-ERR-21405 expression_text_in_word.nc line 3 column 3 'X[V.P.T]': V.P.T is a text where a number is needed
V.P.T="five"
X[V.P.T]
M30
