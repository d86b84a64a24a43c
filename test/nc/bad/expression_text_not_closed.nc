; P-ERR-21407 expression_text_not_closed.nc line 2 column 7 'V.P.T="five': the text in quotation marks is not closed in its line
V.P.T="five
M30
