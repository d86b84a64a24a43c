; P-ERR-20180 spindle_feedforward_unknown.nc line 2 column 5 'N10 S3[G135]': spindle S3 does not belong to this channel; its spindles are: S, S2
N10 S3[G135]
M30
