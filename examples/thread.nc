%THREAD (a shaft gets a thread M40x2, two starts of 3 mm and a taper; X is the radius)
N10 G18 G90 T5 D5
N20 M03 S800
(--- M40x2, depth 1.23: infeed along the flank, two spring passes, 3 mm of chamfer)
N30 G00 X30 Z146
N40 L CYCLE [NAME=threading.nc @X=20 @Z=110 @LEAD=2 @DEPTH=1.23 @FIRST=0.35 @ANGLE=29.5 @SPRING=2 @CHAMFER=3]
(--- two starts with a pitch of 1.5 mm)
N50 G00 X30 Z106
N60 L CYCLE [NAME=threading.nc @X=22 @Z=70 @LEAD=3 @DEPTH=0.92 @FIRST=0.4 @STARTS=2 @SPRING=1]
(--- a taper of 1 : 16)
N70 G00 X32 Z68
N80 L CYCLE [NAME=threading.nc @X=24 @Z=36 @LEAD=2 @DEPTH=1.2 @FIRST=0.4 @TAPER=1 @CLEAR=2]
N90 G00 X80 Z200
N100 M05
N110 M30
