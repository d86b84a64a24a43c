%POSITIONING (70252 where the spindle has no position)
N10 M19 S60 S.POS90
M30
