; P-ERR-20180 spindle_not_in_machine_speed.nc line 2 column 5 'N10 S3=1000': spindle S3 does not belong to this channel; its spindles are: S, S2
N10 S3=1000
M30
