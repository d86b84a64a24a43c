; Texts: joined, cut, compared, converted, in messages and conditions.
V.P.PART = "flange"
V.P.NR = 12
V.P.LABEL = V.P.PART + " " + INT_TO_STR[V.P.NR]
#MSG ["%s, %d characters", V.P.LABEL, LEN[V.P.LABEL]]
$IF MID[V.P.LABEL, 2, 8] == "12"
G00 X[STR_TO_INT[RIGHT[V.P.LABEL, 2]] + 1]
$ENDIF
V.P.LABEL = REPLACE[V.P.LABEL, "disc", 6, 1]
#MSG ["%s", V.P.LABEL]
V.P.LABEL = INSERT[DELETE[V.P.LABEL, 3, 5], "-A", 4]
#MSG ["%s has an A at %d", V.P.LABEL, FIND[V.P.LABEL, "A"]]
#MSG ["%s", CHR[ORD["A"] + 2] + REAL_TO_STR[2.5]]
Y[STR_TO_REAL["2.5"]]
M30
