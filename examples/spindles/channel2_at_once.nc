%CHANNEL2_AT_ONCE (S2 runs up for the first channel)
N10 M03 S500
M30
