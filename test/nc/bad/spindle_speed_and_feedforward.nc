; P-ERR-21093 spindle_speed_and_feedforward.nc line 2 column 7 'N10 S[REV1000 G135]': 'REV1000' with feedforward in the brackets of spindle S: G135, G136 and G137 must be alone there
N10 S[REV1000 G135]
M30
