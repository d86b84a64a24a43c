; machine X Y Z / three
%SPINDLES
N10 M03 S1000
N20 Z0.5
N30 M04 S1000
N50 M05
N60 M19 S200 S. POS100
N70 M19 S.POS=180 M3 S100
N80 M19                          ; same position, speed 100
N90 S[M19 REV150 POS45 M4] S2[M03 REV300] S3[M04 REV=400]
N100 S2[M19 POS90]               ; speed as programmed last
N110 S3[M19]                     ; no position yet: 0
N120 G74 S1
N130 S[G74] S2[G74]
N140 G01 G167 S500 M3 X10 F600
N150 G167
N160 S2[G167 REV1000 M3]
N170 S2[G167] X20
N180 S2[REV3000]
N190 S2[M8 M9] S3[M5 M77] M7     ; free functions for spindles, one for the channel
N200 M41                         ; free, gears are not changed here
N210 S[DEFAULT_DYNAMIC_DATA] T1 D1
N220 #EXPL SYN
N230 #MAIN SPINDLE [S2]
N240 S110 M3 S1[REV210 M3] S3[REV310 M4]
N250 M5
N260 # MAIN  SPINDLE[30]
N270 M3 S120 S1[REV220 M4] S2[REV320 M4]
N280 M19 S.POS=10
N290 #MAIN SPINDLE
N300 M5 S2[M5] S3[M5]
N310 G04 S22                     ; of the main spindle: 220 rpm
N320 M30
