; P-ERR-21093 spindle_feedforward_and_m.nc line 2 column 13 'N10 S[G135  M3 REV1000]': 'M3' with feedforward in the brackets of spindle S: G135, G136 and G137 must be alone there
N10 S[G135  M3 REV1000]
M30
