; P-ERR-21061 m_is_no_spindle_function.nc line 3 column 8 'N10 S2[M30]': M30 is not a function of a spindle, but is in the brackets of spindle S2
; machine X / three
N10 S2[M30]
M30
