%CHANNEL2_UNKNOWN (S3 is not configured here)
N10 S3[M03 REV100]
M30
